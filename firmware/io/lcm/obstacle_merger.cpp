#include "firmware/io/lcm/obstacle_merger.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr int kIdsPerNeighbour = -kNeighbourIds;

}  // namespace

struct ObstacleMerger::Part {
  Part(const Eigen::Isometry3d& from, bool leads) : base_from_part(from), estimator(leads) {}

  Eigen::Isometry3d base_from_part;
  MessageOrder order;
  MotionEstimator estimator;
  ObstacleSet sets[2];
  int current = 0;  ///< index of the accepted set; the other one is the draft
  double received_s = -HUGE_VAL;
};

ObstacleMerger::ObstacleMerger(size_t neighbours, const Eigen::Isometry3d& base_from_world, double timeout_s,
                               bool estimates_motion)
    : timeout_s_(timeout_s), estimates_motion_(estimates_motion) {
  parts_.push_back(std::make_unique<Part>(Eigen::Isometry3d::Identity(), true));
  for (size_t k = 0; k < neighbours; ++k) parts_.push_back(std::make_unique<Part>(base_from_world, false));
}

ObstacleMerger::~ObstacleMerger() = default;

ObstacleSet& ObstacleMerger::draft(size_t part) {
  return parts_[part]->sets[1 - parts_[part]->current];
}

bool ObstacleMerger::accept(size_t number, int64_t utime, double now_s) {
  Part& part = *parts_[number];
  if (!part.order.accept(utime, now_s, timeout_s_)) return false;
  if (estimates_motion_) part.estimator.complete(draft(number), part.order.sending_interval_s());
  part.current = 1 - part.current;
  part.received_s = now_s;
  return true;
}

std::optional<ObstacleMerger::Merged> ObstacleMerger::merge(double now_s, ObstacleSet& merged) {
  // A time in the future was received before the clock was set back.
  for (const auto& part : parts_)
    if (part->received_s > now_s) part->received_s = -HUGE_VAL;
  too_many_ = false;
  const double at_s = oldest_s();
  if (!(now_s - at_s <= timeout_s_)) return {};
  utime_ = std::max(utime_ + 1, static_cast<int64_t>(now_s * 1e6));
  merged.count = merged.remembered = 0;
  for (size_t k = 0; k < parts_.size(); ++k) add(*parts_[k], static_cast<int>(k), at_s, merged);
  if (too_many_) return {};
  return Merged{utime_, now_s - at_s};
}

double ObstacleMerger::oldest_s() const {
  const auto older = [](const auto& a, const auto& b) { return a->received_s < b->received_s; };
  return (*std::min_element(parts_.begin(), parts_.end(), older))->received_s;
}

void ObstacleMerger::add(const Part& part, int number, double at_s, ObstacleSet& merged) {
  const ObstacleSet& set = part.sets[part.current];
  if (merged.count + set.count > kMaxObstacles) too_many_ = true;
  if (too_many_) return;
  for (int i = 0; i < set.count; ++i) {
    const Obstacle reported = transformed(part.base_from_part, set.obstacles[static_cast<size_t>(i)]);
    Obstacle& obstacle = merged.obstacles[static_cast<size_t>(merged.count++)];
    obstacle = extrapolated(reported, at_s - part.received_s);
    if (number > 0) obstacle.id = -(number * kIdsPerNeighbour + i);
  }
}

}  // namespace sidestep
