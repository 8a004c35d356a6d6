#pragma once

#include "firmware/base/bounded_list.h"
#include "firmware/foresight/snapshot.h"

namespace sidestep {

/// The configurations in which the arm keeps its clearances to what rests and between its links. Obstacles that move
/// are left out. Large: lives on the heap.
class FreeSpace {
 public:
  explicit FreeSpace(const Model& model)
      : model_(model), pairs_(model.self_pairs.size() + kMaxHeldShapes * model.arm.shapes.size()) {}

  /// The world of a snapshot. Obstacles are required to be required_clearance_m(moving_m, rest_m) away. Where the arm
  /// is nearer to one now, or two links are nearer than their clearance, that distance less kStartAllowance_m is
  /// enough.
  void set(const Snapshot& from, double moving_m, double rest_m);

  /// Whether the obstacles at rest are those of set(), each within 2 mm, and the attachments are the same.
  bool is_current(const Snapshot& now) const;

  bool contains(const JointVector& q_rad) const;

  /// Whether the straight way is free, at points at most kEdgeStep_rad apart (times Arm::joint_scale). Counts its
  /// checks down in checks_left, and ends only when it knows.
  bool contains_way(const JointVector& from_rad, const JointVector& to_rad, int& checks_left) const;

  static constexpr double kStartAllowance_m = 0.001;
  static constexpr double kEdgeStep_rad = 0.025;

 private:
  struct StaticObstacle {
    ConvexSolid solid;
    Vector3 half_m;  ///< of the box around its core, in the core's frame
    double required_m;
    int last_body;  ///< shapes of bodies above may touch it
  };
  struct Links;

  bool keeps_clear_of_obstacles(const Links& links) const;
  bool keeps_clear_of_itself(const Links& links) const;

  const Model& model_;
  Attachments attachments_;
  OtherFrames others_;
  NearbyObstacles resting_;
  BoundedList<StaticObstacle, kMaxNearbyObstacles> obstacles_;
  std::vector<SelfPair> pairs_;  ///< the first pair_count_: of links, and of what the tool holds
  size_t pair_count_ = 0;
};

}  // namespace sidestep
