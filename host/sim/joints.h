#pragma once

#include <Eigen/Core>

namespace sidestep::sim {

constexpr int kMaxJoints = 10;

/// One value per joint of the chain, base first; stored in place.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;

}  // namespace sidestep::sim
