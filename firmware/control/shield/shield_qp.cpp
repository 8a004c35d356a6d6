#include "firmware/control/shield/shield_qp.h"

#include <algorithm>
#include <cmath>
#include <eiquadprog/eiquadprog-rt.hpp>

#include "firmware/control/shield/small_active_set.h"
#include "firmware/model/square_matrix.h"

namespace sidestep {
namespace {

constexpr int kMaxIterations = 200;
constexpr int kMaxRounds = 3;

// The solver fails in one of 60,000 random programmes if the rows of links weigh 64, and in 21 if they weigh 512: the
// largest coefficients of a row are then a million times that of the hard slack. With a larger one it solves them all.
constexpr double kRelaxation = 4.0;
constexpr double kLargestHardSlackScale_mps = kRelaxation * kRelaxation * kHardSlackScale_mps;

/// The unknowns x are the joint velocities, then one scaled slack s_t / sigma_t per tier, so that its weight in H is 1
/// and its coefficient in a row is sigma_t.
template <int joint_capacity>
using Unknowns = Eigen::Matrix<double, joint_capacity + kTiers, 1>;

/// The objective in the solver's form: 1/2 x^T H x + g^T x.
template <int joint_capacity>
struct Objective {
  using Hessian = SquareMatrix<joint_capacity + kTiers>;

  Hessian hessian = Hessian::Identity();
  Hessian inverse_root = Hessian::Identity();  ///< R with R R' = hessian^-1
  Unknowns<joint_capacity> gradient = Unknowns<joint_capacity>::Zero();
  double constant;

  explicit Objective(const QpObjective& objective) {
    const Eigen::Index n = objective.nominal_radps.size();
    if (objective.tool_weight > 0.0)
      objective.tool_jacobian.rows() == 6 ? add_tool_cost<6>(objective) : add_tool_cost<3>(objective);
    gradient.head(n) = -hessian.topLeftCorner(n, n).lazyProduct(objective.nominal_radps);
    constant = -0.5 * gradient.head(n).dot(objective.nominal_radps);
  }

  double cost(const Unknowns<joint_capacity>& x) const { return constant + 0.5 * x.dot(hessian * x) + gradient.dot(x); }

 private:
  /// The tool's cost makes the joints' block of the Hessian I + w J^T J; the slacks' block remains the identity. A root
  /// R of the inverse, R R^T = (I + w J^T J)^-1, is I - (L^-1 J)^T (L + N)^-1 J with N = I / sqrt(w) and L L^T = J J^T
  /// + N N (Andrews' square-root form of the Kalman update).
  template <int rows>
  void add_tool_cost(const QpObjective& objective) {
    using Tall = Eigen::Matrix<double, rows, joint_capacity>;
    using Square = SquareMatrix<rows>;
    Tall jacobian = Tall::Zero();
    jacobian.leftCols(objective.tool_jacobian.cols()) = objective.tool_jacobian;
    const Square n = Square::Identity() / std::sqrt(objective.tool_weight);
    const Square gram = jacobian.lazyProduct(jacobian.transpose()) + n * n;
    const Square root = cholesky_root(gram);
    const Square sum = root + n;
    const Tall a = inverse(root).lazyProduct(jacobian), b = inverse(sum).lazyProduct(jacobian);
    hessian.template topLeftCorner<joint_capacity, joint_capacity>() +=
        objective.tool_weight * jacobian.transpose().lazyProduct(jacobian);
    inverse_root.template topLeftCorner<joint_capacity, joint_capacity>() -= a.transpose().lazyProduct(b);
  }
};

/// The constraints in the solver's form, C x + c >= 0, and the solver. Its cost grows with the capacity, not with the
/// number of rows; hence several sizes for the usual number of joints. So does its tolerance: another size changes some
/// results in the last bits. Unused rows read 0 x + 1 >= 0.
template <int joint_capacity, int row_capacity>
struct Constraints {
  static constexpr int kUnknowns = joint_capacity + kTiers;
  static constexpr int kSlacks = 2 * joint_capacity;
  static constexpr int kRows = kSlacks + kTiers;
  static constexpr int kConditions = kRows + row_capacity;

  Eigen::Matrix<double, kConditions, kUnknowns> conditions = Eigen::Matrix<double, kConditions, kUnknowns>::Zero();
  Eigen::Matrix<double, kConditions, 1> offsets = Eigen::Matrix<double, kConditions, 1>::Ones();
  double hard_slack_scale_mps = kHardSlackScale_mps;  ///< a shortfall of this costs as much as 1 rad/s

  Constraints(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective) {
    const Eigen::Index n = objective.nominal_radps.size();
    for (Eigen::Index i = 0; i < n; ++i) {
      conditions(2 * i, i) = 1.0;
      offsets[2 * i] = -range.lower_radps[i];
      conditions(2 * i + 1, i) = -1.0;
      offsets[2 * i + 1] = range.upper_radps[i];
    }
    for (int tier = 0; tier < kTiers; ++tier) {
      conditions(kSlacks + tier, joint_capacity + tier) = 1.0;
      offsets[kSlacks + tier] = 0.0;
    }
    for (int i = 0; i < rows.size(); ++i) {
      const ConstraintRow& row = rows[i];
      for (Eigen::Index j = 0; j < n; ++j) conditions(kRows + i, j) = row.row[j];
      conditions(kRows + i, joint_capacity + static_cast<int>(row.tier)) = slack_scale_mps(objective, row.tier);
      offsets[kRows + i] = -row.bound;
    }
  }

  /// Where the solver fails, with a hard slack that costs less.
  bool solve(const Objective<joint_capacity>& objective, Unknowns<joint_capacity>& x) {
    while (!solve_once(objective, x)) {
      if (hard_slack_scale_mps >= kLargestHardSlackScale_mps) return false;
      for (int c = kRows; c < kConditions; ++c) conditions(c, joint_capacity) *= kRelaxation;
      hard_slack_scale_mps *= kRelaxation;
    }
    return true;
  }

  bool solve_once(const Objective<joint_capacity>& objective, Unknowns<joint_capacity>& x) const {
    eiquadprog::solvers::RtEiquadprog<kUnknowns, 0, kConditions> solver;
    solver.setMaxIter(kMaxIterations);
    solver.m_J = objective.inverse_root;
    solver.is_inverse_provided_ = true;
    // eiquadprog 1.3.2 starts from +H^-1 g instead of -H^-1 g when the inverse root is provided (the branch lacks
    // x = -x), so it is given -g.
    const Unknowns<joint_capacity> start_gradient = -objective.gradient;
    const auto status = solver.solve_quadprog(objective.hessian, start_gradient, Eigen::Matrix<double, 0, kUnknowns>(),
                                              Eigen::Matrix<double, 0, 1>(), conditions, offsets, x);
    return status == eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL && x.allFinite();
  }

  /// Replaces the shared slack of the violated hard rows by the constant that they need, so that the slack no longer
  /// relaxes the other hard rows.
  void freeze_violated_hard_rows(const Unknowns<joint_capacity>& x, double hard_slack_mps) {
    for (int c = kRows; c < kConditions; ++c) {
      double& coefficient = conditions(c, joint_capacity);
      const double rounding = 1e-6;
      if (coefficient == 0.0 || conditions.row(c).dot(x) + offsets[c] > rounding) continue;
      coefficient = 0.0;
      offsets[c] += hard_slack_mps + rounding;
    }
  }
};

template <int joint_capacity, int row_capacity>
QpSolution solve_sized(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective) {
  const Eigen::Index n = objective.nominal_radps.size();
  const JointVector rest_radps = 0.0 * objective.nominal_radps;  // remains not finite where the nominal velocity is not
  QpSolution solution{rest_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps)};
  solution.failed = true;
  const Objective<joint_capacity> cost(objective);
  Constraints<joint_capacity, row_capacity> constraints(rows, range, objective);
  for (int round = 0; round < kMaxRounds; ++round) {
    Unknowns<joint_capacity> x;
    if (!constraints.solve(cost, x)) break;
    solution.failed = false;
    solution.velocity_radps = x.head(n).cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
    solution.cost = cost.cost(x);
    const double hard_slack_mps = x[joint_capacity] * constraints.hard_slack_scale_mps;
    solution.hard_slack_mps = std::max(solution.hard_slack_mps, hard_slack_mps);
    if (hard_slack_mps < kNegligibleSlack_mps) break;
    constraints.freeze_violated_hard_rows(x, hard_slack_mps);
  }
  return solution;
}

/// The programme with the unknowns S^-1 q', in which the joints' weights are equal. S consists of powers of two, so
/// that nothing is rounded.
QpSolution solve_scaled(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective) {
  const JointVector& scale = *objective.scale;
  ConstraintRows scaled_rows = rows;
  for (ConstraintRow& row : scaled_rows) row.row = row.row.cwiseProduct(scale);
  TaskJacobian jacobian = objective.tool_jacobian;
  for (Eigen::Index i = 0; i < jacobian.cols(); ++i) jacobian.col(i) *= scale[i];
  const JointVector nominal = objective.nominal_radps.cwiseQuotient(scale);
  QpSolution solution =
      solve(scaled_rows, {range.lower_radps.cwiseQuotient(scale), range.upper_radps.cwiseQuotient(scale)},
            {nominal, jacobian, objective.tool_weight, objective.comfort_weight});
  solution.velocity_radps = solution.velocity_radps.cwiseProduct(scale);
  return solution;
}

}  // namespace

QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective) {
  if (objective.scale) return solve_scaled(rows, range, objective);
  if (const auto exact = solve_small_active_set(rows, range, objective)) return *exact;
  constexpr int kCommonJoints = 7, kSmall = 12, kMedium = 28;
  if (objective.nominal_radps.size() > kCommonJoints) return solve_sized<kMaxJoints, kMaxRows>(rows, range, objective);
  if (rows.size() <= kSmall) return solve_sized<kCommonJoints, kSmall>(rows, range, objective);
  if (rows.size() <= kMedium) return solve_sized<kCommonJoints, kMedium>(rows, range, objective);
  return solve_sized<kCommonJoints, kMaxRows>(rows, range, objective);
}

}  // namespace sidestep
