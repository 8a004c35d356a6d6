#include "host/campaign/scene_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/campaign/dodge_maker.h"
#include "host/campaign/plain_tracking.h"
#include "host/campaign/random.h"

namespace sidestep::campaign {
namespace {

constexpr double kNoFloor = -std::numeric_limits<double>::infinity();
constexpr double kRest_s = 5.0, kLongest_s = 12.0;
constexpr int kMostDraws = 20'000;  // of spheres, before another witness is drawn

/// A random posture within a share of the joint limits, high enough above the floor.
Joints draw_posture(Random& random, double share, double lowest_wrist_m) {
  const Limits limits = benchmark_limits();
  while (true) {
    Joints q_rad;
    for (int i = 0; i < kJoints; ++i) q_rad[i] = share * random.uniform(limits.lower_rad[i], limits.upper_rad[i]);
    const ArmPose arm = pose(q_rad);
    if (arm.tool().z() > 0.15 && arm.corners[3].z() > lowest_wrist_m) return q_rad;
  }
}

/// Start, goal and duration; false when the motion takes too long.
bool draw_witness(Random& random, Scene& scene) {
  scene.start_rad = draw_posture(random, 0.7, kNoFloor);
  scene.goal_rad = draw_posture(random, 0.8, 0.10);
  const double widest_rad = (scene.goal_rad - scene.start_rad).cwiseAbs().maxCoeff();
  scene.witness_s = 0.5 + 1.95 * widest_rad / 1.2;
  scene.periods = static_cast<int>(std::ceil((scene.witness_s + kRest_s) / kPeriod_s));
  return scene.witness_s + kRest_s <= kLongest_s;
}

std::vector<ArmPose> witness_poses(const Scene& scene) {
  std::vector<ArmPose> poses;
  for (int k = 0; k <= scene.periods; ++k) poses.push_back(pose(witness_rad(scene, k * kPeriod_s)));
  return poses;
}

Vector3 draw_velocity(Random& random, const Family& family) {
  const Vector3 direction = random.direction();
  return random.uniform(0.0, family.speed_mps) * direction;
}

SpherePath draw_sphere(Random& random, const Scene& scene) {
  const Vector3 start_m = random.in_box({-1.0, -1.0, 0.0}, {1.0, 1.0, 1.3});
  SpherePath path(start_m, draw_velocity(random, *scene.family));
  while (scene.family->erratic && path.last_knot_s() < scene.duration_s()) {
    const double duration_s = random.uniform(0.5, 2.0);
    path.then(duration_s, draw_velocity(random, *scene.family));
  }
  return path;
}

bool belongs(const std::vector<ArmPose>& witness, const SpherePath& sphere) {
  double least_m = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < witness.size(); ++k) {
    const Vector3 center_m = sphere.at(static_cast<double>(k) * kPeriod_s).position_m;
    least_m = std::min(least_m, clearance(witness[k], center_m, kSphereRadius_m));
    if (least_m < kWitnessClearance_m) return false;
  }
  return least_m <= kWitnessNear_m;
}

bool draw_spheres(Random& random, Scene& scene) {
  scene.spheres.clear();
  const auto wanted = static_cast<size_t>(random.whole(1, scene.family->most_obstacles));
  const std::vector<ArmPose> witness = witness_poses(scene);
  for (int draw = 0; draw < kMostDraws && scene.spheres.size() < wanted; ++draw) {
    SpherePath sphere = draw_sphere(random, scene);
    if (belongs(witness, sphere)) scene.spheres.push_back(std::move(sphere));
  }
  return scene.spheres.size() == wanted;
}

}  // namespace

Scene make_scene(const Family& family, uint64_t seed) {
  Scene scene{&family, seed, 0, {}, {}, 0.0, {}};
  Random random(family.stream, seed);
  bool kept = false;
  while (!kept)
    kept = family.dodge ? make_dodge(random, scene, draw_posture(random, 0.7, kNoFloor))
                        : draw_witness(random, scene) && draw_spheres(random, scene) && plain_tracking_hits(scene);
  return scene;
}

}  // namespace sidestep::campaign
