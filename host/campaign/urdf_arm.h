#pragma once

#include "host/campaign/judge_arm.h"

namespace sidestep::campaign {

/// Any arm of the controller, with its configured limits. Poses and surface (meshes included) are the simulator's. Only
/// the witness is also checked against the controller's capsules: they are larger than the meshes and must not block
/// the witness's path.
class UrdfArm : public JudgeArm {
 public:
  /// Throws std::runtime_error, one line, if the simulator cannot read the URDF.
  explicit UrdfArm(const Config& config);

  ArmPose pose(const Joints& q_rad) const override;
  double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m,
                   double within_m = sim::kNothingNear) const override;
  double clearance(const ArmPose& pose, const std::vector<Capsule>& capsules,
                   double within_m = sim::kNothingNear) const override;
  double solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids,
                         double within_m = sim::kNothingNear) const override;
  std::vector<Capsule> enclosing_capsules(const Joints& q_rad) const override;
  double self_clearance(const ArmPose& pose, double within_m = sim::kNothingNear) const override;
  double controller_clearance(const ArmPose& pose, const Vector3& center_m, double radius_m) const override;
  double controller_solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids) const override;
  bool keeps_clear_of_itself(const ArmPose& pose) const override;
  Limits limits(const Family& family) const override;
  Limits range() const override;
  ArmSource source(const Family& family) const override;
  int contact_checks_per_period() const override { return 5; }

 private:
  ArmSource source_;
  sim::Truth truth_;
  Model model_;
};

}  // namespace sidestep::campaign
