#include "firmware/control/motion_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sidestep {
namespace {

constexpr double kApart_s = 0.025;                      // less between two reports would amplify noise
constexpr double kYoungest_s = 0.01, kOldest_s = 0.35;  // of an earlier report that counts: three at 10 Hz
constexpr double kRest_s = 0.4;
constexpr double kRest_m = 0.02;
constexpr double kRestDeviations = 7.0;  // of noise: so far apart are two reports once in ten thousand
constexpr double kNoiseShare = 0.05;     // of a new deviation in the variance
constexpr double kFastest_mps = 8.0;     // a hand reaches 6 m/s
constexpr double kNoise_m = 0.05;        // of a measured position

}  // namespace

void MotionEstimator::Point::begin(const Report& now) {
  earlier_.clear();
  anchor_ = now;
  moves_ = false;
}

/// Keeps the report if the newest one is old enough, and learns the noise: of the newest report, from its deviation
/// from the line between its neighbours, whose variance per coordinate is noise^2 (1 + w^2 + (1 - w)^2).
void MotionEstimator::Point::remember(const Report& now) {
  if (earlier_.size() > 0 && now.at_s - earlier_[0].at_s < kApart_s) return;
  if (earlier_.size() > 1) {
    const Report &middle = earlier_[0], &first = earlier_[1];
    const double w = (middle.at_s - first.at_s) / (now.at_s - first.at_s);
    const Vector3 deviation_m = middle.at_m - (1.0 - w) * first.at_m - w * now.at_m;
    const double variance_m2 = deviation_m.squaredNorm() / (3.0 * (1.0 + w * w + (1.0 - w) * (1.0 - w)));
    noise2_m2_ += kNoiseShare * (variance_m2 - noise2_m2_);
  }
  if (!earlier_.is_full()) earlier_.add(now);
  std::move_backward(earlier_.begin(), earlier_.end() - 1, earlier_.end());
  earlier_[0] = now;
}

bool MotionEstimator::Point::rests(const Report& now) {
  const double rest_m = std::max(kRest_m, kRestDeviations * std::sqrt(noise2_m2_));
  const bool left = (now.at_m - anchor_.at_m).norm() > rest_m;
  if (!left && now.at_s - anchor_.at_s <= kRest_s) return !moves_;
  moves_ = left;
  anchor_ = now;
  return !moves_;
}

Vector3 MotionEstimator::Point::slope_mps(const Report& now) const {
  Vector3 moment = Vector3::Zero(), mean_m = now.at_m;
  double mean_s = now.at_s, spread_s2 = 0.0;
  BoundedList<Report, 4> reports;
  reports.add(now);
  for (const Report& report : earlier_) {
    const double age_s = now.at_s - report.at_s;
    if (age_s < kYoungest_s || age_s > kOldest_s) continue;
    reports.add(report);
    mean_m += report.at_m;
    mean_s += report.at_s;
  }
  mean_m /= reports.size();
  mean_s /= reports.size();
  for (const Report& report : reports) {
    moment += (report.at_s - mean_s) * (report.at_m - mean_m);
    spread_s2 += (report.at_s - mean_s) * (report.at_s - mean_s);
  }
  return spread_s2 > 0.0 ? Vector3(moment / spread_s2) : Vector3(Vector3::Zero());
}

Vector3 MotionEstimator::Point::velocity_mps(const Vector3& now_m, double now_s) {
  const Report now{now_s, now_m};
  const bool follows =
      earlier_.size() > 0 && (now_m - earlier_[0].at_m).norm() <= kFastest_mps * (now_s - earlier_[0].at_s) + kNoise_m;
  if (!follows) begin(now);
  Vector3 velocity_mps = rests(now) ? Vector3(Vector3::Zero()) : slope_mps(now);
  remember(now);
  return velocity_mps;
}

void MotionEstimator::complete(Obstacle& obstacle, Track& track, double now_s) {
  const Capsule& capsule = obstacle.capsule;
  const Vector3 velocity_mps = track.centre.velocity_mps(capsule.centre(), now_s);
  if (obstacle.velocity_mps.isZero(0.0)) obstacle.velocity_mps = velocity_mps;
  if (capsule.is_sphere()) return;
  Vector3 half_axis_m = 0.5 * (capsule.end - capsule.start);
  if (half_axis_m.dot(track.half_axis_m) < 0.0) half_axis_m = -half_axis_m;  // the ends are reported in either order
  track.half_axis_m = half_axis_m;
  const Vector3 tip_mps = track.axis.velocity_mps(half_axis_m, now_s);
  if (obstacle.angular_velocity_radps.isZero(0.0))
    obstacle.angular_velocity_radps = half_axis_m.cross(tip_mps) / half_axis_m.squaredNorm();
}

void MotionEstimator::complete(ObstacleSet& set, double elapsed_s) {
  now_s_ += std::max(0.0, elapsed_s);
  sort_by_id(set, order_);
  const auto& before = tracks_[current_];
  auto& next = tracks_[1 - current_];
  int b = 0, count = 0, room = kMaxObstacles - set.count;
  const auto keep_unreported_below = [&](int64_t id) {
    for (; b < count_ && before[b].id < id; ++b)
      if (room > 0 && now_s_ - before[b].reported_s <= kOldest_s) next[count++] = before[b], --room;
  };
  for (int n = 0; n < set.count; ++n) {
    Obstacle& obstacle = set.obstacles[order_[n]];
    keep_unreported_below(obstacle.id);
    const bool same_id = b < count_ && before[b].id == obstacle.id;
    Track& track = next[count++] = same_id ? before[b++] : Track();
    if (track.shape != obstacle.shape) track = Track();
    track.id = obstacle.id;
    track.shape = obstacle.shape;
    track.reported_s = now_s_;
    complete(obstacle, track, now_s_);
  }
  keep_unreported_below(int64_t{std::numeric_limits<int32_t>::max()} + 1);
  count_ = count;
  current_ = 1 - current_;
}

}  // namespace sidestep
