#pragma once

#include <Eigen/Geometry>
#include <kdl/tree.hpp>
#include <string>
#include <vector>

#include "host/sim/joints.h"
#include "host/sim/solid.h"

namespace sidestep::sim {

/// One collision shape of the arm, placed by Arm::place().
struct ArmPart {
  std::string link;
  Solid solid;
  bool moving = false;  ///< a joint of the chain moves it
  Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
};

/// Where a joint turns, base frame.
struct JointAxis {
  Eigen::Vector3d origin_m;   ///< a point of the axis
  Eigen::Vector3d direction;  ///< unit
};

/// The arm as its URDF describes it: forward kinematics and collision shapes of the links from base to tip, of what
/// hangs on them (fingers), joints off the chain at 0, and of all that the base is rigidly attached to. Poses are in
/// the frame of the base link.
class Arm {
 public:
  /// Throws std::runtime_error, one line naming the file, when the URDF cannot be read, base and tip are no chain of 1
  /// to kMaxJoints revolute, continuous or prismatic joints, or a shape is not a cylinder, sphere, box or readable
  /// mesh (looked for on package_path, too: firmware/model/load/mesh.h).
  Arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
      const std::vector<std::string>& package_path = {});

  int joints() const { return joints_; }
  void place(const JointVector& q_rad);

  const std::vector<ArmPart>& parts() const { return parts_; }
  const Eigen::Isometry3d& base_from_tool() const { return base_from_tool_; }

  /// Of all joints of the chain, base first.
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
