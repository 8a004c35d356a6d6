#include "firmware/foresight/expectation.h"

#include <algorithm>
#include <cmath>

#include "firmware/control/extrapolation.h"

namespace sidestep {
namespace {

// Deviations that do not change a forecast by more than its own coarseness. The limits for obstacles are above the
// noise of a good sensor's positions and below what a change of course makes of them in a tenth of a second.
constexpr double kObstacle_m = 0.01;
constexpr double kObstacleSpeed_mps = 0.05;
constexpr double kTarget_m = 0.005;
constexpr double kTargetSpeed_mps = 0.02;
constexpr double kTarget_rad = 0.03;
constexpr double kArm_rad = 0.05;
constexpr double kOtherJoint_rad = 0.01;  // or m

// Where obstacles move, only the first 0.6 s of a forecast are as exact as the arm's own evasion (rollout.cpp). With
// 0.3 s a retreat is given up and begun again too late in tests/data/search/track-29.yaml.
constexpr double kAmongMovers_s = 0.2;

bool within(const Vector3& a, const Vector3& b, double limit) {
  return (a - b).squaredNorm() <= limit * limit;
}

bool same_place(const Obstacle& now, const Obstacle& expected) {
  return now.id == expected.id && now.shape == expected.shape &&
         std::abs(now.capsule.radius_m - expected.capsule.radius_m) <= kObstacle_m &&
         within(now.capsule.start, expected.capsule.start, kObstacle_m) &&
         within(now.capsule.end, expected.capsule.end, kObstacle_m) &&
         within(now.velocity_mps, expected.velocity_mps, kObstacleSpeed_mps);
}

}  // namespace

void Expectation::set(const Snapshot& from, const Forecast& forecast) {
  valid_ = true;
  tracking_ = from.tracking;
  at_s_ = from.now_s;
  target_ = from.target;
  others_ = from.others;
  attachments_ = from.attachments;
  nearby_.count = from.nearby.count;
  std::copy_n(from.nearby.obstacles.begin(), from.nearby.count, nearby_.obstacles.begin());
  forecast_ = forecast;
}

double Expectation::lasts_s() const {
  const auto end = nearby_.obstacles.begin() + nearby_.count;
  return std::any_of(nearby_.obstacles.begin(), end, is_moving) ? kAmongMovers_s : kForecastPath_s;
}

bool Expectation::target_as_expected(const Snapshot& now, double after_s) const {
  if (!tracking_) return true;
  const Target expected = predicted_target(target_, after_s);
  return is_same_posture(now.target, expected, joint_scale_) &&
         now.target.tracks_orientation == expected.tracks_orientation &&
         within(now.target.position_m, expected.position_m, kTarget_m) &&
         within(now.target.velocity_mps, expected.velocity_mps, kTargetSpeed_mps) &&
         (!expected.tracks_orientation || now.target.orientation.angularDistance(expected.orientation) <= kTarget_rad);
}

bool Expectation::obstacles_as_expected(const Snapshot& now, double after_s) const {
  if (now.nearby.count != nearby_.count) return false;
  for (int i = 0; i < nearby_.count; ++i)
    if (!same_place(now.nearby.obstacles[i], extrapolated(nearby_.obstacles[i], after_s))) return false;
  return true;
}

bool Expectation::arm_as_expected(const Snapshot& now, double after_s) const {
  const int points = forecast_.path_rad.size();
  if (points == 0) return false;
  const int point = std::clamp(static_cast<int>(std::lround(after_s / forecast_.period_s)) - 1, 0, points - 1);
  return max_norm(now.arm.position_rad - forecast_.path_rad[point], joint_scale_) <= kArm_rad;
}

bool Expectation::other_joints_as_expected(const Snapshot& now) const {
  const auto near = [](double a, double b) { return std::abs(a - b) <= kOtherJoint_rad; };
  return std::equal(others_.position.begin(), others_.position.end(), now.others.position.begin(), near);
}

bool Expectation::holds(const Snapshot& now) const {
  const double after_s = now.now_s - at_s_;
  return valid_ && now.tracking == tracking_ && after_s >= 0.0 && after_s <= lasts_s() &&
         target_as_expected(now, after_s) && other_joints_as_expected(now) && are_same(now.attachments, attachments_) &&
         arm_as_expected(now, after_s) && obstacles_as_expected(now, after_s);
}

}  // namespace sidestep
