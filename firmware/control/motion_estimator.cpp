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
constexpr int kNoiseDeviations = 20;     // the variance is about the mean of so many
constexpr int kLeastDeviations = 3;      // for fewer it is unknown
constexpr double kFastest_mps = 8.0;     // a hand reaches 6 m/s
constexpr double kNoise_m = 0.05;        // of a measured position
constexpr double kSameEdge = 0.7;        // cosine; where the axis of a box turns farther, another edge is the longest

constexpr double kLead_s = 0.2;
constexpr double kLargestLead_mps = 0.5;
constexpr double kLeadDeviations = 5.0;  // velocities by finite differences have noise that is correlated

constexpr double kMean_s = 0.5;               // about half a stride
constexpr double kLeastMeanSpeed_mps = 0.15;  // noise and a change of posture are below

}  // namespace

/// The noise of the newest report is learned from its deviation from the line between its neighbours, whose variance
/// per coordinate is noise^2 (1 + w^2 + (1 - w)^2).
void MotionEstimator::History::remember(const Report& now) {
  if (earlier_.size() > 0 && now.at_s - earlier_[0].at_s < kApart_s) return;
  if (earlier_.size() > 1) {
    const Report &middle = earlier_[0], &first = earlier_[1];
    const double w = (middle.at_s - first.at_s) / (now.at_s - first.at_s);
    const Vector3 deviation = middle.value - (1.0 - w) * first.value - w * now.value;
    const double variance = deviation.squaredNorm() / (3.0 * (1.0 + w * w + (1.0 - w) * (1.0 - w)));
    learned_ = std::min(learned_ + 1, kNoiseDeviations);
    noise2_ += (variance - noise2_) / learned_;
  }
  if (!earlier_.is_full()) earlier_.add(now);
  std::move_backward(earlier_.begin(), earlier_.end() - 1, earlier_.end());
  earlier_[0] = now;
}

MotionEstimator::History::Slope MotionEstimator::History::slope(const Report& now) const {
  Vector3 moment = Vector3::Zero(), mean = now.value;
  double mean_s = now.at_s, spread_s2 = 0.0;
  BoundedList<Report, 4> reports;
  reports.add(now);
  for (const Report& report : earlier_) {
    const double age_s = now.at_s - report.at_s;
    if (age_s < kYoungest_s || age_s > kOldest_s) continue;
    reports.add(report);
    mean += report.value;
    mean_s += report.at_s;
  }
  mean /= reports.size();
  mean_s /= reports.size();
  for (const Report& report : reports) {
    moment += (report.at_s - mean_s) * (report.value - mean);
    spread_s2 += (report.at_s - mean_s) * (report.at_s - mean_s);
  }
  if (spread_s2 == 0.0) return {Vector3::Zero(), 0.0};
  return {moment / spread_s2,
          learned_ < kLeastDeviations ? std::numeric_limits<double>::infinity() : noise2_ / spread_s2};
}

bool MotionEstimator::Point::rests(const Report& now) {
  const double rest_m = std::max(kRest_m, kRestDeviations * std::sqrt(positions_.noise2()));
  const bool left = (now.value - anchor_.value).norm() > rest_m;
  if (!left && now.at_s - anchor_.at_s <= kRest_s) return !moves_;
  moves_ = left;
  anchor_ = now;
  return !moves_;
}

Vector3 MotionEstimator::Point::velocity_mps(const Report& now) {
  began_ = positions_.is_empty() || (now.value - positions_.newest().value).norm() >
                                        kFastest_mps * (now.at_s - positions_.newest().at_s) + kNoise_m;
  if (began_) {
    positions_.clear();
    anchor_ = now;
    moves_ = false;
  }
  Vector3 velocity_mps = rests(now) ? Vector3(Vector3::Zero()) : positions_.slope(now).per_s;
  positions_.remember(now);
  return velocity_mps;
}

/// What the velocity is expected to change by within kLead_s, m/s.
Vector3 MotionEstimator::lead_mps(const Report& velocity_mps, History& velocities) {
  const auto [acceleration_mps2, variance] = velocities.slope(velocity_mps);
  velocities.remember(velocity_mps);
  const double by_noise2 = kLeadDeviations * kLeadDeviations * variance, squared = acceleration_mps2.squaredNorm();
  if (squared <= by_noise2) return Vector3::Zero();
  const Vector3 lead = kLead_s * (1.0 - by_noise2 / squared) * acceleration_mps2;
  return lead * std::min(1.0, kLargestLead_mps / lead.norm());
}

Vector3 MotionEstimator::mean_velocity_mps(const Obstacle& obstacle, Track& track, double now_s) {
  const bool is_person = obstacle.kind == Kind::kPerson;
  const Vector3 position_m = obstacle.capsule.centre();
  if (!is_person || track.centre.began()) track.mean_position_m = position_m;  // a thing may become a person
  if (!is_person) return Vector3::Zero();
  const double weight = 1.0 - std::exp(-(now_s - track.reported_s) / kMean_s);
  track.mean_position_m += weight * (position_m - track.mean_position_m);
  const Vector3 velocity_mps = (position_m - track.mean_position_m) / kMean_s;
  return velocity_mps.norm() < kLeastMeanSpeed_mps ? Vector3(Vector3::Zero()) : velocity_mps;
}

void MotionEstimator::complete(Obstacle& obstacle, Track& track) const {
  const Capsule& capsule = obstacle.capsule;
  const Vector3 velocity_mps = track.centre.velocity_mps({now_s_, capsule.centre()});
  const bool is_reported = !obstacle.velocity_mps.isZero(0.0);
  if (!is_reported) obstacle.velocity_mps = velocity_mps;
  if (track.centre.began()) track.velocities.clear();
  const Vector3 lead = lead_mps({now_s_, obstacle.velocity_mps}, track.velocities);
  obstacle.mean_velocity_mps = mean_velocity_mps(obstacle, track, now_s_);
  if (leads_ && (is_reported || track.centre.moves())) obstacle.lead_mps = lead;
  obstacle.velocity_mps += obstacle.lead_mps;
  Vector3 half_axis_m = 0.5 * (capsule.end - capsule.start);
  if (half_axis_m.squaredNorm() == 0.0) return;
  const double along_m2 = half_axis_m.dot(track.half_axis_m);
  if (along_m2 < 0.0) half_axis_m = -half_axis_m;  // the ends are reported in either order
  const bool same_edge = std::abs(along_m2) > kSameEdge * half_axis_m.norm() * track.half_axis_m.norm();
  if (obstacle.shape == Shape::kBox && !same_edge) track.axis = Point();
  track.half_axis_m = half_axis_m;
  const Vector3 tip_mps = track.axis.velocity_mps({now_s_, half_axis_m});
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
    complete(obstacle, track);
    track.reported_s = now_s_;
  }
  keep_unreported_below(int64_t{std::numeric_limits<int32_t>::max()} + 1);
  count_ = count;
  current_ = 1 - current_;
}

}  // namespace sidestep
