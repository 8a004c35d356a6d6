#pragma once

#include "host/campaign/judge_arm.h"

namespace sidestep::campaign {

/// The benchmark's arm: the LWA3 from its modified (Craig) D-H table, seven joints, four capsules of one radius between
/// five corners (base, shoulder, elbow, wrist, tool). Paper Table 1 with the lengths of docs/paper.md, "The arm".
class Lwa3Arm : public JudgeArm {
 public:
  ArmPose pose(const Joints& q_rad) const override;
  double clearance(const ArmPose& pose, const Vector3& center_m, double radius_m,
                   double within_m = sim::kNothingNear) const override;
  double clearance(const ArmPose& pose, const std::vector<Capsule>& capsules,
                   double within_m = sim::kNothingNear) const override;
  double solid_clearance(const ArmPose& pose, const std::vector<sim::Obstacle>& solids,
                         double within_m = sim::kNothingNear) const override;
  std::vector<Capsule> enclosing_capsules(const Joints& q_rad) const override;
  /// Of the capsules that share no corner.
  double self_clearance(const ArmPose& pose, double within_m = sim::kNothingNear) const override;
  bool goal_has_orientation() const override { return false; }
  Limits limits(const Family& family) const override;
  Limits range() const override;
  ArmSource source(const Family& family) const override;
  int contact_checks_per_period() const override { return 1; }
};

constexpr double kLinkRadius_m = 0.05;

/// A shared instance.
const JudgeArm& lwa3_arm();

}  // namespace sidestep::campaign
