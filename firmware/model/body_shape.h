#pragma once

#include "firmware/model/convex_solid.h"

namespace sidestep {

/// A convex shape that is fixed to a body of the arm, or to a joint outside the chain that this body carries.
struct BodyShape {
  int body = 0;            ///< 0 is the base; body i moves with joints 1 to i
  int other_joint = -1;    ///< index into Arm::other_joints of the joint that moves it on its body; -1: none
  Capsule capsule_body{};  ///< encloses the shape; cheap tests use it alone. In the frame of its body, or other joint
  bool is_capsule = true;  ///< the shape is that capsule; otherwise it is `solid`
  ConvexSolid solid = {};  ///< in the same frame as the capsule
};

}  // namespace sidestep
