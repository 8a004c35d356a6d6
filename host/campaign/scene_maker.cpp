#include "host/campaign/scene_maker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "host/campaign/boxes/boxes_maker.h"
#include "host/campaign/dodge_maker.h"
#include "host/campaign/furniture/furniture_maker.h"
#include "host/campaign/people/people_maker.h"
#include "host/campaign/plain_tracking.h"
#include "host/campaign/random.h"
#include "host/campaign/witness_fit.h"

namespace sidestep::campaign {
namespace {

constexpr double kNoFloor = -std::numeric_limits<double>::infinity();
constexpr double kRest_s = 5.0, kLongest_s = 12.0;  // time after the witness's motion; longest scene
constexpr int kMostWitnesses = 100'000;             // draws until a witness is short enough
constexpr int kMostAttempts = 1'000;                // to make a scene; the LWA3's scenes needed up to 83
constexpr int kMostFurnitureAttempts = 200;         // the same among furniture; LWA3 and Panda needed up to 28
constexpr int kMostDraws = 20'000;                  // of a posture, or of spheres before another witness is drawn

/// Draws a posture within a share of the joints' range, high enough above the floor.
Joints draw_posture(Random& random, const JudgeArm& arm, double share, double lowest_wrist_m) {
  const Limits range = arm.range();
  Joints q_rad(range.lower_rad.size());
  for (int draw = 0; draw < kMostDraws; ++draw) {
    for (int i = 0; i < q_rad.size(); ++i) {
      const double middle_rad = 0.5 * (range.lower_rad[i] + range.upper_rad[i]);
      q_rad[i] = middle_rad + share * (random.uniform(range.lower_rad[i], range.upper_rad[i]) - middle_rad);
    }
    const ArmPose pose = arm.pose(q_rad);
    if (pose.tool().z() > 0.15 && pose.wrist().z() > lowest_wrist_m && arm.keeps_clear_of_itself(pose)) return q_rad;
  }
  throw std::runtime_error("no posture found whose tool is above the base and whose links keep clear of each other");
}

constexpr double kFastest_radps = 1.2;  // of the witness

/// The time in which a motion from start to goal takes the joints at about half of the slowest joint's speed; those of
/// the two kinds are timed separately.
double motion_s(const Scene& scene) {
  const ArmPose pose = scene.arm->pose(scene.goal_rad);
  const Limits limits = scene.arm->limits(*scene.family);
  double widest[2] = {}, speed[2] = {kFastest_radps, kFastest_radps * kPrismaticScale_m};
  for (int i = 0; i < scene.goal_rad.size(); ++i) {
    const bool kind = pose.is_prismatic(static_cast<size_t>(i));
    widest[kind] = std::max(widest[kind], std::abs(scene.goal_rad[i] - scene.start_rad[i]));
    speed[kind] = std::min(speed[kind], limits.velocity_radps[i]);
  }
  return 1.95 * std::max(widest[0] / speed[0], widest[1] / speed[1]);
}

/// Draws start, goal and duration. Returns false if the motion takes too long.
bool try_witness(Random& random, Scene& scene) {
  scene.start_rad = draw_posture(random, *scene.arm, 0.7, kNoFloor);
  scene.goal_rad = draw_posture(random, *scene.arm, 0.8, 0.10);
  scene.witness_s = 0.5 + motion_s(scene);
  scene.periods = static_cast<int>(std::ceil((scene.witness_s + kRest_s) / kPeriod_s));
  return scene.witness_s + kRest_s <= kLongest_s;
}

void draw_witness(Random& random, Scene& scene) {
  for (int draw = 0; draw < kMostWitnesses; ++draw)
    if (try_witness(random, scene)) return;
  throw std::runtime_error(
      fmt::format("{}: none of {} motions of the arm ends within {} s: are its joints limited to too low a speed?",
                  scene.family->name, kMostWitnesses, kLongest_s - kRest_s));
}

/// Poses of the witness at every period; empty if its links come too close to each other.
std::vector<ArmPose> witness_poses(const Scene& scene) {
  std::vector<ArmPose> poses;
  for (int k = 0; k <= scene.periods; ++k) {
    poses.push_back(scene.arm->pose(witness_rad(scene, k * kPeriod_s)));
    if (!scene.arm->keeps_clear_of_itself(poses.back())) return {};
  }
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
    path.add_knot(duration_s, draw_velocity(random, *scene.family));
  }
  return path;
}

bool draw_spheres(Random& random, Scene& scene) {
  scene.spheres.clear();
  const int most = scene.family->most_obstacles;
  const auto wanted = static_cast<size_t>(random.integer(std::min(1, most), most));
  const std::vector<ArmPose> witness = witness_poses(scene);
  if (witness.empty()) return false;
  for (int draw = 0; draw < kMostDraws && scene.spheres.size() < wanted; ++draw) {
    SpherePath sphere = draw_sphere(random, scene);
    if (fits_witness(*scene.arm, witness, sphere)) scene.spheres.push_back(std::move(sphere));
  }
  return scene.spheres.size() == wanted;
}

/// Half of the scenes hold the tool, the others move it between start and goal.
bool try_people(Random& random, Scene& scene) {
  scene.start_rad = scene.goal_rad = draw_posture(random, *scene.arm, 0.7, kNoFloor);
  if (random.uniform(0.0, 1.0) < 0.5) scene.goal_rad = draw_posture(random, *scene.arm, 0.7, kNoFloor);
  return make_people(random, scene, motion_s(scene)) && plain_tracking_hits(scene);
}

bool try_boxes(Random& random, Scene& scene) {
  const Joints start_rad = draw_posture(random, *scene.arm, 0.9, kNoFloor);
  return make_boxes(random, scene, start_rad, draw_posture(random, *scene.arm, 0.9, kNoFloor));
}

bool try_scene(Random& random, Scene& scene) {
  if (scene.family->has_furniture()) return make_furniture(random, scene);
  if (scene.family->has_people()) return try_people(random, scene);
  if (scene.family->boxes) return try_boxes(random, scene);
  if (scene.family->dodge) return make_dodge(random, scene, draw_posture(random, *scene.arm, 0.7, kNoFloor));
  draw_witness(random, scene);
  return draw_spheres(random, scene) && (scene.spheres.empty() || plain_tracking_hits(scene));
}

const char* lacks(const Family& family) {
  if (family.has_people()) return "persons touch an arm that does not evade";
  if (family.has_furniture()) return "path was found among furniture that blocks plain tracking";
  if (family.boxes) return "start and goal are above the ground and free of boxes";
  return "spheres keep clear of the witness and block plain tracking";
}

}  // namespace

Scene make_scene(const Family& family, uint64_t seed, const JudgeArm& arm) {
  Scene scene{};
  scene.family = &family;
  scene.seed = seed;
  scene.arm = &arm;
  Random random(family.stream, seed);
  const int most_attempts = family.has_furniture() ? kMostFurnitureAttempts : kMostAttempts;
  for (int attempt = 0; attempt < most_attempts; ++attempt)
    if (try_scene(random, scene)) return scene;
  throw std::runtime_error(
      fmt::format("{}: no scene in {} attempts: no {}", family.name, most_attempts, lacks(family)));
}

}  // namespace sidestep::campaign
