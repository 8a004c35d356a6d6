#pragma once

#include "firmware/base/bounded_list.h"
#include "firmware/control/types/guide.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// A self-motion: a joint path along which the tool keeps its position, as far as the joints permit, while it may turn.
class SelfMotion {
 public:
  /// start_rad, n x 1: where the path begins. place_m: the tool's position, base frame. damping: of the least squares
  /// problem of a step. With 0.01 the tool stays within millimetres; the larger it is, the farther the tool may go
  /// where joints at their limits or singular configurations close the way. The arm must outlive the object.
  SelfMotion(const Arm& arm, const JointVector& start_rad, const Vector3& place_m, double damping)
      : arm_(arm), place_m_(place_m), damping_(damping) {
    path_rad_.add(start_rad);
  }

  /// Leads the path to goal_rad, n x 1, by at most 240 steps of at most 0.05 rad (times Arm::joint_scale) in every
  /// joint. Returns false, and the object is of no more use, where they do not arrive.
  bool reach(const JointVector& goal_rad);

  /// The path as a guide from rest to rest that begins at start_s, with velocities and accelerations within `share` of
  /// the limits. Only after reach() has returned true.
  Guide guide(double start_s, double share) const;

 private:
  JointVector step_rad(const JointVector& goal_rad) const;

  const Arm& arm_;
  Vector3 place_m_;
  double damping_;
  BoundedList<JointVector, 242> path_rad_;
};

}  // namespace sidestep
