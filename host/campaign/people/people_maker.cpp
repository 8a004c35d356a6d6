#include "host/campaign/people/people_maker.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware/model/nearest_points.h"
#include "host/campaign/people/behaviour.h"

namespace sidestep::campaign {
namespace {

constexpr double kApart_m = 0.15;  // of the persons from the arm at the beginning and the end
constexpr double kColumnDistance_m = 0.15;
constexpr double kPersonsApart_m = 0.45;  // between the axes of two trunks
constexpr double kRest_s = 3.0, kDuration_s = 11.0;
constexpr int kMostDraws = 100;  // of a person for a task

/// The point at which a part of a person aims, and when.
struct Aim {
  Vector3 point_m;
  double time_s;
};

Aim draw_aim(Random& random, const Scene& scene) {
  const Joints q_rad = scene.start_rad + random.uniform(0.0, 1.0) * (scene.goal_rad - scene.start_rad);
  const ArmPose pose = scene.arm->pose(q_rad);
  const auto link = static_cast<size_t>(random.integer(1, static_cast<int>(pose.corners.size()) - 2));
  const Vector3 point_m = pose.corners[link] + random.uniform(0.0, 1.0) * (pose.corners[link + 1] - pose.corners[link]);
  return {point_m, random.uniform(2.0, 4.0)};
}

/// The near arm of the passer-by, or the trunk, passes the point.
Behaviour draw_passer_by(Random& random, const Anatomy& anatomy, const Aim& aim, double floor_m, double end_s) {
  const double heading_rad = random.uniform(-M_PI, M_PI), speed_mps = random.uniform(1.05, 1.45);
  const Vector3 forward(std::cos(heading_rad), std::sin(heading_rad), 0.0), left(-forward.y(), forward.x(), 0.0);
  const double aside_m = random.uniform(-1.2, 1.2) * anatomy.half_shoulders_m();
  Vector3 start_m = aim.point_m - speed_mps * aim.time_s * forward + aside_m * left;
  start_m.z() = floor_m;
  return walking(random, anatomy, start_m, heading_rad, speed_mps, end_s);
}

/// A person who stands so that the hand of one side gets to the point; `share` of the reach away, horizontally.
struct Stand {
  Vector3 floor_m, point_m;  ///< the point in the person's frame
  double heading_rad;
  size_t side;
};

Stand draw_stand(Random& random, const Anatomy& anatomy, const Aim& aim, double floor_m, double least, double most) {
  Stand stand{Vector3::Zero(), Vector3::Zero(), random.uniform(-M_PI, M_PI), static_cast<size_t>(random.integer(0, 1))};
  const double away_m = random.uniform(least, most) * anatomy.reach_m();
  stand.point_m = {away_m, shoulder_m(anatomy, stand.side).y() + random.uniform(-0.15, 0.15),
                   aim.point_m.z() - floor_m};
  const Vector3 turned_m = Eigen::AngleAxisd(stand.heading_rad, Vector3::UnitZ()) * stand.point_m;
  stand.floor_m = {aim.point_m.x() - turned_m.x(), aim.point_m.y() - turned_m.y(), floor_m};
  return stand;
}

std::optional<Behaviour> draw_behaviour(Random& random, const Anatomy& anatomy, People people, const Aim& aim,
                                        double floor_m) {
  if (people == People::kWalkBy) return draw_passer_by(random, anatomy, aim, floor_m, aim.time_s + 2.0);
  const bool reaches = people == People::kReachIn;
  const Stand stand = draw_stand(random, anatomy, aim, floor_m, reaches ? 0.6 : 0.4, reaches ? 1.2 : 0.9);
  const double away_m = (stand.point_m - shoulder_m(anatomy, stand.side)).norm();
  if (reaches ? away_m > 1.35 * anatomy.reach_m()
              : away_m > 0.95 * anatomy.reach_m() || away_m < 0.35 * anatomy.reach_m())
    return std::nullopt;
  const auto behave = reaches ? reaching : gesturing;
  return behave(random, anatomy, stand.floor_m, stand.heading_rad, stand.side, stand.point_m, aim.time_s);
}

/// Whether the persons keep away from the base column, and from the arm at the beginning and at the end.
bool keeps_apart(const Scene& scene, const std::vector<CapsulePath>& person) {
  const ArmPose start = scene.arm->pose(scene.start_rad), goal = scene.arm->pose(scene.goal_rad);
  const auto apart = [&](const ArmPose& pose, double t_s) {
    std::vector<Capsule> capsules(person.size());
    std::transform(person.begin(), person.end(), capsules.begin(),
                   [t_s](const CapsulePath& path) { return path.at(t_s).capsule; });
    return scene.arm->clearance(pose, capsules, kApart_m) >= kApart_m;
  };
  if (!apart(start, 0.0) || !apart(start, scene.duration_s()) || !apart(goal, scene.duration_s())) return false;
  const Capsule column{start.corners[0], start.corners[1], 0.0};
  for (int k = 0; k <= scene.periods; k += 5) {
    for (const CapsulePath& path : person) {
      const Capsule capsule = path.at(k * kPeriod_s).capsule;
      const NearestPoints nearest = nearest_on_axes(column, capsule);
      if ((nearest.a - nearest.b).norm() - capsule.radius_m < kColumnDistance_m) return false;
    }
  }
  return true;
}

/// Whether the trunks of the scene's first person and of another are apart.
bool trunks_keep_apart(const Scene& scene, const std::vector<CapsulePath>& other) {
  for (int k = 0; k <= scene.periods && !scene.capsules.empty(); k += 5) {
    const Vector3 between_m =
        scene.capsules[kTorso].at(k * kPeriod_s).capsule.centre() - other[kTorso].at(k * kPeriod_s).capsule.centre();
    if (between_m.norm() < kPersonsApart_m) return false;
  }
  return true;
}

/// Adds a person who does this. Returns false if none is found.
bool add_person(Random& random, Scene& scene, People people, double floor_m) {
  for (int draw = 0; draw < kMostDraws; ++draw) {
    const Anatomy anatomy = draw_anatomy(random);
    const Aim aim = draw_aim(random, scene);
    const auto behaviour = draw_behaviour(random, anatomy, people, aim, floor_m);
    if (!behaviour || behaviour->end_s + kRest_s > scene.duration_s()) continue;
    const std::vector<CapsulePath> person = record(anatomy, behaviour->at, scene.duration_s());
    if (!keeps_apart(scene, person) || !trunks_keep_apart(scene, person)) continue;
    scene.capsules.insert(scene.capsules.end(), person.begin(), person.end());
    return true;
  }
  return false;
}

}  // namespace

bool make_people(Random& random, Scene& scene, double motion_s) {
  constexpr People kOne[] = {People::kWalkBy, People::kReachIn, People::kGesture};
  scene.capsules.clear();
  scene.periods = static_cast<int>(kDuration_s / kPeriod_s);
  scene.move_s = scene.start_rad == scene.goal_rad ? 0.0 : motion_s + random.uniform(0.2, 1.0);
  scene.moves = scene.move_s > 0.0 ? 1 + static_cast<int>((scene.duration_s() - kRest_s - motion_s) / scene.move_s) : 1;
  const double floor_m = -random.uniform(0.4, 0.9);
  const bool two = scene.family->people == People::kTwo;
  for (int person = 0; person < (two ? 2 : 1); ++person)
    if (!add_person(random, scene, two ? kOne[random.integer(0, 2)] : scene.family->people, floor_m)) return false;
  return true;
}

}  // namespace sidestep::campaign
