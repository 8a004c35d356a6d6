#include "firmware/model/bounded_least_squares.h"

#include <algorithm>
#include <array>

#include "firmware/model/damped_inverse.h"

namespace sidestep {
namespace {

constexpr double kLeastSlope = 1e-9;  // of the cost along an unknown that is worth its release

class ActiveSet {
 public:
  ActiveSet(const TaskJacobian& a, const TaskVector& b, double lambda, const JointVector& lower,
            const JointVector& upper)
      : a_(a),
        b_(b),
        lambda_(lambda),
        lower_(lower),
        upper_(upper),
        y_(JointVector::Zero(a.cols()).cwiseMax(lower).cwiseMin(upper)) {
    for (Eigen::Index i = 0; i < y_.size(); ++i) fixed_[i] = lower[i] >= upper[i];
  }

  JointVector solve() {
    for (Eigen::Index round = 0; round < 4 * y_.size(); ++round)
      if (!move_free() && !release_one()) break;
    return y_;
  }

 private:
  /// The best y with the fixed unknowns as they are, without bounds of the others.
  JointVector best_of_free() const {
    TaskJacobian free = a_;
    TaskVector rest = b_;
    for (Eigen::Index i = 0; i < y_.size(); ++i) {
      if (!fixed_[i]) continue;
      rest -= a_.col(i) * y_[i];
      free.col(i).setZero();
    }
    return damped_solve(free, lambda_, rest);
  }

  /// Moves toward the best y up to the first bound, and fixes the unknown there. Returns false if there is none.
  bool move_free() {
    const JointVector best = best_of_free();
    double step = 1.0, bound = 0.0;
    Eigen::Index first = -1;
    for (Eigen::Index i = 0; i < y_.size(); ++i) {
      if (fixed_[i] || (best[i] >= lower_[i] && best[i] <= upper_[i])) continue;
      const double passed = best[i] > upper_[i] ? upper_[i] : lower_[i];
      const double share = (passed - y_[i]) / (best[i] - y_[i]);
      if (share < step) step = share, first = i, bound = passed;
    }
    for (Eigen::Index i = 0; i < y_.size(); ++i)
      if (!fixed_[i]) y_[i] = std::clamp(y_[i] + step * (best[i] - y_[i]), lower_[i], upper_[i]);
    if (first < 0) return false;
    fixed_[first] = true;
    y_[first] = bound;  // not rounded
    return true;
  }

  /// Releases the unknown whose way back from its bound lowers the cost most. Returns false if there is none.
  bool release_one() {
    const TaskVector error = a_.lazyProduct(y_) - b_;
    Eigen::Index steepest = -1;
    double most = kLeastSlope;
    for (Eigen::Index i = 0; i < y_.size(); ++i) {
      if (!fixed_[i] || lower_[i] >= upper_[i]) continue;
      const double slope = a_.col(i).dot(error) + lambda_ * lambda_ * y_[i];
      const double inward = y_[i] >= upper_[i] ? slope : -slope;
      if (inward > most) most = inward, steepest = i;
    }
    if (steepest >= 0) fixed_[steepest] = false;
    return steepest >= 0;
  }

  const TaskJacobian& a_;
  const TaskVector& b_;
  const double lambda_;
  const JointVector &lower_, &upper_;
  JointVector y_;
  std::array<bool, kMaxJoints> fixed_{};
};

}  // namespace

JointVector bounded_least_squares(const TaskJacobian& a, const TaskVector& b, double lambda, const JointVector& lower,
                                  const JointVector& upper) {
  return ActiveSet(a, b, lambda, lower, upper).solve();
}

}  // namespace sidestep
