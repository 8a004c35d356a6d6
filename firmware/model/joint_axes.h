#pragma once

#include "firmware/model/kinematics.h"

namespace sidestep {

/// The axes of the joints in one posture as lines in the base frame, so that a row of a Jacobian is two dot products a
/// joint.
class JointAxes {
 public:
  explicit JointAxes(const LinkPoses& poses);

  /// How fast a point of a body (m) moves along a unit direction over the joint velocities: point_jacobian()^T
  /// direction, n x 1; it is the moment of the line through the point about each axis.
  JointVector row(int body, const Vector3& p_base, const Vector3& direction) const;

 private:
  struct Line {
    Vector3 direction;
    Vector3 arguments;  ///< of the line about the origin, m
  };
  int joints_;
  std::array<Line, kMaxJoints> lines_;
};

}  // namespace sidestep
