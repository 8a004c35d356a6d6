#pragma once

#include <map>
#include <vector>

#include "host/sim/world.h"

namespace sidestep::sim {

/// One entry of a scenario's list `grasp`: from at_s on the tool holds the obstacles with these ids and may touch them
/// and the allowed ones, until the next entry.
struct GraspStep {
  double at_s = 0.0;
  std::vector<int32_t> held, allowed;
};

/// Moves the obstacles of a world that the tool takes, carries and puts down. An obstacle is held in the pose relative
/// to the tool that it has when its step begins, and stays where the tool lets go of it.
class Grasp {
 public:
  /// Times must not decrease.
  explicit Grasp(std::vector<GraspStep> steps) : steps_(std::move(steps)) {}

  /// Changes the world of t_s to what the tool has made of it, and sets its grip. Times must not decrease. Without
  /// steps the world stays as it is.
  void apply(double t_s, const Eigen::Isometry3d& base_from_tool, World& world);

 private:
  void begin(const GraspStep& step, const Eigen::Isometry3d& tool_from_base, const World& world);
  void move(World& world) const;

  std::vector<GraspStep> steps_;
  size_t next_ = 0;
  Grip grip_;
  std::map<int32_t, Eigen::Isometry3d> moved_;  ///< base_from_obstacle of those that the tool has ever held
};

}  // namespace sidestep::sim
