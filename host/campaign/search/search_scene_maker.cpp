#include "host/campaign/search/search_scene_maker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sidestep::campaign {
namespace {

constexpr int kMostDraws = 100'000;    // of a scene or an obstacle; a scene of five obstacles needs some hundred
constexpr int kMostMutations = 1'000;  // until one is valid
constexpr double kStartShare = 0.8;    // of the joints' range
constexpr double kLeastRadius_m = 0.03, kLargestRadius_m = 0.12, kLargestHalfAxis_m = 0.4;

Joints draw_start(Random& random, const Limits& limits) {
  Joints start_rad(limits.lower_rad.size());
  for (int i = 0; i < start_rad.size(); ++i) {
    const double share = 0.5 + kStartShare * random.uniform(-0.5, 0.5);
    start_rad[i] = limits.lower_rad[i] + share * (limits.upper_rad[i] - limits.lower_rad[i]);
  }
  return start_rad;
}

MovingCapsule draw_obstacle(Random& random, const SearchSpace& space, const ArmPose& pose) {
  const auto link = static_cast<size_t>(random.integer(1, static_cast<int>(pose.corners.size()) - 2));
  const double along = random.uniform(0.0, 1.0);
  MovingCapsule obstacle;
  obstacle.crossing_m = pose.corners[link] + along * (pose.corners[link + 1] - pose.corners[link]);
  obstacle.radius_m = random.uniform(kLeastRadius_m, kLargestRadius_m);
  obstacle.half_axis_m = Vector3::Zero();
  if (random.uniform(0.0, 1.0) < 0.5) {
    const double half_axis_m = random.uniform(0.05, kLargestHalfAxis_m);
    obstacle.half_axis_m = half_axis_m * random.direction();
  }
  const double speed_mps = random.uniform(0.4 * space.fastest_mps, space.fastest_mps);
  obstacle.velocity_mps = speed_mps * random.direction();
  obstacle.crossing_s = random.uniform(0.6, 1.4) / speed_mps;
  return obstacle;
}

/// Adds one obstacle that is valid by itself. Returns false if there is no room for any.
bool add_obstacle(Random& random, const SearchSpace& space, SearchScene& scene) {
  const ArmPose pose = lwa3_arm().pose(scene.start_rad);
  SearchScene alone{scene.family, scene.start_rad, {}};
  for (int draw = 0; draw < 100; ++draw) {
    alone.obstacles = {draw_obstacle(random, space, pose)};
    if (!is_valid(alone, space.limits, space.fastest_mps)) continue;
    scene.obstacles.push_back(alone.obstacles.front());
    return true;
  }
  return false;
}

double jittered(Random& random, double value, double deviation) {
  return value + deviation * random.normal();
}

Vector3 jittered(Random& random, const Vector3& value, double deviation) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return value + deviation * Vector3(x, y, z);
}

void mutate(Random& random, double fastest_mps, MovingCapsule& obstacle) {
  obstacle.crossing_m = jittered(random, obstacle.crossing_m, 0.03);
  obstacle.crossing_s = jittered(random, obstacle.crossing_s, 0.2);
  const double speed_mps =
      std::clamp(jittered(random, obstacle.velocity_mps.norm(), 0.1 * fastest_mps), kLeastSpeed_mps, fastest_mps);
  // Rounding must not make the speed larger than the fastest.
  obstacle.velocity_mps =
      (1.0 - 1e-12) * speed_mps * jittered(random, obstacle.velocity_mps.normalized(), 0.12).normalized();
  obstacle.radius_m = std::clamp(jittered(random, obstacle.radius_m, 0.01), kLeastRadius_m, kLargestRadius_m);
  if (obstacle.half_axis_m.isZero(0.0)) return;
  obstacle.half_axis_m = jittered(random, obstacle.half_axis_m, 0.04);
  obstacle.half_axis_m *= std::min(1.0, kLargestHalfAxis_m / obstacle.half_axis_m.norm());
}

}  // namespace

SearchScene draw_search_scene(Random& random, const SearchSpace& space) {
  for (int draw = 0; draw < kMostDraws; ++draw) {
    SearchScene scene{space.family, draw_start(random, space.limits), {}};
    if (!is_valid(scene, space.limits, space.fastest_mps)) continue;
    while (static_cast<int>(scene.obstacles.size()) < space.obstacles && add_obstacle(random, space, scene)) {
    }
    if (static_cast<int>(scene.obstacles.size()) == space.obstacles) return scene;
  }
  throw std::runtime_error("no valid scene of the search found");
}

SearchScene mutated(Random& random, const SearchSpace& space, const SearchScene& scene) {
  for (int draw = 0; draw < kMostMutations; ++draw) {
    SearchScene changed = scene;
    for (MovingCapsule& obstacle : changed.obstacles)
      if (random.uniform(0.0, 1.0) < 0.7) mutate(random, space.fastest_mps, obstacle);
    if (random.uniform(0.0, 1.0) < 0.5)
      for (double& q_rad : changed.start_rad) q_rad = jittered(random, q_rad, 0.1);
    if (is_valid(changed, space.limits, space.fastest_mps)) return changed;
  }
  return scene;
}

}  // namespace sidestep::campaign
