#include "firmware/control/shield/shield_qp.h"

#include <algorithm>
#include <cmath>
#include <eiquadprog/eiquadprog-rt.hpp>

#include "firmware/control/shield/small_active_set.h"

namespace sidestep {
namespace {

constexpr int kMostIterations = 200;
constexpr int kMostRounds = 3;

/// min 1/2 x' hessian x + gradient' x  subject to  conditions x + offsets >= 0, for at most so many joints and rows:
/// most arms have 7 joints, most cycles few rows, and all of a problem's size is worked through. Unknowns: the joint
/// velocities, then a slack for each tier, scaled so that its weight is 1 and a unit of it relieves the rows by
/// relief().
template <int joint_capacity, int row_capacity>
struct Problem {
  static constexpr int kUnknowns = joint_capacity + kTiers;
  static constexpr int kSlacks = 2 * joint_capacity;
  static constexpr int kRows = kSlacks + kTiers;
  static constexpr int kConditions = kRows + row_capacity;

  using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
  using Hessian = Eigen::Matrix<double, kUnknowns, kUnknowns>;

  Hessian hessian = Hessian::Identity();
  Hessian inverse_root = Hessian::Identity();  ///< R with R R' = hessian^-1
  Unknowns gradient = Unknowns::Zero();
  Eigen::Matrix<double, kConditions, kUnknowns> conditions = Eigen::Matrix<double, kConditions, kUnknowns>::Zero();
  Eigen::Matrix<double, kConditions, 1> offsets = Eigen::Matrix<double, kConditions, 1>::Ones();

  Problem(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& near) {
    const int n = static_cast<int>(near.nominal_radps.size());
    if (near.tool_weight > 0.0) near.tool_jacobian.rows() == 6 ? weigh_tool<6>(near) : weigh_tool<3>(near);
    gradient.head(n) = -hessian.topLeftCorner(n, n).lazyProduct(near.nominal_radps);
    for (int i = 0; i < n; ++i) {
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
      conditions.row(kRows + i).head(n) = row.row.transpose();
      conditions(kRows + i, joint_capacity + static_cast<int>(row.tier)) = slack_scale(near, row.tier);
      offsets[kRows + i] = -row.bound;
    }
  }

  /// The slacks stand apart, so that only the joints' corner is not the identity: I + w J^T J. The root of its inverse
  /// is I - (L^-1 J)^T (L + N)^-1 J with N = I / sqrt(w) and L L^T = J J^T + N N (Andrews' square root of Kalman's
  /// update).
  template <int rows>
  void weigh_tool(const QpObjective& near) {
    using Tall = Eigen::Matrix<double, rows, joint_capacity>;
    using Square = Eigen::Matrix<double, rows, rows>;
    Tall jacobian = Tall::Zero();
    jacobian.leftCols(near.tool_jacobian.cols()) = near.tool_jacobian;
    const Square noise = Square::Identity() / std::sqrt(near.tool_weight);
    const Square gram = jacobian.lazyProduct(jacobian.transpose()) + noise * noise;
    const Square root = gram.llt().matrixL();
    const Square more = root + noise;
    const Tall a = root.inverse().lazyProduct(jacobian), b = more.inverse().lazyProduct(jacobian);
    hessian.template topLeftCorner<joint_capacity, joint_capacity>() +=
        near.tool_weight * jacobian.transpose().lazyProduct(jacobian);
    inverse_root.template topLeftCorner<joint_capacity, joint_capacity>() -= a.transpose().lazyProduct(b);
  }

  bool solve(Unknowns& x) const {
    eiquadprog::solvers::RtEiquadprog<kUnknowns, 0, kConditions> solver;
    solver.setMaxIter(kMostIterations);
    solver.m_J = inverse_root;
    solver.is_inverse_provided_ = true;
    // Given a root, this solver starts from + hessian^-1 gradient, so it is told the gradient with the other sign.
    const Unknowns start_gradient = -gradient;
    const auto status = solver.solve_quadprog(hessian, start_gradient, Eigen::Matrix<double, 0, kUnknowns>(),
                                              Eigen::Matrix<double, 0, 1>(), conditions, offsets, x);
    return status == eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL && x.allFinite();
  }

  /// The hard rows that had to be given up stay given up by just that much; the others may not hide behind them.
  void freeze_violated_hard_rows(const Unknowns& x, double hard_slack_mps) {
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
QpSolution solve_sized(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& near) {
  const Eigen::Index n = near.nominal_radps.size();
  QpSolution solution{near.nominal_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps)};
  Problem<joint_capacity, row_capacity> problem(rows, range, near);
  const double wish_cost = -0.5 * problem.gradient.head(n).dot(near.nominal_radps);
  for (int round = 0; round < kMostRounds; ++round) {
    typename Problem<joint_capacity, row_capacity>::Unknowns x;
    if (!problem.solve(x)) break;
    solution.velocity_radps = x.head(n).cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
    solution.cost = wish_cost + 0.5 * x.dot(problem.hessian * x) + problem.gradient.dot(x);
    const double hard_slack_mps = x[joint_capacity] * kHardSlackScale_mps;
    solution.hard_slack_mps = std::max(solution.hard_slack_mps, hard_slack_mps);
    if (hard_slack_mps < kNegligibleSlack_mps) break;
    problem.freeze_violated_hard_rows(x, hard_slack_mps);
  }
  return solution;
}

template <int joint_capacity>
QpSolution solve_for(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& near) {
  constexpr int kFewRows = 12, kSomeRows = 28;
  if (rows.size() <= kFewRows) return solve_sized<joint_capacity, kFewRows>(rows, range, near);
  if (rows.size() <= kSomeRows) return solve_sized<joint_capacity, kSomeRows>(rows, range, near);
  return solve_sized<joint_capacity, kMaxRows>(rows, range, near);
}

}  // namespace

QpSolution solve(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective) {
  if (const auto simple = solve_small_active_set(rows, range, objective)) return *simple;
  constexpr int kCommonJoints = 7;
  return objective.nominal_radps.size() <= kCommonJoints ? solve_for<kCommonJoints>(rows, range, objective)
                                                         : solve_for<kMaxJoints>(rows, range, objective);
}

}  // namespace sidestep
