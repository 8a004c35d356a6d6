#include "firmware/foresight/self_motion.h"

#include <algorithm>
#include <cmath>

#include "firmware/foresight/inverse_kinematics.h"
#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr int kParts = 15;                // of a leg
constexpr double kShortest_s = 1e-3;      // of a part, so that times of knots increase
constexpr double kLongestPart_rad = 0.5;  // a joint that moves farther has left the branch of the point before

/// The least factor by which a guide can be stretched in time so that it keeps the limits. The acceleration of a cubic
/// is largest at an end; its velocity is looked at in the middle, too.
double least_duration_s(const JointLimits& limits, double share, const Guide& guide) {
  double by_velocity = 0.0, by_acceleration = 0.0;
  for (int i = 0; i + 1 < guide.knots; ++i) {
    const double part = guide.time_s[i + 1] - guide.time_s[i];
    const JointVector mean = (guide.position_rad[i + 1] - guide.position_rad[i]) / part;
    const JointVector &before = guide.velocity_radps[i], &after = guide.velocity_radps[i + 1];
    const JointVector middle = 1.5 * mean - 0.25 * (before + after);
    const JointVector first = (6.0 * mean - 4.0 * before - 2.0 * after) / part;
    const JointVector last = (2.0 * before + 4.0 * after - 6.0 * mean) / part;
    by_velocity = std::max(
        by_velocity, before.cwiseAbs().cwiseMax(middle.cwiseAbs()).cwiseQuotient(limits.velocity_radps).maxCoeff());
    by_acceleration =
        std::max(by_acceleration,
                 first.cwiseAbs().cwiseMax(last.cwiseAbs()).cwiseQuotient(limits.acceleration_radps2).maxCoeff());
  }
  return std::max(by_velocity / share, std::sqrt(by_acceleration / share));
}

}  // namespace

bool SelfMotion::add_leg(const JointVector& goal_rad) {
  JointVector before_rad = points_rad_[points_rad_.size() - 1];
  const Vector3 from_m = forward_kinematics(arm_, before_rad).tool_position;
  const Vector3 way_m = forward_kinematics(arm_, goal_rad).tool_position - from_m;
  for (int i = 1; i <= kParts; ++i) {
    JointVector next_rad = goal_rad;
    if (i < kParts) {
      next_rad = before_rad + (goal_rad - before_rad) / (kParts + 1 - i);
      Target place;
      place.position_m = from_m + way_m * (static_cast<double>(i) / kParts);
      if (!solve_ik(arm_, place, next_rad)) return false;
    }
    if ((next_rad - before_rad).cwiseQuotient(arm_.joint_scale).cwiseAbs().maxCoeff() > kLongestPart_rad) return false;
    points_rad_.add(next_rad);
    before_rad = next_rad;
  }
  return true;
}

/// s counts the time along the path at the velocity limits, from 0 to S, and grows as s = S (3u^2 - 2u^3) from u = 0 to
/// 1. Velocities and accelerations of the cubics by u then give the least duration.
Guide SelfMotion::guide(double start_s, double share) const {
  const int parts = points_rad_.size() - 1;
  BoundedList<double, kMaxKnots> length_s;  // of each part, in s
  double whole_s = 0.0;
  for (int i = 0; i < parts; ++i) {
    const JointVector way_rad = points_rad_[i + 1] - points_rad_[i];
    length_s.add(std::max(kShortest_s, way_rad.cwiseAbs().cwiseQuotient(arm_.limits.velocity_radps).maxCoeff()));
    whole_s += length_s[i];
  }
  Guide guide;
  guide.foresight_status = ForesightStatus::kGuided;
  guide.add(0.0, points_rad_[0]);
  double s = 0.0;
  for (int i = 1; i < parts; ++i) {
    s += length_s[i - 1];
    const double u = 0.5 - std::sin(std::asin(1.0 - 2.0 * s / whole_s) / 3.0);
    const JointVector slope = (points_rad_[i + 1] - points_rad_[i - 1]) / (length_s[i - 1] + length_s[i]);  // dq/ds
    guide.add(u, points_rad_[i], 6.0 * u * (1.0 - u) * whole_s * slope);
  }
  guide.add(1.0, points_rad_[parts]);
  const double duration_s = std::max(whole_s, least_duration_s(arm_.limits, share, guide));  // not 0 without a way
  for (int i = 0; i < guide.knots; ++i) {
    guide.time_s[i] = start_s + duration_s * guide.time_s[i];
    guide.velocity_radps[i] /= duration_s;
  }
  return guide;
}

}  // namespace sidestep
