#pragma once

#include <optional>
#include <vector>

#include "firmware/model/load/link_shapes.h"

namespace sidestep {

/// Throws BadJointPosition for a position of a joint that does not exist, is between the links of the chain, is fixed,
/// mimics another, or cannot be there.
void check_positions(const urdf::ModelInterface& model, const std::vector<std::string>& chain_links,
                     const JointPositions& positions);

/// Collects the movable joints outside the chain and their positions into an Arm: other_joints, other_positions,
/// other_frames and warnings.
class OtherJointCollector {
 public:
  /// All arguments must outlive the collector.
  OtherJointCollector(const std::string& urdf_file, const urdf::ModelInterface& model, const JointPositions& positions,
                      Arm& arm)
      : file_(urdf_file), model_(model), positions_(positions), arm_(arm) {}

  enum Direction { kAsInUrdf, kInverse };

  /// Adds a joint and returns its index; nothing if it is below the arm and nobody gave its position. inverse: the
  /// frame of the joint moves with its parent link, seen from its child link. Throws std::runtime_error if there are
  /// too many.
  std::optional<int> add(const urdf::Joint& joint, const Mount& mount, const Eigen::Isometry3d& mount_from_joint,
                         Direction direction = kAsInUrdf);

  /// Records that a link and those behind it are left out; or all links but those behind this one.
  void leave_out(const urdf::Link& link);
  void leave_out_below(const urdf::Link& link);

  /// Resolves the joints that mimic others and places all joints.
  void finish();

  /// Whether a link or one behind it has a collision shape.
  static bool carries_shapes(const urdf::Link& link);

 private:
  std::optional<double> position_of(const urdf::Joint& joint, int depth = 0) const;
  bool follows_another(const urdf::Joint& joint) const;
  bool assumes_zero_behind(const urdf::Link& link) const;
  void report_assumed(const urdf::Joint& joint, int parent, double position);
  void resolve_mimic(OtherJoint& joint);

  const std::string& file_;
  const urdf::ModelInterface& model_;
  const JointPositions& positions_;
  Arm& arm_;
  std::vector<bool> assumed_;  ///< of each joint: nobody gave its position
};

}  // namespace sidestep
