#include "firmware/foresight/free_space.h"

#include <algorithm>
#include <cmath>

#include "firmware/control/shield/required_clearance.h"
#include "firmware/model/link_proximity.h"
#include "firmware/model/nearest_points.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

constexpr double kSamePlace_m = 0.002;

bool rests(const Obstacle& obstacle) {
  return fastest_point_mps(obstacle) < kMoves_mps;
}

bool are_same(const Obstacle& a, const Obstacle& b) {
  const auto near = [](const Vector3& x, const Vector3& y) { return (x - y).cwiseAbs().maxCoeff() < kSamePlace_m; };
  return a.shape == b.shape && near(a.capsule.start, b.capsule.start) && near(a.capsule.end, b.capsule.end) &&
         near(a.half_width_m, b.half_width_m) && std::abs(a.capsule.radius_m - b.capsule.radius_m) < kSamePlace_m &&
         std::abs(a.half_thickness_m - b.half_thickness_m) < kSamePlace_m;
}

void copy_resting(const NearbyObstacles& from, NearbyObstacles& to) {
  to.count = 0;
  for (int i = 0; i < from.count; ++i)
    if (rests(from.obstacles[i])) to.obstacles[to.count++] = from.obstacles[i];
}

/// Of the box around a core, in its frame.
Vector3 half_box_m(const ConvexSolid& solid) {
  return solid.kind == CoreKind::kPoint ? Vector3::Zero() : Vector3(solid.half_m.cwiseAbs());
}

}  // namespace

/// The link shapes in one configuration.
struct FreeSpace::Links {
  const Arm& arm;
  LinkPoses poses;
  BoundedList<Capsule, kMaxShapes> capsules;

  Links(const Arm& of, const JointVector& q_rad, const OtherFrames& others)
      : arm(of), poses(forward_kinematics(of, q_rad, others)) {
    for (int s = 0; s < shape_count(arm, poses); ++s) capsules.add(transformed(poses, shape_at(arm, poses, s)));
  }
  ConvexSolid solid(int shape) const {
    const BodyShape& link = shape_at(arm, poses, shape);
    return link.is_capsule ? ConvexSolid::of(capsules[shape]) : solid_of(poses, link);
  }
  /// Between two shapes; exact below enough_m.
  double distance_m(const SelfPair& pair, double enough_m) const {
    const Capsule &a = capsules[pair.first], &b = capsules[pair.second];
    const NearestPoints points = nearest_on_axes(a, b);
    const double apart_m = (points.a - points.b).norm() - a.radius_m - b.radius_m;
    if (apart_m >= enough_m) return enough_m;
    return distance_between_m(solid(pair.first), solid(pair.second), a.centre() - b.centre(), enough_m);
  }
};

void FreeSpace::set(const Snapshot& from, double moving_m, double rest_m) {
  attachments_ = from.attachments;
  others_ = place_others(model_.arm, from.others, attachments_);
  copy_resting(from.nearby, resting_);
  const Links links(model_.arm, from.arm.position_rad, others_);
  obstacles_.clear();
  for (int i = 0; i < resting_.count; ++i) {
    const Obstacle& obstacle = resting_.obstacles[i];
    const int last_body = last_body_to_keep_clear(model_.arm, links.poses, obstacle.id);
    if (last_body < 0) continue;
    const ConvexSolid solid = solid_of(obstacle);
    double required_m = required_clearance_m(moving_m, rest_m, obstacle);
    const double now_m = clearance_after(model_.arm, links.poses, &obstacle, 1, 0.0, required_m + kStartAllowance_m);
    required_m = std::min(required_m, now_m - kStartAllowance_m);
    obstacles_.add({solid, half_box_m(solid), required_m, last_body});
  }
  pair_count_ = 0;
  const auto add_pair = [&](SelfPair pair) {
    pair.clearance_m = links.distance_m(pair, pair.clearance_m + kStartAllowance_m) - kStartAllowance_m;
    pairs_[pair_count_++] = pair;
  };
  for (const SelfPair& pair : model_.self_pairs) add_pair(pair);
  for_each_held_pair(model_.arm, attachments_, add_pair);
}

bool FreeSpace::is_current(const Snapshot& now) const {
  if (!are_same(now.attachments, attachments_)) return false;
  int count = 0;
  for (int i = 0; i < now.nearby.count; ++i) {
    const Obstacle& obstacle = now.nearby.obstacles[i];
    if (!rests(obstacle)) continue;
    if (count == resting_.count || !are_same(obstacle, resting_.obstacles[count++])) return false;
  }
  return count == resting_.count;
}

bool FreeSpace::keeps_clear_of_obstacles(const Links& links) const {
  for (int s = 0; s < links.capsules.size(); ++s) {
    const BodyShape& shape = shape_at(model_.arm, links.poses, s);
    if (shape.body == 0) continue;
    const Vector3 centre = links.capsules[s].centre();
    const double extent_m = shape.capsule_body.extent_m();
    for (const StaticObstacle& obstacle : obstacles_) {
      if (shape.body > obstacle.last_body) continue;
      const double reach_m = extent_m + obstacle.solid.radius_m + obstacle.required_m;
      const Vector3 there = obstacle.solid.rotation.transpose() * (centre - obstacle.solid.centre);
      if ((there.cwiseAbs() - obstacle.half_m).cwiseMax(0.0).squaredNorm() >= reach_m * reach_m) continue;
      const Vector3 away = centre - obstacle.solid.centre;
      const double enough_m = obstacle.required_m;
      if (!shape.is_capsule &&
          distance_between_m(ConvexSolid::of(links.capsules[s]), obstacle.solid, away, enough_m) >= enough_m)
        continue;
      if (distance_between_m(links.solid(s), obstacle.solid, away, enough_m) < enough_m) return false;
    }
  }
  return true;
}

bool FreeSpace::keeps_clear_of_itself(const Links& links) const {
  return std::none_of(
      pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(pair_count_),
      [&](const SelfPair& pair) { return links.distance_m(pair, pair.clearance_m) < pair.clearance_m; });
}

bool FreeSpace::contains(const JointVector& q_rad) const {
  const Links links(model_.arm, q_rad, others_);
  return keeps_clear_of_obstacles(links) && keeps_clear_of_itself(links);
}

/// In the order of repeated bisection, which finds what is in the way early.
bool FreeSpace::contains_way(const JointVector& from_rad, const JointVector& to_rad, int& checks_left) const {
  const JointVector way_rad = to_rad - from_rad;
  const double length_rad = euclidean_norm(way_rad, model_.arm.joint_scale);
  int parts = 1;
  while (length_rad > parts * kEdgeStep_rad) parts *= 2;
  for (int stride = parts; stride > 1; stride /= 2)
    for (int i = stride / 2; i < parts; i += stride) {
      --checks_left;
      if (!contains(from_rad + way_rad * (static_cast<double>(i) / parts))) return false;
    }
  return true;
}

}  // namespace sidestep
