#include "firmware/control/shield/evasion.h"

#include <algorithm>

#include "firmware/control/shield/required_clearance.h"
#include "firmware/model/damped_inverse.h"
#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

constexpr int kMaxTwoSidedRows = 4;  // 2^4 combinations of sides
constexpr int kMaxThreats = 16;      // in a rollout
constexpr double kStep_s = 0.07;     // of a rollout; chosen by the success rate of the campaign family erratic
constexpr int kMaxSteps = 160;       // covers the longest pass_horizon, 10 s, and kAfter_s
constexpr double kAfter_s = 0.2;     // of a rollout, after the last closest approach
constexpr double kDeficitWeight_per_m = 1e4;
constexpr double kDeficitPerToolWeight_m = 1000.0 / 6.0;  // less led to contacts in the campaign's real
constexpr double kRounding_m = 1e-9;
constexpr double kPreviousEvasionFactor = 0.8;
constexpr double kNullSpaceDamping = 0.01;
constexpr double kLeastDirection = 0.1;  // a shorter projection on the null space is mostly the damping's error

// Until kSoon_s ahead a rollout keeps the full clearance, after that less by kLater_mps: the obstacle may turn away
// before, and later cycles can still evade it. Chosen by the success rate of the campaign family erratic.
constexpr double kSoon_s = 0.3;
constexpr double kLater_mps = 0.05;

/// The obstacles of the near pairs at present, and the times of the closest approaches below pass_clearance: of the
/// closest and of the last one, s.
struct Threats {
  BoundedList<Obstacle, kMaxThreats> obstacles;
  BoundedList<double, kMaxThreats> allowance_m;  // hard_clearance less what the obstacle needs
  double closest_s = 0.0;
  double last_s = 0.0;
};

/// The obstacles of the pairs with the least distances, by index into the ObstacleView.
BoundedList<int, kMaxThreats> most_urgent_obstacles(const Clearance& clearance) {
  const auto less = [](const NearPair* a, const NearPair* b) { return a->least_distance_m() < b->least_distance_m(); };
  BoundedList<const NearPair*, kMaxNear> pairs;
  for (const NearPair& pair : clearance.near) pairs.add(&pair);
  std::sort(pairs.begin(), pairs.end(), less);
  BoundedList<int, kMaxThreats> urgent;
  for (const NearPair* pair : pairs)
    if (!urgent.is_full() && std::find(urgent.begin(), urgent.end(), pair->now.obstacle) == urgent.end())
      urgent.add(pair->now.obstacle);
  return urgent;
}

Threats find_threats(const ShieldSettings& settings, const ShieldInput& input) {
  const ObstacleView& view = input.obstacles;
  Threats threats;
  double least_m = settings.pass_clearance_m;
  for (const NearPair& pair : input.clearance.near) {
    if (!approach_counts(input, pair)) continue;
    const ClosestApproach& approach = pair.approach;
    if (approach.distance_m < settings.pass_clearance_m) threats.last_s = std::max(threats.last_s, approach.time_s);
    if (approach.distance_m < least_m) {
      least_m = approach.distance_m;
      threats.closest_s = approach.time_s;
    }
  }
  for (const int index : most_urgent_obstacles(input.clearance)) {
    threats.obstacles.add(view.extrapolated(index));
    threats.allowance_m.add(settings.hard_clearance_m - hard_clearance_m(settings, doubt(view, index), 0.0));
  }
  return threats;
}

/// Joint positions kStep_s apart while the arm accelerates to a joint velocity at its limits and keeps it.
using Rollout = BoundedList<JointVector, kMaxSteps>;

Rollout roll_out(const ShieldInput& input, const JointVector& velocity_radps, double duration_s) {
  Rollout rollout;
  while (!rollout.is_full() && (rollout.size() + 1) * kStep_s <= duration_s) rollout.add(input.position_rad);
  const JointLimits& limits = input.arm.limits;
  for (int joint = 0; joint < input.arm.joints; ++joint) {
    const double change = limits.acceleration_radps2[joint] * kStep_s, goal = velocity_radps[joint];
    const double lower = limits.lower_rad[joint], upper = limits.upper_rad[joint];
    double q = input.position_rad[joint], qd = input.last_velocity_radps[joint];
    for (JointVector& position_rad : rollout) {
      const double next = qd + std::clamp(goal - qd, -change, change);
      q = std::clamp(q + 0.5 * kStep_s * (qd + next), lower, upper);
      qd = next;
      position_rad.coeffRef(joint) = q;
    }
  }
  return rollout;
}

/// Cost per metre of missing clearance. In proportion to the tool's weight, so that no weight keeps the tool in place
/// until it is too late to evade; not for a full pose, of which the moving ones were then lost more often (chase6d).
double deficit_weight_per_m(const QpObjective& objective) {
  const bool is_full_pose = objective.tool_jacobian.rows() == 6;
  return is_full_pose ? kDeficitWeight_per_m
                      : std::max(kDeficitWeight_per_m, kDeficitPerToolWeight_m * objective.tool_weight);
}

/// Cost of a joint velocity: its distance from the wanted one, and the clearance deficit of its rollout.
class RolloutCost {
 public:
  RolloutCost(const ShieldSettings& settings, const ShieldInput& input, const QpObjective& objective,
              const JointVector& wanted_radps, bool defers)
      : settings_(settings),
        input_(input),
        objective_(objective),
        wanted_radps_(wanted_radps),
        deficit_weight_per_m_(deficit_weight_per_m(objective)),
        defers_(defers),
        threats_(find_threats(settings, input)),
        // A valid index: every rollout is kAfter_s longer than closest_s.
        worst_step_(static_cast<int>(threats_.closest_s / kStep_s)) {}

  /// Exact below `bound`; otherwise some value of at least `bound`, found with less work.
  double cost(const JointVector& velocity_radps, double bound) {
    const JointVector difference = velocity_radps - wanted_radps_;
    const double tool = (objective_.tool_jacobian * difference).squaredNorm();
    const double joints2 =
        objective_.scale ? difference.cwiseQuotient(*objective_.scale).squaredNorm() : difference.squaredNorm();
    const double distance = 0.5 * (joints2 + objective_.tool_weight * tool);
    if (distance >= bound) return distance;
    const double most_m = std::min((bound - distance) / deficit_weight_per_m_, largest_deficit_m_) + kRounding_m;
    const double deficit_m = clearance_deficit_m(velocity_radps, most_m);
    if (deficit_m >= most_m) return std::max(bound, distance);
    return distance + deficit_weight_per_m_ * deficit_m;
  }

  /// Larger deficits than that of this velocity count as no solution from now on. Returns the deficit, m.
  double limit_deficit(const JointVector& velocity_radps) {
    largest_deficit_m_ = clearance_deficit_m(velocity_radps, std::numeric_limits<double>::infinity());
    return largest_deficit_m_;
  }

  /// Whether the rollout comes to contact with an obstacle that needs no more than the hard clearance.
  bool touches(const JointVector& velocity_radps) {
    const double hard_m = settings_.hard_clearance_m;
    return clearance_deficit_m(velocity_radps, hard_m) >= hard_m;
  }

  /// By how much the rollout comes closer than the hard clearance less deferred_m(), m; exact up to most_m. Starts at
  /// the step that was worst in the previous rollout, where the next one most likely fails as well.
  double clearance_deficit_m(const JointVector& velocity_radps, double most_m) {
    const Rollout rollout = roll_out(input_, velocity_radps, threats_.last_s + kAfter_s);
    const double enough_m = settings_.hard_clearance_m - most_m;
    double least_m = settings_.hard_clearance_m;
    for (int i = 0, step = worst_step_; i < rollout.size() && least_m >= enough_m;
         ++i, step = (step + 1) % rollout.size()) {
      const double after_s = (step + 1) * kStep_s;
      const LinkPoses poses = forward_kinematics(input_.arm, rollout[step], *input_.poses.others);
      const double later_m = deferred_m(after_s);
      const double clearance_m =
          later_m + clearance_after(input_.arm, poses, threats_.obstacles.begin(), threats_.obstacles.size(), after_s,
                                    least_m - later_m, threats_.allowance_m.begin());
      if (clearance_m < least_m) worst_step_ = step;
      least_m = clearance_m;
    }
    return settings_.hard_clearance_m - least_m;
  }

 private:
  /// By how much less than the hard clearance the rollout has to keep after_s ahead, m.
  double deferred_m(double after_s) const {
    return defers_ ? std::clamp(kLater_mps * (after_s - kSoon_s), 0.0, settings_.hard_clearance_m) : 0.0;
  }

  const ShieldSettings& settings_;
  const ShieldInput& input_;
  const QpObjective& objective_;
  const JointVector& wanted_radps_;
  const double deficit_weight_per_m_;
  const bool defers_;  ///< leaves to later cycles what is more than kSoon_s ahead
  const Threats threats_;
  int worst_step_;
  double largest_deficit_m_ = std::numeric_limits<double>::infinity();
};

/// Indices of the pass rows whose obstacle can be passed on either side; of too many, those with the largest bounds.
using TwoSidedRows = BoundedList<int, kMaxTwoSidedRows>;

TwoSidedRows find_two_sided(const ConstraintRows& rows) {
  TwoSidedRows found;
  const auto less = [&](int a, int b) { return rows[a].bound < rows[b].bound; };
  for (int i = 0; i < rows.size(); ++i) {
    if (rows[i].other_bound <= 0.0) continue;
    if (!found.is_full()) {
      found.add(i);
    } else if (int* least = std::min_element(found.begin(), found.end(), less); less(*least, i)) {
      *least = i;
    }
  }
  return found;
}

/// The rows with the other passing side wherever the bit of a two-sided row is set.
ConstraintRows with_sides(const ConstraintRows& rows, const TwoSidedRows& two_sided, int sides) {
  ConstraintRows changed = rows;
  for (int i = 0; i < two_sided.size(); ++i) {
    if (!(sides >> i & 1)) continue;
    ConstraintRow& row = changed[two_sided[i]];
    row.row = -row.row;
    std::swap(row.bound, row.other_bound);
  }
  return changed;
}

/// The projections of the single joints on the null space of the tool's task, n x 1. Those on a null space of one
/// dimension are parallel: the longest one is enough.
BoundedList<JointVector, kMaxJoints> null_space_directions(const TaskJacobian& jacobian) {
  const Eigen::Index n = jacobian.cols();
  BoundedList<JointVector, kMaxJoints> directions;
  for (Eigen::Index joint = 0; joint < n; ++joint) {
    JointVector direction = -damped_solve(jacobian, kNullSpaceDamping, TaskVector(jacobian.col(joint)));
    direction[joint] += 1.0;
    if (direction.norm() > kLeastDirection) directions.add(direction);
  }
  const auto less = [](const JointVector& a, const JointVector& b) { return a.squaredNorm() < b.squaredNorm(); };
  if (n - jacobian.rows() > 1 || directions.size() == 0) return directions;
  BoundedList<JointVector, kMaxJoints> longest;
  longest.add(*std::max_element(directions.begin(), directions.end(), less));
  return longest;
}

/// The largest factor with which from + factor * direction is within the range; `from` is.
double largest_factor(const VelocityRange& range, const JointVector& from, const JointVector& direction) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    const double bound = direction[i] > 0.0 ? range.upper_radps[i] : range.lower_radps[i];
    if (direction[i] != 0.0) least = std::min(least, (bound - from[i]) / direction[i]);
  }
  return least;
}

}  // namespace

Plan evade(const ShieldSettings& settings, const ShieldInput& input, const ConstraintRows& rows,
           const VelocityRange& range, const QpObjective& objective, const JointVector& planned_radps) {
  if (largest_pass_mps(rows) <= 0.0) return {planned_radps, false};
  // Else the target, from which the separation keeps the arm away, would draw it back.
  const bool separates = keeps_separation(input);
  const JointVector& wanted_radps = separates ? planned_radps : objective.nominal_radps;
  RolloutCost rollout_cost(settings, input, objective, wanted_radps, !input.is_stopping && !separates);
  if (rollout_cost.limit_deficit(planned_radps) <= 0.0) return {planned_radps, false};
  JointVector best = planned_radps;
  double best_cost = std::numeric_limits<double>::infinity();
  const auto consider = [&](const JointVector& candidate, double factor) {
    const double cost = factor * rollout_cost.cost(candidate, best_cost / factor);
    if (cost >= best_cost) return;
    best = candidate;
    best_cost = cost;
  };
  // The previous evasion mostly remains the best. Evaluated first, it bounds the work for the others.
  if (input.evasion_radps.size() > 0)
    consider(input.evasion_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps), kPreviousEvasionFactor);
  consider(planned_radps, 1.0);
  const TwoSidedRows two_sided = find_two_sided(rows);
  for (int sides = 1; sides < 1 << two_sided.size(); ++sides)
    consider(solve(with_sides(rows, two_sided, sides), range, objective).velocity_radps, 1.0);
  for (int joint = 0; joint < input.arm.joints; ++joint) {
    for (const double speed : {range.lower_radps[joint], range.upper_radps[joint]}) {
      JointVector single = JointVector::Zero(input.arm.joints);
      single[joint] = speed;
      consider(single, 1.0);
    }
  }
  const JointVector from = wanted_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps);
  for (const JointVector& direction : null_space_directions(objective.tool_jacobian)) {
    const double forward = largest_factor(range, from, direction), back = largest_factor(range, from, -direction);
    for (const double share : {1.0, 0.5, 0.25}) {
      consider(from + share * forward * direction, 1.0);
      consider(from - share * back * direction, 1.0);
    }
  }
  for (int joint = 0; input.is_stopping && joint < input.arm.joints && rollout_cost.touches(best); ++joint) {
    for (const double speed : {range.lower_radps[joint], 0.0, range.upper_radps[joint]}) {
      JointVector other = best;
      other[joint] = speed;
      consider(other, 1.0);
    }
  }
  return {best, true};
}

}  // namespace sidestep
