#include "firmware/io/lcm/obstacle_merger.h"

#include <algorithm>
#include <cmath>

#include "firmware/io/lcm/admission.h"
#include "firmware/io/lcm/obstacle_encoder.h"

namespace sidestep {
namespace {

// Obstacle 3 of neighbour 2 is called -20003.
constexpr int kIdsOfANeighbour = 10000;

/// What jumps or vanishes is looked for in the whole.
Settings without_memory(Settings settings) {
  settings.timeouts.coast_s = 0.0;
  return settings;
}

}  // namespace

struct ObstacleMerger::Part {
  Part(const Config& config, const Eigen::Isometry3d& from)
      : gate(config.model.arm.joints, without_memory(config.model.settings)), base_from_part(from) {}

  Admission gate;
  Eigen::Isometry3d base_from_part;
  ObstacleSet set, draft;
  double received_s = -HUGE_VAL;
};

ObstacleMerger::ObstacleMerger(const Config& config) : limit_s_(config.model.settings.timeouts.obstacles_s) {
  const Neighbours& neighbours = config.neighbours;
  if (neighbours.listen.empty()) return;
  parts_.push_back(std::make_unique<Part>(config, Eigen::Isometry3d::Identity()));
  for (size_t k = 0; k < neighbours.listen.size(); ++k)
    parts_.push_back(std::make_unique<Part>(config, neighbours.world_from_base.inverse()));
  whole_ = std::make_unique<ObstacleEncoder>(kMaxObstacles);
}

ObstacleMerger::~ObstacleMerger() = default;

std::optional<ObstacleMerger::Whole> ObstacleMerger::join(size_t number, const void* bytes, size_t size, double now_s) {
  if (parts_.empty()) return Whole{{static_cast<const uint8_t*>(bytes), size}, 0.0};
  Part& part = *parts_[number];
  const bool admitted = part.gate.admit(bytes, size, now_s, part.draft);
  if (!admitted) reason_ = part.gate.last_reason();
  if (!admitted) return {};
  std::copy_n(part.draft.obstacles.begin(), part.draft.count, part.set.obstacles.begin());
  part.set.count = part.draft.count;
  part.received_s = now_s;

  // A time to come is of a clock that has started over.
  for (const auto& other : parts_)
    if (other->received_s > now_s) other->received_s = -HUGE_VAL;
  const double at_s = oldest_s();
  if (!(now_s - at_s <= limit_s_)) return {};
  utime_ = std::max(utime_ + 1, static_cast<int64_t>(now_s * 1e6));
  whole_->begin(utime_);
  for (size_t k = 0; k < parts_.size(); ++k) add(*parts_[k], static_cast<int>(k), at_s);
  const Packet packet = whole_->finish();
  if (packet.size > 0) return Whole{packet, now_s - at_s};
  ++too_many_;
  reason_ = "more obstacles than a set holds";
  return {};
}

double ObstacleMerger::oldest_s() const {
  const auto older = [](const auto& a, const auto& b) { return a->received_s < b->received_s; };
  return (*std::min_element(parts_.begin(), parts_.end(), older))->received_s;
}

void ObstacleMerger::add(const Part& part, int number, double at_s) {
  for (int i = 0; i < part.set.count; ++i) {
    const Obstacle reported = transformed(part.base_from_part, part.set.obstacles[static_cast<size_t>(i)]);
    Obstacle obstacle = extrapolated(reported, at_s - part.received_s);
    if (number > 0) obstacle.id = -(number * kIdsOfANeighbour + i);
    whole_->add(obstacle);
  }
}

int64_t ObstacleMerger::rejected() const {
  int64_t sum = too_many_;
  for (const auto& part : parts_) sum += part->gate.rejected();
  return sum;
}

}  // namespace sidestep
