#include "host/sim/grasp.h"

#include <algorithm>

namespace sidestep::sim {
namespace {

Motion at_rest(const Eigen::Isometry3d& pose) {
  Motion motion;
  motion.position_m = pose.translation();
  motion.orientation = Eigen::Quaterniond(pose.linear());
  return motion;
}

}  // namespace

void Grasp::begin(const GraspStep& step, const Eigen::Isometry3d& tool_from_base, const World& world) {
  grip_ = {{}, step.allowed};
  grip_.allowed.insert(grip_.allowed.end(), step.held.begin(), step.held.end());
  for (const Obstacle& obstacle : world.obstacles) {
    if (std::find(step.held.begin(), step.held.end(), obstacle.id) == step.held.end()) continue;
    grip_.held.push_back(obstacle);
    grip_.held.back().motion = at_rest(tool_from_base * obstacle.motion.base_from_body());
  }
}

void Grasp::move(World& world) const {
  for (Obstacle& obstacle : world.obstacles)
    if (const auto moved = moved_.find(obstacle.id); moved != moved_.end()) obstacle.motion = at_rest(moved->second);
}

void Grasp::apply(double t_s, const Eigen::Isometry3d& base_from_tool, World& world) {
  if (steps_.empty()) return;
  const auto carry = [&] {
    for (const Obstacle& held : grip_.held) moved_[held.id] = base_from_tool * held.motion.base_from_body();
    move(world);
  };
  carry();
  for (; next_ < steps_.size() && steps_[next_].at_s <= t_s; ++next_)
    begin(steps_[next_], base_from_tool.inverse(), world);
  carry();
  world.grip = grip_;
}

}  // namespace sidestep::sim
