#pragma once

#include <string>
#include <vector>

#include "firmware/model/arm.h"

namespace sidestep {

/// How the meshes of a URDF are found and enclosed.
struct MeshOptions {
  std::vector<std::string> package_path;  ///< folders searched for `package://` before those of ROS_PACKAGE_PATH
  int capsules_per_mesh = 3;              ///< at most so many capsules enclose one mesh
};

/// Acceleration limit of each joint unless the configuration sets one; a URDF contains none.
constexpr double kDefaultAcceleration_radps2 = 10.0;

/// Reads a URDF and takes the chain base -> tip: kMinJoints to kMaxJoints revolute or continuous joints, and fixed
/// joints anywhere. Every collision shape becomes capsules: a sphere exactly; a cylinder as the capsule with its radius
/// and length between the cap centres; a box as capsule_around_box(); a mesh as fit_capsules(). Of a body's capsules
/// only those that lie in no other of them are kept.
/// The structure that the base link is fixed to (a pedestal, a torso) contributes shapes of body 0. Links fixed to a
/// link of the chain belong to it; links on a further movable joint (fingers) do too, with that joint at zero.
/// Throws std::runtime_error with one line that names the file and the error. Does not call check_limits().
Arm load_arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
             const MeshOptions& meshes = {});

/// Throws std::runtime_error, one line, unless for each joint lower < upper, and the velocity and acceleration limits
/// are above 0 and at most 1e9.
void check_limits(const Arm& arm);

}  // namespace sidestep
