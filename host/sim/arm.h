#pragma once

#include <Eigen/Geometry>
#include <kdl/tree.hpp>
#include <string>
#include <vector>

#include "host/sim/joints.h"
#include "host/sim/solid.h"

namespace sidestep::sim {

/// One collision shape of the arm. Arm::place() computes its pose.
struct ArmPart {
  std::string link;
  Solid solid;
  bool moving = false;  ///< true when a joint of the chain moves it
  Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
};

/// The axis of a joint, base frame.
struct JointAxis {
  Eigen::Vector3d origin_m;   ///< a point of the axis
  Eigen::Vector3d direction;  ///< unit
};

/// The arm as its URDF describes it: forward kinematics and collision shapes. The links are those from base to tip,
/// those below them (such as fingers; joints off the chain are at 0) and those that the base is rigidly attached to.
/// Poses are in the frame of the base link. Independent of the kinematics of the controller.
class Arm {
 public:
  /// Throws std::runtime_error, one line that names the file, when the URDF cannot be read, when base and tip do not
  /// bound a chain of 1 to kMaxJoints revolute, continuous or prismatic joints, or when a shape is not a cylinder,
  /// sphere, box or readable mesh (search path of meshes: firmware/model/load/mesh.h).
  Arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
      const std::vector<std::string>& package_path = {});

  int joints() const { return joints_; }

  /// Computes the poses of all parts and of the tool in this configuration.
  void place(const JointVector& q_rad);

  const std::vector<ArmPart>& parts() const { return parts_; }
  const Eigen::Isometry3d& base_from_tool() const { return base_from_tool_; }

  /// Axes of all joints of the chain, base first.
  std::vector<JointAxis> axes() const;

 private:
  struct Body {
    KDL::Segment segment;
    int parent = -1;  ///< index of an earlier body
    int joint = -1;   ///< index into q, -1: rigidly attached
    bool moving = false;
    KDL::Frame base_from_body;
  };
  struct Mount {
    int body;
    KDL::Frame body_from_part;
  };
  class Builder;

  int joints_ = 0;
  int tool_body_ = 0;
  std::vector<Body> bodies_;  ///< parents first
  std::vector<ArmPart> parts_;
  std::vector<Mount> mounts_;  ///< one per part
  Eigen::Isometry3d base_from_tool_ = Eigen::Isometry3d::Identity();
};

}  // namespace sidestep::sim
