#pragma once

#include "firmware/model/kinematics.h"

namespace sidestep {

/// The joint axes of one configuration as lines in the base frame. A row of a Jacobian then takes two dot products per
/// joint.
class JointAxes {
 public:
  explicit JointAxes(const LinkPoses& poses);

  /// The derivative of the velocity of a body's point p_base (m) along a unit direction by the joint velocities, n x 1:
  /// point_jacobian(poses, body, p_base)^T direction. Entry i is the moment about joint axis i of the line through
  /// p_base along the direction, for a prismatic joint the share of its axis along the direction; 0 for the joints
  /// beyond the body.
  JointVector row(int body, const Vector3& p_base, const Vector3& direction) const;

 private:
  struct Line {
    Vector3 direction;  ///< 0 for a prismatic joint: a line at infinity
    Vector3 moment;     ///< of the line about the origin, m; for a prismatic joint its axis
  };
  int joints_;
  std::array<Line, kMaxJoints> lines_;
};

}  // namespace sidestep
