#include "firmware/control/jumps.h"

#include <algorithm>
#include <numeric>

namespace sidestep {
namespace {

constexpr double kNoise_m = 0.05;     // what a measurement may be wrong by
constexpr double kRounding_s = 1e-6;  // of times that are a whole number of periods apart

/// How far the ends of the axis have moved, or the sides of a box turned; which is which does not matter.
double displacement_m(const Obstacle& before, const Obstacle& now) {
  const Capsule &a = before.capsule, &b = now.capsule;
  const double straight_m = std::max((a.start - b.start).norm(), (a.end - b.end).norm());
  const double crossed_m = std::max((a.start - b.end).norm(), (a.end - b.start).norm());
  const Vector3 &u = before.half_width_m, &v = now.half_width_m;
  return std::max(std::min(straight_m, crossed_m), std::min((u - v).norm(), (u + v).norm()));
}

/// The speed of the fastest point of the axis.
double speed_mps(const Obstacle& obstacle) {
  const double half_length_m = 0.5 * (obstacle.capsule.end - obstacle.capsule.start).norm();
  return obstacle.velocity_mps.norm() + obstacle.angular_velocity_radps.norm() * half_length_m;
}

}  // namespace

void Jumps::sort(const ObstacleSet& set) {
  std::iota(order_.begin(), order_.begin() + set.count, 0);
  std::sort(order_.begin(), order_.begin() + set.count, [&](int a, int b) {
    const int32_t id_a = set.obstacles[a].id, id_b = set.obstacles[b].id;
    return id_a != id_b ? id_a < id_b : a < b;
  });
}

bool Jumps::could_move(const Obstacle& before, const Obstacle& now, double elapsed_s) const {
  const double fastest_mps = std::max({speed_bound_mps_, speed_mps(before), speed_mps(now)});
  return displacement_m(before, now) <= fastest_mps * elapsed_s + kNoise_m;
}

void Jumps::remember(const Obstacle& obstacle, double now_s) {
  OldPlace& place = places_[next_place_] = {obstacle, now_s + memory_s_};
  place.obstacle.velocity_mps.setZero();
  place.obstacle.angular_velocity_radps.setZero();
  next_place_ = (next_place_ + 1) % kMostPlaces;
}

void Jumps::complete(ObstacleSet& set, double elapsed_s, double now_s) {
  sort(set);
  for (int b = 0, n = 0; b < before_count_ && n < set.count;) {
    const Obstacle &before = before_[b], &now = set.obstacles[order_[n]];
    if (before.id == now.id && !could_move(before, now, elapsed_s)) remember(before, now_s);
    b += before.id <= now.id;
    n += now.id <= before.id;
  }
  before_count_ = set.count;
  for (int n = 0; n < before_count_; ++n) before_[n] = set.obstacles[order_[n]];

  set.old_places = 0;
  for (const OldPlace& place : places_) {
    // A time too far ahead is of a clock that has been set back.
    const bool counts = place.until_s > now_s + kRounding_s && place.until_s <= now_s + memory_s_;
    if (!counts || set.count == kMaxObstacles) continue;
    set.obstacles[set.count++] = place.obstacle;
    ++set.old_places;
  }
}

}  // namespace sidestep
