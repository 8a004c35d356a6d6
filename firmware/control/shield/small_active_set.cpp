#include "firmware/control/shield/small_active_set.h"

#include <algorithm>

#include "firmware/model/square_matrix.h"

namespace sidestep {
namespace {

bool leaves(const VelocityRange& range, const JointVector& velocity_radps) {
  return (velocity_radps.array() < range.lower_radps.array()).any() ||
         (velocity_radps.array() > range.upper_radps.array()).any();
}

/// (J J^T + I/w)^-1 J: the factor of the Woodbury identity, so that H^-1 = I - J^T * factor.
template <int rows>
TaskJacobian woodbury_factor(const QpObjective& objective) {
  const Eigen::Matrix<double, rows, Eigen::Dynamic, 0, rows, kMaxJoints> jacobian = objective.tool_jacobian;
  SquareMatrix<rows> gram = jacobian.lazyProduct(jacobian.transpose());
  gram.diagonal().array() += 1.0 / objective.tool_weight;
  return inverse(gram).lazyProduct(jacobian);
}

/// Active-set method: activates the most violated row until none is violated. A row whose multiplier turns negative is
/// removed; with non-negative multipliers and no violated row the KKT conditions hold.
class SmallActiveSet {
 public:
  SmallActiveSet(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& objective)
      : rows_(rows), range_(range), objective_(objective), velocity_radps_(objective.nominal_radps) {
    if (objective.tool_weight > 0.0) return;
    // H = I: the bounds of the joints are independent of each other, so clipping is exact.
    velocity_radps_ = velocity_radps_.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
    cost_ = 0.5 * (velocity_radps_ - objective.nominal_radps).squaredNorm();
  }

  std::optional<QpSolution> solve() {
    if (leaves(range_, velocity_radps_)) return {};
    const ConstraintRow* violated = most_violated();
    if (!violated) return QpSolution{velocity_radps_, cost_};
    if (objective_.tool_weight > 0.0)
      woodbury_ =
          objective_.tool_jacobian.rows() == 6 ? woodbury_factor<6>(objective_) : woodbury_factor<3>(objective_);
    for (int changes = 0; violated; ++changes, violated = most_violated())
      if (changes == kMaxChanges || !activate(*violated)) return {};
    const double hard_slack_mps = slack_mps_[static_cast<int>(Tier::kHard)];
    if (leaves(range_, velocity_radps_) || hard_slack_mps > kNegligibleSlack_mps) return {};
    return QpSolution{velocity_radps_, cost_, hard_slack_mps};
  }

 private:
  static constexpr int kMaxActive = 3;   // the size of Matrix3 and Vector3
  static constexpr int kMaxChanges = 6;  // twice the capacity: rows may be removed again

  struct ActiveRow {
    const ConstraintRow* row;
    JointVector inverse_hessian_row;  ///< H^-1 a^T
  };

  const ConstraintRow* most_violated() const {
    const ConstraintRow* worst = nullptr;
    double most_mps = 1e-12;  // rounding
    for (const ConstraintRow& row : rows_) {
      const double violation_mps = row.bound - row.row.dot(velocity_radps_) - slack_mps_[static_cast<int>(row.tier)];
      if (!(violation_mps > most_mps)) continue;  // NaN is no violation: the cycle finds it in the result
      most_mps = violation_mps;
      worst = &row;
    }
    return worst;
  }

  /// Adds a row to the active set. Returns false where no non-negative multipliers exist, or the set is full.
  bool activate(const ConstraintRow& row) {
    const auto is_row = [&](const ActiveRow& active) { return active.row == &row; };
    if (active_.is_full() || std::any_of(active_.begin(), active_.end(), is_row)) return false;
    active_.add({&row, times_inverse_hessian(row.row)});
    int least = solve_kkt();
    if (lambda_[least] <= 0.0 && active_[least].row != &row) {
      active_.remove(least);
      least = solve_kkt();
    }
    return lambda_[least] > 0.0;
  }

  /// Solves the KKT system with the active rows as equalities, for the multipliers, the velocity, the slacks and the
  /// cost. Returns the index of the least multiplier.
  int solve_kkt() {
    Matrix3 gram = Matrix3::Identity();
    Vector3 violation_mps = Vector3::Zero();
    for (int i = 0; i < active_.size(); ++i) {
      const ConstraintRow& row = *active_[i].row;
      violation_mps[i] = row.bound - row.row.dot(objective_.nominal_radps);
      for (int j = 0; j <= i; ++j) {
        const double sigma_mps = active_[j].row->tier == row.tier ? slack_scale_mps(objective_, row.tier) : 0.0;
        gram(i, j) = gram(j, i) = row.row.dot(active_[j].inverse_hessian_row) + sigma_mps * sigma_mps;
      }
    }
    lambda_ = solve_llt(gram, violation_mps);
    cost_ = 0.5 * lambda_.dot(violation_mps);
    velocity_radps_ = objective_.nominal_radps;
    slack_mps_ = {};
    int least = 0;
    for (int i = 0; i < active_.size(); ++i) {
      const Tier tier = active_[i].row->tier;
      const double sigma_mps = slack_scale_mps(objective_, tier);
      velocity_radps_ += lambda_[i] * active_[i].inverse_hessian_row;
      slack_mps_[static_cast<int>(tier)] += lambda_[i] * sigma_mps * sigma_mps;
      if (lambda_[i] < lambda_[least]) least = i;
    }
    return least;
  }

  JointVector times_inverse_hessian(const JointVector& row) const {
    if (woodbury_.size() == 0) return row;
    return row - objective_.tool_jacobian.transpose().lazyProduct(woodbury_.lazyProduct(row).eval());
  }

  const ConstraintRows& rows_;
  const VelocityRange& range_;
  const QpObjective& objective_;
  TaskJacobian woodbury_;  ///< of size 0 without the tool's cost
  BoundedList<ActiveRow, kMaxActive> active_;
  Vector3 lambda_;  ///< multipliers
  JointVector velocity_radps_;
  std::array<double, kTiers> slack_mps_{};
  double cost_ = 0.0;
};

}  // namespace

std::optional<QpSolution> solve_small_active_set(const ConstraintRows& rows, const VelocityRange& range,
                                                 const QpObjective& objective) {
  return SmallActiveSet(rows, range, objective).solve();
}

}  // namespace sidestep
