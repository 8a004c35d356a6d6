#pragma once

#include "host/campaign/judge_arm.h"

namespace sidestep::campaign {

/// Any arm that the controller can steer, within the limits it is configured with. Where it is and its surface, meshes
/// included, are the simulator's. Only a witness is also held to the controller's capsules: what stands out from a
/// mesh must not close the only way.
class UrdfArm : public JudgeArm {
 public:
  /// Throws std::runtime_error, one line, where the simulator cannot read the URDF.
  explicit UrdfArm(const Config& config);

  ArmPose pose(const Joints& q_rad) const override;
  double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m,
                   double within_m = sim::kNothingNear) const override;
  double believed_clearance(const ArmPose& pose, const Vector3& center_m, double radius_m) const override;
  bool keeps_clear_of_itself(const ArmPose& pose) const override;
  Limits limits(const Family& family) const override;
  Limits range() const override;
  ArmSource source(const Family& family) const override;
  int looks_per_period() const override { return 5; }

 private:
  ArmSource source_;
  sim::Truth truth_;
  Model model_;
};

}  // namespace sidestep::campaign
