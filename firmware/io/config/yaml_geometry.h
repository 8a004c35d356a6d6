#pragma once

#include <cstdint>
#include <vector>

#include "firmware/io/config/yaml_section.h"

namespace sidestep {

constexpr int kMaxSurroundings = 256;
constexpr NumberRange kPositionRange_m{-1000.0, 1000.0};

/// Poses and shapes in the form that configurations and scenarios share.

enum class ShapeKind { kSphere, kCapsule, kBox, kCylinder };

/// size_m as in obstacle_t: sphere {radius, 0, 0}; capsule {radius, distance between the cap centres, 0} and cylinder
/// {radius, height, 0}, along its own z axis; box {edges along its own axes}.
struct ShapeSize {
  ShapeKind kind = ShapeKind::kSphere;
  Vector3 size_m = Vector3::Zero();
};

/// An entry of the list `surroundings`: a shape at rest, base frame.
struct RestingShape {
  int32_t id = 0;  ///< in the status of the controller: -2 for the first, -3 for the second, ...
  ShapeSize shape;
  Vector3 position_m = Vector3::Zero();  ///< of the centre
  Quaternion orientation = Quaternion::Identity();
};

/// The keys `shape` and, depending on the shape, `radius_m`, `length_m`, `height_m` or `edges_m`.
ShapeSize read_shape(YamlSection& section);

/// The required key `position_m`.
Vector3 read_position(YamlSection& section);

/// The key `quaternion`, order w x y z, normalized; identity when absent.
Quaternion read_orientation(YamlSection& section);

/// The keys `base_position_m` and `base_rpy_rad` of the section `neighbours`: the pose of the base in the world frame,
/// with roll, pitch and yaw as in a URDF.
Eigen::Isometry3d read_world_from_base(YamlSection& neighbours);

/// The list `surroundings` of a configuration, at most kMaxSurroundings.
std::vector<RestingShape> read_resting_shapes(YamlSection& config);

}  // namespace sidestep
