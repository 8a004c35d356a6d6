#include "firmware/control/sidestep_law.h"

#include <cmath>

#include "firmware/control/damped_inverse.h"

namespace sidestep {
namespace {

/// v scaled down to a largest norm.
Vector3 clipped(const Vector3& v, double largest) {
  const double norm = v.norm();
  return norm > largest ? Vector3(v * (largest / norm)) : v;
}

}  // namespace

Wish sidestep_law(const SidestepGains& gains, const Situation& now) {
  const Target& target = now.target;
  const int rows = target.tracks_orientation ? 6 : 3;
  const TaskJacobian jacobian = tool_jacobian(now.posture, rows);
  const Vector3 error_m = target.position_m - now.posture.tool_position;

  Wish wish;
  wish.tool_velocity_mps = target.velocity_mps + clipped(gains.k_pos_per_s * error_m, gains.v_max_mps);
  wish.task_speed_limited = gains.k_pos_per_s * error_m.norm() > gains.v_max_mps;
  TaskVector x(rows);
  x.head<3>() = wish.tool_velocity_mps;
  if (rows == 6) {
    const Eigen::AngleAxisd to_goal(target.orientation.toRotationMatrix() * now.posture.tool_rotation.transpose());
    x.tail<3>() = target.angular_velocity_radps + gains.k_ori_per_s * to_goal.angle() * to_goal.axis();
  }

  // Damped as in paper eqs (5) and (6).
  const auto gram = (jacobian * jacobian.transpose()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>> eigen(gram);
  const double sigma_m = std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
  const double lambda2 = damping_squared(gains.lambda_0, gains.sigma_0, sigma_m);
  wish.damping = std::sqrt(lambda2);
  const TaskVector scaled =
      (eigen.eigenvectors().transpose() * x).cwiseQuotient((eigen.eigenvalues().array() + lambda2).max(1e-12).matrix());
  wish.velocity_radps = jacobian.transpose() * (eigen.eigenvectors() * scaled);
  return wish;
}

}  // namespace sidestep
