#include "firmware/control/obstacle_memory.h"

#include <algorithm>
#include <limits>

namespace sidestep {
namespace {

constexpr double kNoise_m = 0.05;     // of a measured position
constexpr double kShrink_m = 0.01;    // of a half dimension; half the default hard clearance
constexpr double kRounding_s = 1e-6;  // of times that are whole periods apart

/// Largest displacement of an end of the axis, or of the side of a turned box; swapped ends and opposite sides are the
/// same pose.
double displacement_m(const Obstacle& before, const Obstacle& now) {
  const Capsule &a = before.capsule, &b = now.capsule;
  const double straight_m = std::max((a.start - b.start).norm(), (a.end - b.end).norm());
  const double crossed_m = std::max((a.start - b.end).norm(), (a.end - b.start).norm());
  const Vector3 &u = before.half_width_m, &v = now.half_width_m;
  return std::max(std::min(straight_m, crossed_m), std::min((u - v).norm(), (u + v).norm()));
}

/// Half the length of the axis, m.
double half_length_m(const Obstacle& obstacle) {
  return 0.5 * (obstacle.capsule.end - obstacle.capsule.start).norm();
}

/// Whether an obstacle has become smaller in one of its dimensions, or has another shape, which may be smaller.
bool has_shrunk(const Obstacle& before, const Obstacle& now) {
  return before.shape != now.shape || half_length_m(before) > half_length_m(now) + kShrink_m ||
         before.capsule.radius_m > now.capsule.radius_m + kShrink_m ||
         before.half_width_m.norm() > now.half_width_m.norm() + kShrink_m ||
         before.half_thickness_m > now.half_thickness_m + kShrink_m;
}

/// The speed of the fastest point of the axis.
double speed_mps(const Obstacle& obstacle) {
  return obstacle.velocity_mps.norm() + obstacle.angular_velocity_radps.norm() * half_length_m(obstacle);
}

}  // namespace

bool ObstacleMemory::could_move(const Obstacle& before, const Obstacle& now, double elapsed_s) const {
  const double fastest_mps = std::max({speed_bound_mps_, speed_mps(before), speed_mps(now)});
  return displacement_m(before, now) <= fastest_mps * elapsed_s + kNoise_m;
}

bool ObstacleMemory::is_valid(const RememberedObstacle& remembered, double now_s) const {
  // A time in the future was stored before the clock was set back.
  return remembered.since_s <= now_s && remembered.since_s + coast_s_ > now_s + kRounding_s;
}

void ObstacleMemory::remember_change(RememberedObstacle before, const Obstacle& now, double elapsed_s) {
  const bool jumped = !could_move(before.obstacle, now, elapsed_s);
  if (!jumped && !has_shrunk(before.obstacle, now)) return;
  if (jumped) {
    before.obstacle.velocity_mps.setZero();
    before.obstacle.angular_velocity_radps.setZero();
    before.obstacle.mean_velocity_mps.setZero();
    before.obstacle.lead_mps.setZero();
  }
  remember(before);
}

void ObstacleMemory::remember(const RememberedObstacle& changed) {
  if (!changed_.is_full()) return changed_.add(changed);
  changed_[next_change_] = changed;
  next_change_ = (next_change_ + 1) % kMaxObstacles;
}

/// Merges three lists sorted by id: the previous set, the new set and the vanished obstacles. Obstacles only in the
/// previous set vanish; obstacles in both may have jumped or shrunk; vanished ones that are reported again are dropped.
void ObstacleMemory::compare(const ObstacleSet& set, double elapsed_s, double now_s) {
  const Remembered& were_vanished = vanished_[current_];
  Remembered& vanished = vanished_[1 - current_];
  vanished.clear();
  int b = 0, n = 0, g = 0;
  const auto keep_vanished_below = [&](int64_t id) {
    for (; g < were_vanished.size() && were_vanished[g].obstacle.id < id; ++g)
      if (is_valid(were_vanished[g], now_s)) keep(were_vanished[g], vanished);
  };
  while (b < before_count_ || n < set.count) {
    const int64_t none = int64_t{std::numeric_limits<int32_t>::max()} + 1;
    const int64_t id_before = b < before_count_ ? before_[b].id : none;
    const int64_t id_now = n < set.count ? set.obstacles[order_[n]].id : none;
    keep_vanished_below(std::min(id_before, id_now));
    if (id_before < id_now) {
      keep({before_[b++], before_s_}, vanished);
    } else if (id_now < id_before) {
      if (g < were_vanished.size() && were_vanished[g].obstacle.id == id_now) {  // reported again
        if (has_shrunk(were_vanished[g].obstacle, set.obstacles[order_[n]])) remember(were_vanished[g]);
        ++g;
      }
      ++n;
    } else {
      remember_change({before_[b], before_s_}, set.obstacles[order_[n]], elapsed_s);
      ++b, ++n;
    }
  }
  keep_vanished_below(std::numeric_limits<int64_t>::max());
  current_ = 1 - current_;
}

bool ObstacleMemory::holds(int32_t id) const {
  const auto is_below = [](const Obstacle& obstacle, int32_t wanted) { return obstacle.id < wanted; };
  const auto end = before_.begin() + before_count_;
  const auto found = std::lower_bound(before_.begin(), end, id, is_below);
  return found != end && found->id == id;
}

void ObstacleMemory::add_late_set(const ObstacleSet& set, double late_s, double now_s) {
  sort_by_id(set, order_);
  const Remembered& were_vanished = vanished_[current_];
  Remembered& vanished = vanished_[1 - current_];
  vanished.clear();
  int b = 0, g = 0;
  for (int n = 0; n < set.count; ++n) {
    const RememberedObstacle late{set.obstacles[order_[n]], now_s};
    const int32_t id = late.obstacle.id;
    for (; g < were_vanished.size() && were_vanished[g].obstacle.id <= id; ++g)
      if (were_vanished[g].obstacle.id < id) keep(were_vanished[g], vanished);
    while (b < before_count_ && before_[b].id < id) ++b;
    if (b == before_count_ || before_[b].id > id)
      keep(late, vanished);
    else
      remember_change(late, before_[b], late_s);
  }
  while (g < were_vanished.size()) keep(were_vanished[g++], vanished);
  current_ = 1 - current_;
}

void ObstacleMemory::append(const RememberedObstacle& remembered, double now_s, ObstacleSet& set) const {
  if (!is_valid(remembered, now_s) || set.count == kMaxObstacles) return;
  set.obstacles[set.count++] = extrapolated(remembered.obstacle, now_s - remembered.since_s);
  ++set.remembered;
}

void ObstacleMemory::add_remembered(ObstacleSet& set, double elapsed_s, double now_s) {
  sort_by_id(set, order_);
  compare(set, elapsed_s, now_s);
  before_count_ = set.count;
  before_s_ = now_s;
  any_set_ = true;
  for (int n = 0; n < before_count_; ++n) before_[n] = set.obstacles[order_[n]];

  set.remembered = 0;
  for (const RememberedObstacle& changed : changed_) append(changed, now_s, set);
  for (const RememberedObstacle& vanished : vanished_[current_]) append(vanished, now_s, set);
}

}  // namespace sidestep
