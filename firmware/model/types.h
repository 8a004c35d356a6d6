#pragma once

#include <Eigen/Dense>

namespace sidestep {

constexpr int kMinJoints = 6;
constexpr int kMaxJoints = 10;
constexpr int kMaxLinkShapes = 128;  ///< collision shapes of an arm, pieces of meshes included
constexpr int kMaxHeldShapes = 16;   ///< shapes that its tool holds
constexpr int kMaxShapes = kMaxLinkShapes + kMaxHeldShapes;
constexpr int kMaxObstacles = 4096;  ///< in one obstacle set

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// Sized at run time, stored in place: none of these types uses the heap. The product of two of these matrices is
/// written as lazyProduct(): Eigen's `*` would instantiate the product of large matrices, which takes a second or two
/// of compile time in every file. Matrix times vector is written as `*`.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxJoints>;

/// A task is the tool's position (3 rows) or its position and orientation (6 rows: linear, then angular).
using TaskVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
using TaskMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
using TaskJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, kMaxJoints>;

}  // namespace sidestep
