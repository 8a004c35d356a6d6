#pragma once

#include "firmware/model/arm.h"

namespace sidestep::test {

/// The same limits for every joint.
inline JointLimits limits_of(double lower, double upper, double velocity, double acceleration, int joints = 7) {
  return {JointVector::Constant(joints, lower), JointVector::Constant(joints, upper),
          JointVector::Constant(joints, velocity), JointVector::Constant(joints, acceleration)};
}

}  // namespace sidestep::test
