#pragma once

#include <Eigen/Geometry>
#include <kdl/tree.hpp>
#include <map>
#include <string>
#include <vector>

#include "host/sim/joints.h"
#include "host/sim/solid.h"

namespace sidestep::sim {

/// One collision shape of the arm. Arm::place() computes its pose.
struct ArmPart {
  std::string link;
  Solid solid;
  int body = 0;         ///< number of joints of the chain between base and link; links with the same cannot move apart
  bool moving = false;  ///< true when a joint of the chain moves it
  Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
};

/// The axis of a joint, base frame.
struct JointAxis {
  Eigen::Vector3d origin_m;   ///< a point of the axis
  Eigen::Vector3d direction;  ///< unit
  bool prismatic = false;     ///< the joint moves along the axis, not about it
};

/// The arm as its URDF describes it: forward kinematics and collision shapes. The links are those from base to tip,
/// those below them (such as fingers) and those that carry the base. Joints off the chain have the given positions;
/// without one a joint below the tip or a link of the chain is at 0 or at its limit nearest to 0, and what is behind
/// any other joint is left out. Poses are in the frame of the base link. Independent of the kinematics of the
/// controller.
class Arm {
 public:
  /// Throws std::runtime_error, one line that names the file, when the URDF cannot be read, when base and tip do not
  /// bound a chain of 1 to kMaxJoints revolute, continuous or prismatic joints, or when a shape is not a cylinder,
  /// sphere, box or readable mesh (search path of meshes: firmware/model/load/mesh.h).
  Arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
      const std::vector<std::string>& package_path = {}, const std::map<std::string, double>& joint_positions = {});

  int joints() const { return joints_; }

  /// Position limits of the joints in the URDF, rad or m; -pi and pi where it has none (or none that are a range).
  const JointVector& lower() const { return lower_; }
  const JointVector& upper() const { return upper_; }

  /// Computes the poses of all parts and of the tool in this configuration.
  void place(const JointVector& q_rad);

  const std::vector<ArmPart>& parts() const { return parts_; }
  const Eigen::Isometry3d& base_from_tool() const { return base_from_tool_; }

  /// Axes of all joints of the chain, base first.
  std::vector<JointAxis> axes() const;

 private:
  struct Body {
    KDL::Segment segment;
    int parent = -1;       ///< index of an earlier body
    int joint = -1;        ///< index into q, -1: rigidly attached, or a joint off the chain
    int chain_joints = 0;  ///< between base and this body
    KDL::Frame base_from_body;
    double position = 0.0;  ///< of a joint off the chain
  };
  struct Mount {
    int body;
    KDL::Frame body_from_part;
  };
  class Builder;

  int joints_ = 0;
  JointVector lower_, upper_;
  int tool_body_ = 0;
  std::vector<Body> bodies_;  ///< parents first
  std::vector<ArmPart> parts_;
  std::vector<Mount> mounts_;  ///< one per part
  Eigen::Isometry3d base_from_tool_ = Eigen::Isometry3d::Identity();
};

}  // namespace sidestep::sim
