#include "firmware/control/shield/evasion.h"

#include <algorithm>

#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

constexpr int kMostWays = 4;         // 2^4 combinations of sides
constexpr int kMostObstacles = 16;   // looked at in a rollout
constexpr double kStep_s = 0.07;     // of a rollout
constexpr int kMostSteps = 160;      // of a rollout: more than the longest horizon, 10 s, and what is after
constexpr double kAfter_s = 0.2;     // looked at beyond the last approach
constexpr double kMissWeight = 1e4;  // cost of a metre of missing clearance

/// Another side has to be better by this much, or the arm would dither between two.
constexpr double kClearlyBetter = 0.8;

/// The obstacles of the near pairs where they are, and when those that come too close come closest: the closest of
/// them, and the last.
struct Threats {
  BoundedList<Obstacle, kMostObstacles> obstacles;
  double worst_s = 0.0;
  double last_s = 0.0;
};

Threats find_threats(const ShieldSettings& settings, const Clearance& clearance, const ObstacleView& view) {
  Threats threats;
  BoundedList<int, kMostObstacles> known;
  double least_m = settings.pass_clearance_m;
  for (const NearPair& pair : clearance.near) {
    const ClosestApproach& approach = pair.approach;
    if (approach.distance_m < settings.pass_clearance_m) threats.last_s = std::max(threats.last_s, approach.time_s);
    if (approach.distance_m < least_m) {
      least_m = approach.distance_m;
      threats.worst_s = approach.time_s;
    }
    if (known.is_full() || std::find(known.begin(), known.end(), pair.now.obstacle) != known.end()) continue;
    known.add(pair.now.obstacle);
    threats.obstacles.add(view.extrapolated(pair.now.obstacle));
  }
  return threats;
}

/// The joint positions on the way, kStep_s apart, when the arm takes up a joint velocity as fast as it can and keeps
/// it.
using Way = BoundedList<JointVector, kMostSteps>;

Way way_of(const ShieldInput& now, const JointVector& velocity_radps, double duration_s) {
  Way way;
  while (!way.is_full() && (way.size() + 1) * kStep_s <= duration_s) way.add(now.position_rad);
  const JointLimits& limits = now.arm.limits;
  for (int joint = 0; joint < now.arm.joints; ++joint) {
    const double change = limits.acceleration_radps2[joint] * kStep_s, goal = velocity_radps[joint];
    const double lower = limits.lower_rad[joint], upper = limits.upper_rad[joint];
    double q = now.position_rad[joint], qd = now.last_velocity_radps[joint];
    for (JointVector& position_rad : way) {
      const double next = qd + std::clamp(goal - qd, -change, change);
      q = std::clamp(q + 0.5 * kStep_s * (qd + next), lower, upper);
      qd = next;
      position_rad.coeffRef(joint) = q;
    }
  }
  return way;
}

/// What a way out costs: how far it is from the wish, and what it will miss of the hard clearance.
class Judge {
 public:
  Judge(const ShieldSettings& settings, const ShieldInput& now, const QpObjective& objective)
      : settings_(settings),
        now_(now),
        objective_(objective),
        threats_(find_threats(settings, now.clearance, now.obstacles)),
        worst_step_(static_cast<int>(threats_.worst_s / kStep_s)) {}  // of every way, which goes on for kAfter_s

  /// Exact below too_much; else anything from there on, which takes less time to find out.
  double cost(const JointVector& velocity_radps, double too_much) {
    const JointVector off = velocity_radps - objective_.nominal_radps;
    const double tool = (objective_.tool_jacobian * off).squaredNorm();
    const double distance = 0.5 * (off.squaredNorm() + objective_.tool_weight * tool);
    if (distance >= too_much) return distance;
    const double inflation_m = 1e-9;
    const double most_m = (too_much - distance) / kMissWeight + inflation_m;
    return distance + kMissWeight * clearance_deficit_m(velocity_radps, most_m);
  }

  /// Exact up to most_m. Looks first where the way before was worst: there the next one most likely fails as well.
  double clearance_deficit_m(const JointVector& velocity_radps, double most_m) {
    const Way way = way_of(now_, velocity_radps, threats_.last_s + kAfter_s);
    const double enough_m = settings_.hard_clearance_m - most_m;
    double least_m = settings_.hard_clearance_m;
    for (int i = 0, step = worst_step_; i < way.size() && least_m >= enough_m; ++i, step = (step + 1) % way.size()) {
      const double after_s = (step + 1) * kStep_s;
      const double there_m = clearance_after(now_.arm, forward_kinematics(now_.arm, way[step]),
                                             threats_.obstacles.begin(), threats_.obstacles.size(), after_s, least_m);
      if (there_m < least_m) worst_step_ = step;
      least_m = there_m;
    }
    return settings_.hard_clearance_m - least_m;
  }

 private:
  const ShieldSettings& settings_;
  const ShieldInput& now_;
  const QpObjective& objective_;
  const Threats threats_;
  int worst_step_;
};

/// The ways that links may leave on either side: indices of rows, the first kMostWays.
struct Ways {
  int count = 0;
  std::array<int, kMostWays> rows;
};

Ways find_ways(const ConstraintRows& rows) {
  Ways ways;
  for (int i = 0; i < rows.size() && ways.count < kMostWays; ++i)
    if (rows[i].other_bound > 0.0) ways.rows[ways.count++] = i;
  return ways;
}

/// The rows with the ways of a set left on their other side.
ConstraintRows turn(const ConstraintRows& rows, const Ways& ways, int sides) {
  ConstraintRows rotated = rows;
  for (int way = 0; way < ways.count; ++way) {
    if (!(sides >> way & 1)) continue;
    ConstraintRow& row = rotated[ways.rows[way]];
    row.row = -row.row;
    std::swap(row.bound, row.other_bound);
  }
  return rotated;
}

bool is_threatened(const ConstraintRows& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const ConstraintRow& row) { return row.tier == Tier::kPass && row.bound > 0.0; });
}

}  // namespace

Evasion evade(const ShieldSettings& settings, const ShieldInput& now, const ConstraintRows& rows,
              const VelocityRange& range, const QpObjective& objective, const JointVector& plan_radps) {
  if (!is_threatened(rows)) return {plan_radps, false};
  Judge judge(settings, now, objective);
  if (judge.clearance_deficit_m(plan_radps, 0.0) <= 0.0) return {plan_radps, false};
  JointVector best = plan_radps;
  double best_cost = std::numeric_limits<double>::infinity();
  const auto consider = [&](const JointVector& candidate, double advantage) {
    const double cost = advantage * judge.cost(candidate, best_cost / advantage);
    if (cost >= best_cost) return;
    best = candidate;
    best_cost = cost;
  };
  // What was good the cycle before mostly still is; known first, it spares looking at the others to their end.
  if (now.evasion_radps.size() > 0)
    consider(now.evasion_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps), kClearlyBetter);
  consider(plan_radps, 1.0);
  const Ways ways = find_ways(rows);
  for (int sides = 1; sides < 1 << ways.count; ++sides)
    consider(solve(turn(rows, ways, sides), range, objective).velocity_radps, 1.0);
  for (int joint = 0; joint < now.arm.joints; ++joint) {
    for (const double speed : {range.lower_radps[joint], range.upper_radps[joint]}) {
      JointVector single = JointVector::Zero(now.arm.joints);
      single[joint] = speed;
      consider(single, 1.0);
    }
  }
  return {best, true};
}

}  // namespace sidestep
