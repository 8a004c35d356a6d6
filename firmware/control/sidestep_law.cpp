#include "firmware/control/sidestep_law.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/bounded_least_squares.h"
#include "firmware/model/damped_inverse.h"

namespace sidestep {
namespace {

// Tuned on the campaign's follow6d.
constexpr double kFullPosePosture = 4.0;
constexpr double kFullPoseDamping = 0.4;  // of the weighted task, whose singular values are smaller
constexpr double kLeastDamping = 5e-4;    // where joints are at their bounds: the others may be too few for the task
constexpr double kTurnAtBounds = 0.5;     // there a turn weighs so much less than kTurnWeight_m

/// v scaled down to a largest norm.
Vector3 clipped(const Vector3& v, double largest) {
  const double norm = v.norm();
  return norm > largest ? Vector3(v * (largest / norm)) : v;
}

bool is_within(const JointVector& velocity_radps, const VelocityRange& range) {
  return (velocity_radps.array() >= range.lower_radps.array()).all() &&
         (velocity_radps.array() <= range.upper_radps.array()).all();
}

/// The preference: S (J S)* (x - J p) + p is p in the null space and x in the task. S = diag(joint_scale). Where that
/// takes a joint of a full pose beyond its range, the least squares solution within the range replaces it.
template <int rows>
void follow(const SidestepGains& gains, const LawInput& input, const TaskVector& x, const JointVector& preferred_radps,
            NominalCommand& nominal) {
  const JointVector& joint_scale = input.arm.joint_scale;
  using Jacobian = typename DampedInverse<rows>::Jacobian;
  const Jacobian jacobian = input.tool_jacobian;
  Jacobian scaled = weighted_task(jacobian);
  for (Eigen::Index i = 0; i < scaled.cols(); ++i) scaled.col(i) *= joint_scale[i];
  constexpr double kDamping = rows == 6 ? kFullPoseDamping : 1.0;
  const DampedInverse<rows> inverse(kDamping * gains.lambda_0, kDamping * gains.sigma_0, scaled);
  nominal.damping = inverse.lambda();
  Eigen::Matrix<double, rows, 1> rest = x - jacobian.lazyProduct(preferred_radps);
  if constexpr (rows == 6) rest.template tail<3>() *= kTurnWeight_m;
  nominal.velocity_radps = preferred_radps + joint_scale.cwiseProduct(inverse * rest);
  if constexpr (rows == 6) {
    const VelocityRange& range = input.sustainable;
    if (is_within(nominal.velocity_radps, range)) return;
    scaled.template bottomRows<3>() *= kTurnAtBounds;
    rest.template tail<3>() *= kTurnAtBounds;
    const JointVector within = bounded_least_squares(scaled, rest, std::max(nominal.damping, kLeastDamping),
                                                     (range.lower_radps - preferred_radps).cwiseQuotient(joint_scale),
                                                     (range.upper_radps - preferred_radps).cwiseQuotient(joint_scale));
    nominal.velocity_radps = preferred_radps + joint_scale.cwiseProduct(within);
  }
}

}  // namespace

JointVector away_from_limits(const SidestepGains& gains, const LawInput& input) {
  const JointVector& q_rad = input.position_rad;
  const JointLimits& limits = input.arm.limits;
  const bool is_full_pose = input.tool_jacobian.rows() == 6;
  const double gain_radps = gains.k_posture_per_s * (is_full_pose ? kFullPosePosture : 1.0);
  JointVector away_radps(q_rad.size());
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double middle = 0.5 * (limits.lower_rad[i] + limits.upper_rad[i]);
    const double half = 0.5 * (limits.upper_rad[i] - limits.lower_rad[i]);
    const double share = std::isfinite(half) ? (q_rad[i] - middle) / half : 0.0;
    const double power = is_full_pose ? std::abs(share) : share * share;  // then joints return earlier
    away_radps[i] = -gain_radps * input.arm.joint_scale[i] * power * share;
  }
  return away_radps;
}

NominalCommand sidestep_law(const SidestepGains& gains, const LawInput& input, const JointVector& preferred_radps) {
  const Target& target = input.target;
  const Eigen::Index rows = input.tool_jacobian.rows();
  const Vector3 error_m = target.position_m - input.poses.tool_position;

  NominalCommand nominal;
  nominal.tool_velocity_mps = target.velocity_mps + clipped(gains.k_pos_per_s * error_m, gains.v_max_mps);
  nominal.task_speed_limited = gains.k_pos_per_s * error_m.norm() > gains.v_max_mps;
  TaskVector x(rows);
  x.head<3>() = nominal.tool_velocity_mps;
  if (rows == 6) {
    const Eigen::AngleAxisd to_goal = orientation_error(target.orientation, input.poses.tool_rotation);
    x.tail<3>() = target.angular_velocity_radps + gains.k_ori_per_s * to_goal.angle() * to_goal.axis();
  }

  if (rows == 6)
    follow<6>(gains, input, x, preferred_radps, nominal);
  else
    follow<3>(gains, input, x, preferred_radps, nominal);
  return nominal;
}

}  // namespace sidestep
