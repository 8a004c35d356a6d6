#include "firmware/control/sidestep_law.h"

#include <cmath>

#include "firmware/control/paper/damped_inverse.h"

namespace sidestep {
namespace {

/// v scaled down to a largest norm.
Vector3 clipped(const Vector3& v, double largest) {
  const double norm = v.norm();
  return norm > largest ? Vector3(v * (largest / norm)) : v;
}

/// J* of paper eqs (5) and (6): J^T (J J^T + lambda^2)^-1.
template <int rows>
class DampedInverse {
 public:
  using Jacobian = Eigen::Matrix<double, rows, Eigen::Dynamic, 0, rows, kMaxJoints>;
  using Task = Eigen::Matrix<double, rows, 1>;

  DampedInverse(const SidestepGains& gains, const Jacobian& jacobian) : jacobian_(jacobian) {
    Gram gram = jacobian.lazyProduct(jacobian.transpose());
    const double lambda2 = needs_damping(gains, gram) ? damping2(gains, gram) : 0.0;
    lambda_ = std::sqrt(lambda2);
    gram.diagonal().array() += lambda2;
    inverse_ = gram.inverse();
  }

  double lambda() const { return lambda_; }
  JointVector operator*(const Task& x) const { return jacobian_.transpose().lazyProduct(inverse_ * x); }

 private:
  using Gram = Eigen::Matrix<double, rows, rows>;

  /// Unless all eigenvalues are larger than sigma_0^2, so that there is a Cholesky decomposition when that is taken
  /// off.
  static bool needs_damping(const SidestepGains& gains, const Gram& gram) {
    const Gram beyond = gram - gains.sigma_0 * gains.sigma_0 * Gram::Identity();
    return Eigen::LLT<Gram>(beyond).info() != Eigen::Success;
  }

  static double damping2(const SidestepGains& gains, const Gram& gram) {
    const Eigen::SelfAdjointEigenSolver<Gram> eigen(gram, Eigen::EigenvaluesOnly);
    const double sigma2 = std::max(0.0, eigen.eigenvalues()[0]), smallest = 1e-12;
    // Only with gains that damp nothing could it be less.
    return std::max(damping_squared(gains.lambda_0, gains.sigma_0, std::sqrt(sigma2)), smallest - sigma2);
  }

  const Jacobian jacobian_;
  Gram inverse_;
  double lambda_;
};

/// The preference: J* (x - J p) + p is p in the null space and x in the task.
template <int rows>
void follow(const SidestepGains& gains, const TaskJacobian& jacobian, const TaskVector& x,
            const JointVector& preferred_radps, NominalCommand& nominal) {
  const DampedInverse<rows> inverse(gains, jacobian);
  nominal.damping = inverse.lambda();
  nominal.velocity_radps = preferred_radps + inverse * (x - jacobian.lazyProduct(preferred_radps));
}

}  // namespace

JointVector away_from_limits(const SidestepGains& gains, const JointLimits& limits, const JointVector& q_rad) {
  JointVector away_radps(q_rad.size());
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double middle = 0.5 * (limits.lower_rad[i] + limits.upper_rad[i]);
    const double half = 0.5 * (limits.upper_rad[i] - limits.lower_rad[i]);
    const double share = std::isfinite(half) ? (q_rad[i] - middle) / half : 0.0;
    away_radps[i] = -gains.k_posture_per_s * share * share * share;
  }
  return away_radps;
}

NominalCommand sidestep_law(const SidestepGains& gains, const LawInput& input, const JointVector& preferred_radps) {
  const Target& target = input.target;
  const TaskJacobian& jacobian = input.tool_jacobian;
  const Eigen::Index rows = jacobian.rows();
  const Vector3 error_m = target.position_m - input.poses.tool_position;

  NominalCommand nominal;
  nominal.tool_velocity_mps = target.velocity_mps + clipped(gains.k_pos_per_s * error_m, gains.v_max_mps);
  nominal.task_speed_limited = gains.k_pos_per_s * error_m.norm() > gains.v_max_mps;
  TaskVector x(rows);
  x.head<3>() = nominal.tool_velocity_mps;
  if (rows == 6) {
    const Eigen::AngleAxisd to_goal(target.orientation.toRotationMatrix() * input.poses.tool_rotation.transpose());
    x.tail<3>() = target.angular_velocity_radps + gains.k_ori_per_s * to_goal.angle() * to_goal.axis();
  }

  if (rows == 6)
    follow<6>(gains, jacobian, x, preferred_radps, nominal);
  else
    follow<3>(gains, jacobian, x, preferred_radps, nominal);
  return nominal;
}

}  // namespace sidestep
