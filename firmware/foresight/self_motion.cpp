#include "firmware/foresight/self_motion.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/bounded_least_squares.h"
#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr double kStep_rad = 0.05;
constexpr double kStalled_rad = 1e-3;  // a shorter step leads nowhere

// The tool returns to its place by this share of its distance in a step, and by no more than so much.
constexpr double kReturn = 0.25;
constexpr double kFastestReturn_m = 0.025;

constexpr int kMostParts = kMaxKnots - 1;  // of the path as a guide
constexpr double kShortest_s = 1e-3;       // of a part, so that times of knots increase

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

/// The step from the end of the path, in units of the scale, is w + y: w leads straight toward the goal, and y, within
/// the range, minimises |J (w + y) - x|^2 + damping^2 |y|^2 with the tool's way x back to its place.
JointVector SelfMotion::step_rad(const JointVector& goal_rad) const {
  const JointVector& q_rad = path_rad_[path_rad_.size() - 1];
  const JointVector &scale = arm_.joint_scale, per_scale = scale.cwiseInverse();
  const LinkPoses poses = forward_kinematics(arm_, q_rad);
  const TaskJacobian jacobian = tool_jacobian(poses, 3) * scale.asDiagonal();

  JointVector w = (goal_rad - q_rad).cwiseProduct(per_scale);
  w *= std::min(1.0, kStep_rad / w.cwiseAbs().maxCoeff());
  Vector3 x_m = kReturn * (place_m_ - poses.tool_position);
  if (x_m.norm() > kFastestReturn_m) x_m *= kFastestReturn_m / x_m.norm();
  const auto in_step = [&](const JointVector& limit_rad) {  // also for an arm beyond its limits
    return JointVector((limit_rad - q_rad).cwiseProduct(per_scale).cwiseMax(-kStep_rad).cwiseMin(kStep_rad) - w);
  };
  const JointVector lower = in_step(arm_.limits.lower_rad), upper = in_step(arm_.limits.upper_rad);
  return scale.cwiseProduct(w + bounded_least_squares(jacobian, x_m - jacobian * w, damping_, lower, upper));
}

bool SelfMotion::reach(const JointVector& goal_rad) {
  while (!path_rad_.is_full()) {
    const JointVector q_rad = path_rad_[path_rad_.size() - 1];
    if (max_norm(goal_rad - q_rad, arm_.joint_scale) < kStep_rad) {
      path_rad_.add(goal_rad);
      return true;
    }
    const JointVector step = step_rad(goal_rad);
    if (max_norm(step, arm_.joint_scale) < kStalled_rad) return false;
    path_rad_.add(q_rad + step);
  }
  return false;
}

/// Every so many steps are one part. s counts the time along the path at the velocity limits, from 0 to S, and grows as
/// s = S (3u^2 - 2u^3) from u = 0 to 1. Velocities and accelerations of the cubics by u then give the least duration.
Guide SelfMotion::guide(double start_s, double share) const {
  const int steps = path_rad_.size() - 1, parts = std::min(kMostParts, steps);
  BoundedList<JointVector, kMaxKnots> points_rad;
  for (int i = 0; i <= parts; ++i) points_rad.add(path_rad_[i * steps / parts]);
  BoundedList<double, kMaxKnots> length_s;  // of each part, in s
  double whole_s = 0.0;
  for (int i = 0; i < parts; ++i) {
    const JointVector way_rad = points_rad[i + 1] - points_rad[i];
    length_s.add(std::max(kShortest_s, way_rad.cwiseAbs().cwiseQuotient(arm_.limits.velocity_radps).maxCoeff()));
    whole_s += length_s[i];
  }
  Guide guide;
  guide.foresight_status = ForesightStatus::kGuided;
  guide.add(0.0, points_rad[0]);
  double s = 0.0;
  for (int i = 1; i < parts; ++i) {
    s += length_s[i - 1];
    const double u = 0.5 - std::sin(std::asin(1.0 - 2.0 * s / whole_s) / 3.0);
    const JointVector slope = (points_rad[i + 1] - points_rad[i - 1]) / (length_s[i - 1] + length_s[i]);  // dq/ds
    guide.add(u, points_rad[i], 6.0 * u * (1.0 - u) * whole_s * slope);
  }
  guide.add(1.0, points_rad[parts]);
  const double duration_s = std::max(whole_s, least_duration_s(arm_.limits, share, guide));  // not 0 without a way
  for (int i = 0; i < guide.knots; ++i) {
    guide.time_s[i] = start_s + duration_s * guide.time_s[i];
    guide.velocity_radps[i] /= duration_s;
  }
  return guide;
}

}  // namespace sidestep
