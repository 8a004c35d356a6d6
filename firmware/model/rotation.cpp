#include "firmware/model/rotation.h"

#include <cmath>

namespace sidestep {

// Not Eigen's Quaternion::FromTwoVectors: near -z it decomposes singular values, which takes 7 s to compile. Farther
// away the result is the same, bit for bit.
Quaternion rotation_from_z(const Vector3& axis) {
  const Vector3 z = axis.normalized();
  const Vector3 turn = Vector3::UnitZ().cross(z);  // its norm is the sine of the angle, z.z() the cosine
  constexpr double kNearlyOpposite = -0.999;       // below, 1 + z.z() has lost digits
  Quaternion rotation;
  if (z.z() < kNearlyOpposite) {
    const double sine = turn.norm(), root = std::sqrt((1.0 - z.z()) * 2.0);
    rotation.vec() = 0.5 * root * (sine > 0.0 ? Vector3(turn / sine) : Vector3(-Vector3::UnitX()));
    rotation.w() = sine / root;
  } else {
    const double root = std::sqrt((1.0 + z.z()) * 2.0);
    rotation.vec() = turn * (1.0 / root);
    rotation.w() = root * 0.5;
  }
  return rotation;
}

}  // namespace sidestep
