#include "firmware/control/shield/small_active_set.h"

#include <algorithm>

namespace sidestep {
namespace {

bool leaves(const VelocityRange& range, const JointVector& velocity_radps) {
  return (velocity_radps.array() < range.lower_radps.array()).any() ||
         (velocity_radps.array() > range.upper_radps.array()).any();
}

/// (J J^T + 1 / w)^-1 J; J^T of it is what is missing to I in the inverse of the nearness's Hessian, I + w J^T J.
template <int rows>
TaskJacobian tool_share(const QpObjective& near) {
  const Eigen::Matrix<double, rows, Eigen::Dynamic, 0, rows, kMaxJoints> jacobian = near.tool_jacobian;
  Eigen::Matrix<double, rows, rows> gram = jacobian.lazyProduct(jacobian.transpose());
  gram.diagonal().array() += 1.0 / near.tool_weight;
  return gram.inverse().lazyProduct(jacobian);
}

/// The wish moved just as far as a few rows ask that it does not meet. They are found by adding the one that lacks
/// most, until none does; one that no longer holds the wish back goes. When each of them does, there is nothing nearer.
class SmallActiveSet {
 public:
  SmallActiveSet(const ConstraintRows& rows, const VelocityRange& range, const QpObjective& near)
      : rows_(rows), range_(range), near_(near), velocity_radps_(near.nominal_radps) {
    if (near.tool_weight > 0.0) return;
    // Where the tool does not count, no joint speaks for another.
    velocity_radps_ = velocity_radps_.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
    cost_ = 0.5 * (velocity_radps_ - near.nominal_radps).squaredNorm();
  }

  std::optional<QpSolution> solve() {
    if (leaves(range_, velocity_radps_)) return {};
    const ConstraintRow* worst = most_lacking();
    if (!worst) return QpSolution{velocity_radps_, cost_};
    if (near_.tool_weight > 0.0) share_ = near_.tool_jacobian.rows() == 6 ? tool_share<6>(near_) : tool_share<3>(near_);
    for (int tries = 0; worst; ++tries, worst = most_lacking())
      if (tries == kMostTries || !also_meet(*worst)) return {};
    const double hard_slack_mps = slack_mps_[static_cast<int>(Tier::kHard)];
    if (leaves(range_, velocity_radps_) || hard_slack_mps > kNegligibleSlack_mps) return {};
    return QpSolution{velocity_radps_, cost_, hard_slack_mps};
  }

 private:
  static constexpr int kFew = 3;
  static constexpr int kMostTries = 6;  // rows come and go
  using Few = Eigen::Matrix<double, kFew, 1>;

  /// A row that is met just so, and the inverse of the Hessian times it.
  struct Met {
    const ConstraintRow* row;
    JointVector along;
  };

  const ConstraintRow* most_lacking() const {
    const ConstraintRow* worst = nullptr;
    double most_mps = 1e-12;  // rounding
    for (const ConstraintRow& row : rows_) {
      const double lack_mps = row.bound - row.row.dot(velocity_radps_) - slack_mps_[static_cast<int>(row.tier)];
      if (!(lack_mps > most_mps)) continue;  // a wish that is no number goes on as it is, to be found at the end
      most_mps = lack_mps;
      worst = &row;
    }
    return worst;
  }

  /// Whether there is a velocity that this row, too, holds back from the wish.
  bool also_meet(const ConstraintRow& row) {
    const auto is_row = [&](const Met& met) { return met.row == &row; };
    if (met_.is_full() || std::any_of(met_.begin(), met_.end(), is_row)) return false;
    met_.add({&row, eased(row.row)});
    int weakest = pull();
    if (pull_[weakest] <= 0.0 && met_[weakest].row != &row) {
      met_.remove(weakest);
      weakest = pull();
    }
    return pull_[weakest] > 0.0;
  }

  /// How hard each of the rows has to pull so that all are met just so, and where to. Says which pulls least.
  int pull() {
    Eigen::Matrix<double, kFew, kFew> gram = Eigen::Matrix<double, kFew, kFew>::Identity();
    Few lack_mps = Few::Zero();
    for (int i = 0; i < met_.size(); ++i) {
      const ConstraintRow& row = *met_[i].row;
      lack_mps[i] = row.bound - row.row.dot(near_.nominal_radps);
      for (int j = 0; j <= i; ++j) {
        const double give = met_[j].row->tier == row.tier ? slack_scale(near_, row.tier) : 0.0;
        gram(i, j) = gram(j, i) = row.row.dot(met_[j].along) + give * give;
      }
    }
    pull_ = gram.llt().solve(lack_mps);
    cost_ = 0.5 * pull_.dot(lack_mps);
    velocity_radps_ = near_.nominal_radps;
    slack_mps_ = {};
    int weakest = 0;
    for (int i = 0; i < met_.size(); ++i) {
      const Tier tier = met_[i].row->tier;
      velocity_radps_ += pull_[i] * met_[i].along;
      slack_mps_[static_cast<int>(tier)] += pull_[i] * slack_scale(near_, tier) * slack_scale(near_, tier);
      if (pull_[i] < pull_[weakest]) weakest = i;
    }
    return weakest;
  }

  JointVector eased(const JointVector& row) const {
    if (share_.size() == 0) return row;
    return row - near_.tool_jacobian.transpose().lazyProduct(share_.lazyProduct(row).eval());
  }

  const ConstraintRows& rows_;
  const VelocityRange& range_;
  const QpObjective& near_;
  TaskJacobian share_;  ///< of size 0 where the tool does not count
  BoundedList<Met, kFew> met_;
  Few pull_;
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
