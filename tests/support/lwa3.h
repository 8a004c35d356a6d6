#pragma once

#include <limits>

#include "firmware/model/load/load_arm.h"
#include "firmware/model/velocity_range.h"

namespace sidestep::test {

/// The paper's arm, from urdf/lwa3.urdf; tests run in the repository's root.
inline const Arm& lwa3() {
  static const Arm arm = load_arm("urdf/lwa3.urdf", "base_link", "tool");
  return arm;
}

/// Home configuration of the paper: the tool at (-0.328, 0, 0.9137) m without rotation.
inline JointVector home_rad() {
  JointVector q_rad = JointVector::Zero(7);
  q_rad[1] = M_PI / 2;
  q_rad[3] = -M_PI / 2;
  return q_rad;
}

/// A range of joint velocities without bounds, 7 joints.
inline const VelocityRange& any_velocity() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static const VelocityRange range{JointVector::Constant(7, -kInfinity), JointVector::Constant(7, kInfinity)};
  return range;
}

}  // namespace sidestep::test
