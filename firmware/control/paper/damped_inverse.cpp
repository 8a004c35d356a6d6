#include "firmware/control/paper/damped_inverse.h"

namespace sidestep {

namespace {
// Singular values below this share of the largest count as zero in the exact inverse.
constexpr double kRankTolerance = 1e-6;
}  // namespace

TaskInverse invert(const PaperGains& gains, const TaskJacobian& jacobian) {
  const Eigen::JacobiSVD<TaskJacobian> svd(jacobian, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& sigma = svd.singularValues();
  const double lambda2 = damping_squared(gains.lambda_0, gains.sigma_0, sigma[sigma.size() - 1]);

  TaskInverse inverse;
  inverse.lambda = std::sqrt(lambda2);
  inverse.damped_transposed = TaskJacobian::Zero(jacobian.rows(), jacobian.cols());
  inverse.null_space = JointMatrix::Identity(jacobian.cols(), jacobian.cols());
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    const double s = sigma[i];
    if (s <= 0.0) continue;
    const JointVector v = svd.matrixV().col(i);
    inverse.damped_transposed += (s / (s * s + lambda2)) * svd.matrixU().col(i) * v.transpose();
    if (s > kRankTolerance * sigma[0]) inverse.null_space -= v * v.transpose();
  }
  return inverse;
}

}  // namespace sidestep
