#pragma once

#include <algorithm>
#include <cmath>

#include "firmware/model/square_matrix.h"
#include "firmware/model/types.h"

namespace sidestep {

/// Damped least squares: J* = J^T (J J^T + lambda^2 I)^-1, paper eq (5), in the two forms that the laws use. Their
/// decompositions differ, and so do their results in the last bits. (The paper's law also needs an exact null space
/// projector, which takes a singular value decomposition: control/paper/damped_inverse.h.)

/// lambda^2 of paper eq (6) for the smallest singular value sigma_m of the task Jacobian: 0 from sigma_0 on, rising to
/// lambda_0^2 at a singular configuration.
inline double damping_squared(double lambda_0, double sigma_0, double sigma_m) {
  if (sigma_m >= sigma_0) return 0.0;
  const double share = 1.0 - sigma_m / sigma_0;
  return lambda_0 * lambda_0 * share * share;
}

/// J* b of an m x n matrix J with a given damping lambda, by an LDL^T decomposition. b is m x 1, m at most 6.
template <typename Jacobian>
JointVector damped_solve(
    const Jacobian& jacobian, double lambda,
    const Eigen::Matrix<double, Jacobian::RowsAtCompileTime, 1, 0, Jacobian::MaxRowsAtCompileTime, 1>& b) {
  constexpr int kRows = Jacobian::RowsAtCompileTime, kRowLimit = Jacobian::MaxRowsAtCompileTime;
  Eigen::Matrix<double, kRows, kRows, 0, kRowLimit, kRowLimit> gram = jacobian.lazyProduct(jacobian.transpose());
  gram.diagonal().array() += lambda * lambda;
  return jacobian.transpose() * solve_ldlt(gram, b);
}

/// J* of a task Jacobian with `rows` rows, with the damping of paper eq (6), by an explicit inverse. A singular value
/// decomposition is avoided: the smallest singular value is computed only if it may be below sigma_0.
template <int rows>
class DampedInverse {
 public:
  using Jacobian = Eigen::Matrix<double, rows, Eigen::Dynamic, 0, rows, kMaxJoints>;
  using Task = Eigen::Matrix<double, rows, 1>;

  DampedInverse(double lambda_0, double sigma_0, const Jacobian& jacobian) : jacobian_(jacobian) {
    Gram gram = jacobian.lazyProduct(jacobian.transpose());
    const double lambda2 = needs_damping(sigma_0, gram) ? damping2(lambda_0, sigma_0, gram) : 0.0;
    lambda_ = std::sqrt(lambda2);
    gram.diagonal().array() += lambda2;
    inverse_ = inverse(gram);
  }

  double lambda() const { return lambda_; }
  JointVector operator*(const Task& x) const { return jacobian_.transpose().lazyProduct(inverse_ * x); }

 private:
  using Gram = SquareMatrix<rows>;

  /// False if all eigenvalues of J J^T exceed sigma_0^2: J J^T - sigma_0^2 I then has a Cholesky decomposition.
  static bool needs_damping(double sigma_0, const Gram& gram) {
    return !is_positive_definite<rows>(gram - sigma_0 * sigma_0 * Gram::Identity());
  }

  static double damping2(double lambda_0, double sigma_0, const Gram& gram) {
    const double sigma2 = std::max(0.0, least_eigenvalue(gram)), smallest = 1e-12;
    // Gains that damp nothing would leave a singular matrix.
    return std::max(damping_squared(lambda_0, sigma_0, std::sqrt(sigma2)), smallest - sigma2);
  }

  const Jacobian jacobian_;
  Gram inverse_;
  double lambda_;
};

}  // namespace sidestep
