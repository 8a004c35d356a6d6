#include "firmware/foresight/person_retreat.h"

#include <algorithm>
#include <cmath>

#include "firmware/foresight/rollout.h"
#include "firmware/model/nearest_points.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

// All constants are tuned on the campaign family two-people@camera with the Panda, seed 4.
constexpr double kExposed_m = 0.6;
constexpr double kCoast_s = 0.3;

// Squeezed.
constexpr double kNear_m = 0.5, kNearest_m = 0.4;
constexpr double kFastLimb_mps = 1.5;  // strokes are faster than hands that reach
constexpr int kFirstBody = 3;

// Beginning and end of a retreat.
constexpr int kConfirm_calls = 2;
constexpr int kRelease_calls = 100;
constexpr double kWorth = 0.7;
constexpr double kNewTarget_m = 0.05;

// The search: every other candidate is near the best one, the rest is around the present posture.
constexpr int kCandidatesPerCall = 12;
constexpr double kNearBest_rad = 0.4, kAround_rad = 1.5;
constexpr double kLimitMargin = 0.05;  // share of the range: at a limit a link can leave in one direction only
constexpr int kWayPoints = 4;
constexpr double kWayWeight = 0.5;
constexpr double kWayClearance_m = 0.06, kWayLoss_m = 0.03, kRestClearance_m = 0.02;
constexpr int kLeadEvery_calls = 10;  // a new guide starts from rest
constexpr double kBetter = 0.8;
constexpr double kLimitShare = 0.9;  // of the velocity and acceleration limits; the rest is left to the shield
constexpr double kShortest_s = 0.05;

bool is_person(const Obstacle& obstacle) {
  return obstacle.kind == Kind::kPerson;
}

bool has_person(const NearbyObstacles& nearby) {
  return std::any_of(nearby.obstacles.begin(), nearby.obstacles.begin() + nearby.count, is_person);
}

double distance_m(const Capsule& a, const Capsule& b) {
  const NearestPoints points = nearest_on_axes(a, b);
  return (points.a - points.b).norm() - a.radius_m - b.radius_m;
}

/// The least of least_m and the distances of a link to a person now and kCoast_s later.
double nearest_m(const Capsule& link, const Obstacle& person, double least_m) {
  const double now_m = distance_m(link, person.capsule);
  if (now_m - person.velocity_mps.norm() * kCoast_s >= least_m) return least_m;
  Capsule soon = person.capsule;
  soon.start += kCoast_s * person.velocity_mps;
  soon.end += kCoast_s * person.velocity_mps;
  return std::min({least_m, now_m, distance_m(link, soon)});
}

using LinkCapsules = BoundedList<Capsule, kMaxShapes>;

/// Of the bodies from first_body on.
LinkCapsules links_at(const Arm& arm, const JointVector& q_rad, const OtherFrames& others, int first_body) {
  const LinkPoses poses = forward_kinematics(arm, q_rad, others);
  LinkCapsules links;
  for (int s = 0; s < shape_count(arm, poses); ++s)
    if (shape_at(arm, poses, s).body >= first_body) links.add(transformed(poses, shape_at(arm, poses, s)));
  return links;
}

/// The surface distance of a person's part to the nearest link, m, and the direction to it.
struct Side {
  double distance_m = kNear_m;
  Vector3 normal = Vector3::Zero();
};

Side side_of(const Obstacle& person, const LinkCapsules& links) {
  Side side;
  for (const Capsule& link : links) {
    const NearestPoints points = nearest_on_axes(link, person.capsule);
    const Vector3 gap = points.a - points.b;
    const double apart_m = gap.norm() - link.radius_m - person.capsule.radius_m;
    if (apart_m < side.distance_m) side = {apart_m, gap.normalized()};
  }
  return side;
}

/// A position limit; half a turn where a joint has none. (A prismatic joint has one.)
double bounded(double limit_rad, double otherwise_rad) {
  return std::isfinite(limit_rad) ? limit_rad : otherwise_rad;
}

}  // namespace

void PersonRetreat::reset() {
  random_ = SplitMix64(model_.settings.foresight.seed);
  guide_ = Guide{};
  retreats_ = false;
  squeezed_calls_ = free_calls_ = led_calls_ = 0;
  best_exposure_ = kNotFound;
}

double PersonRetreat::exposure(const JointVector& q_rad, const Snapshot& now) const {
  const OtherFrames others = place_others(model_.arm, now.others, now.attachments);
  double sum = 0.0;
  for (const Capsule& link : links_at(model_.arm, q_rad, others, 1)) {
    double least_m = kExposed_m;
    for (int i = 0; i < now.nearby.count; ++i)
      if (is_person(now.nearby.obstacles[i])) least_m = nearest_m(link, now.nearby.obstacles[i], least_m);
    const double share = (kExposed_m - least_m) / kExposed_m;
    sum += share * share;
  }
  return sum;
}

bool PersonRetreat::is_squeezed(const JointVector& q_rad, const Snapshot& now) const {
  const OtherFrames others = place_others(model_.arm, now.others, now.attachments);
  const LinkCapsules links = links_at(model_.arm, q_rad, others, kFirstBody);
  BoundedList<Vector3, kMaxNearbyObstacles> normals;
  double least_m = kNear_m;
  for (int i = 0; i < now.nearby.count; ++i) {
    const Obstacle& person = now.nearby.obstacles[i];
    if (!is_person(person)) continue;
    const Side side = side_of(person, links);
    if (side.distance_m >= kNear_m) continue;
    if (person.velocity_mps.norm() > kFastLimb_mps) return true;
    normals.add(side.normal);
    least_m = std::min(least_m, side.distance_m);
  }
  if (least_m > kNearest_m) return false;
  return std::any_of(normals.begin(), normals.end(), [&](const Vector3& a) {
    return std::any_of(normals.begin(), normals.end(), [&](const Vector3& b) { return a.dot(b) < 0.0; });
  });
}

/// Of a posture with the straight way to it; kNotFound where the posture alone is at least `bound`, where it is not
/// free or where the way is not.
double PersonRetreat::exposure_with_way(const JointVector& to_rad, double bound, const Snapshot& now) const {
  const JointVector& from_rad = now.arm.position_rad;
  const double at_end = exposure(to_rad, now);
  if (at_end >= bound || !free_.contains(to_rad)) return kNotFound;
  const OtherFrames others = place_others(model_.arm, now.others, now.attachments);
  const auto clearance_m = [&](const JointVector& q_rad, double enough_m) {
    return clearance_after(model_.arm, forward_kinematics(model_.arm, q_rad, others), now.nearby.obstacles.data(),
                           now.nearby.count, 0.0, enough_m);
  };
  const double enough_m = std::min(kWayClearance_m, clearance_m(from_rad, kWayClearance_m) - kWayLoss_m);
  double way = 0.0;
  for (int i = 1; i <= kWayPoints; ++i) {
    const JointVector q_rad = from_rad + (static_cast<double>(i) / kWayPoints) * (to_rad - from_rad);
    if (clearance_m(q_rad, enough_m) < enough_m) return kNotFound;
    if (i < kWayPoints) way += exposure(q_rad, now) / (kWayPoints - 1);
  }
  return at_end + kWayWeight * way;
}

JointVector PersonRetreat::random_posture(const JointVector& around_rad, double range_rad) {
  const JointLimits& limits = model_.arm.limits;
  JointVector q_rad = around_rad;
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double range = range_rad * model_.arm.joint_scale[i];
    const double lower = bounded(limits.lower_rad[i], -M_PI), upper = bounded(limits.upper_rad[i], M_PI);
    const double margin = kLimitMargin * (upper - lower);
    q_rad[i] = std::clamp(q_rad[i] + random_.uniform(-range, range), lower + margin, upper - margin);
  }
  return q_rad;
}

void PersonRetreat::search(const Snapshot& now) {
  free_.set(now, kWayClearance_m, kRestClearance_m);
  if (best_exposure_ < kNotFound) best_exposure_ = exposure_with_way(best_rad_, kNotFound, now);
  for (int k = 0; k < kCandidatesPerCall; ++k) {
    const bool improves = best_exposure_ < kNotFound && k % 2 == 0;
    const JointVector q_rad =
        improves ? random_posture(best_rad_, kNearBest_rad) : random_posture(now.arm.position_rad, kAround_rad);
    const double found = exposure_with_way(q_rad, best_exposure_, now);
    if (found >= best_exposure_) continue;
    best_rad_ = q_rad;
    best_exposure_ = found;
  }
}

void PersonRetreat::lead_to_best(const Snapshot& now) {
  const JointLimits& limits = model_.arm.limits;
  guide_ = Guide{};
  guide_.foresight_status = ForesightStatus::kWaiting;
  guide_.add(now.now_s, now.arm.position_rad);
  // The profile of a guide reaches 1.5 distance / duration in velocity and 6 distance / duration^2 in acceleration.
  const JointVector distance_rad = (best_rad_ - now.arm.position_rad).cwiseAbs();
  const double by_velocity_s = 1.5 * distance_rad.cwiseQuotient(limits.velocity_radps).maxCoeff();
  const double by_acceleration_s = std::sqrt(6.0 * distance_rad.cwiseQuotient(limits.acceleration_radps2).maxCoeff());
  const double duration_s = std::max(by_velocity_s, by_acceleration_s) / kLimitShare;
  guide_.add(now.now_s + std::max(kShortest_s, duration_s), best_rad_);
  led_calls_ = 0;
}

bool PersonRetreat::may_begin(const Snapshot& now) {
  if (!is_squeezed(now.arm.position_rad, now)) {
    squeezed_calls_ = 0;
    best_exposure_ = kNotFound;
    return false;
  }
  search(now);
  if (++squeezed_calls_ < kConfirm_calls) return false;
  return best_exposure_ <= kWorth * (1.0 + kWayWeight) * exposure(now.arm.position_rad, now);
}

bool PersonRetreat::goes_on(const Snapshot& now) {
  free_calls_ = is_squeezed(squeezed_rad_, now) ? 0 : free_calls_ + 1;
  const bool same_target = is_same_posture(now.target, target_, model_.arm.joint_scale) &&
                           (now.target.position_m - target_.position_m).norm() <= kNewTarget_m;
  return free_calls_ < kRelease_calls && same_target;
}

bool PersonRetreat::update(const Snapshot& now) {
  if (!now.moves || !now.tracking || !(retreats_ || has_person(now.nearby))) {
    reset();
    return false;
  }
  if (!retreats_) {
    if (!may_begin(now)) return false;
    retreats_ = true;
    free_calls_ = 0;
    squeezed_rad_ = now.arm.position_rad;
    target_ = now.target;
    lead_to_best(now);
    return true;
  }
  if (!goes_on(now)) {
    reset();
    return false;
  }
  search(now);
  if (++led_calls_ < kLeadEvery_calls) return true;
  const double led = exposure_with_way(guide_.position_rad[guide_.knots - 1], kNotFound, now);
  if (best_exposure_ < kBetter * led) lead_to_best(now);
  return true;
}

}  // namespace sidestep
