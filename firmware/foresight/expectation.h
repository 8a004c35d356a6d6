#pragma once

#include "firmware/foresight/rollout.h"

namespace sidestep {

/// What a forecast expected of the next seconds: the arm's path, the target and the obstacles. A forecast need not be
/// repeated while a snapshot is as expected.
class Expectation {
 public:
  explicit Expectation(const Arm& arm) : joint_scale_(arm.joint_scale) {}

  /// Expects what `forecast`, a rollout of the snapshot `from`, assumed.
  void set(const Snapshot& from, const Forecast& forecast);
  void clear() { valid_ = false; }

  /// Whether the snapshot is in the same mode, at most kForecastPath_s later than `from`, at most 0.2 s where an
  /// obstacle moves, and deviates little:
  ///   obstacles   the same ones, each within 10 mm and 0.05 m/s of its extrapolation, of the same size within 10 mm
  ///   target      within 5 mm and 0.02 m/s of predicted_target(), the orientation within 0.03 rad; a posture within
  ///               0.005 rad (times Arm::joint_scale) per joint
  ///   arm         every joint within 0.05 rad (times Arm::joint_scale) of the path, joints outside the chain within
  ///               0.01 rad or m; what the tool holds and may touch is the same
  bool holds(const Snapshot& now) const;

 private:
  /// How long the forecast may be relied on.
  double lasts_s() const;
  bool target_as_expected(const Snapshot& now, double after_s) const;
  bool obstacles_as_expected(const Snapshot& now, double after_s) const;
  bool other_joints_as_expected(const Snapshot& now) const;
  bool arm_as_expected(const Snapshot& now, double after_s) const;

  JointVector joint_scale_;
  bool valid_ = false;
  bool tracking_ = false;
  double at_s_ = 0.0;
  Target target_;
  OtherJoints others_;
  Attachments attachments_;
  NearbyObstacles nearby_;
  Forecast forecast_;
};

}  // namespace sidestep
