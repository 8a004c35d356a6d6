#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/arm.h"

namespace sidestep {

/// How the meshes of a URDF are found and enclosed.
struct MeshOptions {
  std::vector<std::string> package_path;  ///< folders searched for `package://` before those of ROS_PACKAGE_PATH
  int pieces_per_mesh = 8;                ///< at most so many convex pieces enclose one mesh
};

/// Positions of joints that are no part of the chain, rad or m, by name.
using JointPositions = std::map<std::string, double>;

/// A position that no such joint can have. what() is the complaint without the joint's name.
struct BadJointPosition : std::runtime_error {
  BadJointPosition(std::string the_joint, const std::string& complaint)
      : std::runtime_error(complaint), joint(std::move(the_joint)) {}
  std::string joint;
};

/// Acceleration limit of each joint unless the configuration sets one; a URDF contains none. Lifts and rails are heavy.
constexpr double kDefaultAcceleration_radps2 = 10.0;
constexpr double kDefaultAcceleration_mps2 = 1.0;  ///< of a prismatic joint

/// Reads a URDF and takes the chain base -> tip: kMinJoints to kMaxJoints revolute, continuous or prismatic joints,
/// and fixed joints anywhere. Collision shapes are exact: spheres, cylinders, boxes, and a cylinder with a sphere of
/// its radius at both ends as a capsule; a mesh becomes the convex pieces of split_mesh(). Shapes that lie in a capsule
/// or sphere of their body are left out. The structure that carries the base link (a pedestal, a torso) contributes
/// shapes of body 0, and links fixed to a link of the chain belong to its body. Links behind further movable joints are
/// where `positions` puts these joints. A joint that mimics another follows it. A joint without a position: on a link
/// of the chain (fingers) it is at 0, or at the limit nearest to 0; below the arm (a lift, a head, another arm) the
/// links behind it are left out. Both are recorded in Arm::warnings. Throws std::runtime_error with one line that names
/// the file and the error, BadJointPosition for a position of a joint that does not exist, is in the chain, is fixed,
/// mimics another, or cannot be there. Does not call check_limits().
Arm load_arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
             const MeshOptions& meshes = {}, const JointPositions& positions = {});

/// Throws std::runtime_error, one line, unless for each joint lower < upper, both finite for a prismatic joint, and the
/// velocity and acceleration limits are above 0 and at most 1e9.
void check_limits(const Arm& arm);

}  // namespace sidestep
