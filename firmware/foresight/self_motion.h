#pragma once

#include "firmware/base/bounded_list.h"
#include "firmware/control/types/guide.h"
#include "firmware/model/arm.h"

namespace sidestep {

/// A self-motion: a joint path along which the position of the tool stays the same, while the tool may turn. Where the
/// ends of a leg differ in position, the tool moves on the straight line between them.
class SelfMotion {
 public:
  /// start_rad, n x 1: where the path begins. The arm must outlive the object.
  SelfMotion(const Arm& arm, const JointVector& start_rad) : arm_(arm) { points_rad_.add(start_rad); }

  /// Appends a leg to goal_rad, n x 1; at most two. The straight way in joint space is cut into 15 parts, and each
  /// point between them is moved to the tool's line by inverse kinematics that begins near the point before. Returns
  /// false, and the object is of no more use, where that finds no continuous path.
  bool add_leg(const JointVector& goal_rad);

  /// The path as a guide from rest to rest that begins at start_s, with velocities and accelerations within `share` of
  /// the limits. There must be a leg.
  Guide guide(double start_s, double share) const;

 private:
  const Arm& arm_;
  BoundedList<JointVector, kMaxKnots> points_rad_;
};

}  // namespace sidestep
