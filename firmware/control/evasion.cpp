#include "firmware/control/evasion.h"

#include <algorithm>

#include "firmware/model/prediction.h"

namespace sidestep {
namespace {

constexpr int kMostWays = 4;         // 2^4 combinations of sides
constexpr int kMostObstacles = 16;   // looked at in a rollout
constexpr double kStep_s = 0.05;     // of a rollout
constexpr double kAfter_s = 0.2;     // looked at beyond the last approach
constexpr double kMissWeight = 1e4;  // cost of a metre of missing clearance

/// Another side has to be better by this much, or the arm would dither between two.
constexpr double kClearlyBetter = 0.8;

/// The obstacles of the near pairs where they are, and when the last of them comes closest.
struct Threats {
  BoundedList<Obstacle, kMostObstacles> obstacles;
  double last_s = 0.0;
};

Threats find_threats(const Clearance& clearance, const ObstacleView& view) {
  Threats threats;
  BoundedList<int, kMostObstacles> known;
  for (const NearPair& pair : clearance.near) {
    threats.last_s = std::max(threats.last_s, pair.approach.time_s);
    if (known.is_full() || std::find(known.begin(), known.end(), pair.now.obstacle) != known.end()) continue;
    known.add(pair.now.obstacle);
    threats.obstacles.add(view.present(pair.now.obstacle));
  }
  return threats;
}

/// The least clearance, of most_m, on the way when the arm takes up a joint velocity as fast as it can and keeps it.
/// Below enough_m the rest of the way is not looked at.
double least_clearance(const Surroundings& now, const Threats& threats, const JointVector& velocity_radps,
                       double enough_m, double most_m) {
  const JointLimits& limits = now.arm.limits;
  const JointVector change = limits.acceleration_radps2 * kStep_s;
  JointVector q_rad = now.position_rad, qd_radps = now.last_velocity_radps;
  double least_m = most_m;
  for (double time_s = kStep_s; time_s <= threats.last_s + kAfter_s && least_m >= enough_m; time_s += kStep_s) {
    const JointVector next = qd_radps + (velocity_radps - qd_radps).cwiseMax(-change).cwiseMin(change);
    q_rad = (q_rad + 0.5 * kStep_s * (qd_radps + next)).cwiseMax(limits.lower_rad).cwiseMin(limits.upper_rad);
    qd_radps = next;
    least_m = clearance_after(now.arm, forward(now.arm, q_rad), threats.obstacles.begin(), threats.obstacles.size(),
                              time_s, least_m);
  }
  return least_m;
}

/// What a way out costs: how far it is from the wish, and what it will miss of the hard clearance.
class Judge {
 public:
  Judge(const ShieldSettings& settings, const Surroundings& now, const Nearness& nearness)
      : settings_(settings), now_(now), nearness_(nearness), threats_(find_threats(now.clearance, now.obstacles)) {}

  /// Exact below too_much; else anything from there on, which takes less time to find out.
  double cost(const JointVector& velocity_radps, double too_much) const {
    const JointVector off = velocity_radps - nearness_.wish_radps;
    const double tool = (nearness_.tool_jacobian * off).squaredNorm();
    const double distance = 0.5 * (off.squaredNorm() + nearness_.tool_weight * tool);
    if (distance >= too_much) return distance;
    const double rounding_m = 1e-9;
    const double most_m = (too_much - distance) / kMissWeight + rounding_m;
    return distance + kMissWeight * missing_m(velocity_radps, most_m);
  }

  /// Exact up to most_m.
  double missing_m(const JointVector& velocity_radps, double most_m) const {
    const double clearance_m = settings_.hard_clearance_m;
    return clearance_m - least_clearance(now_, threats_, velocity_radps, clearance_m - most_m, clearance_m);
  }

 private:
  const ShieldSettings& settings_;
  const Surroundings& now_;
  const Nearness& nearness_;
  const Threats threats_;
};

/// The ways that links may leave on either side: indices of rows, the first kMostWays.
struct Ways {
  int count = 0;
  std::array<int, kMostWays> rows;
};

Ways find_ways(const ShieldRows& rows) {
  Ways ways;
  for (int i = 0; i < rows.size() && ways.count < kMostWays; ++i)
    if (rows[i].other_bound > 0.0) ways.rows[ways.count++] = i;
  return ways;
}

/// The rows with the ways of a set left on their other side.
ShieldRows turn(const ShieldRows& rows, const Ways& ways, int sides) {
  ShieldRows turned = rows;
  for (int way = 0; way < ways.count; ++way) {
    if (!(sides >> way & 1)) continue;
    ShieldRow& row = turned[ways.rows[way]];
    row.row = -row.row;
    std::swap(row.bound, row.other_bound);
  }
  return turned;
}

bool is_threatened(const ShieldRows& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const ShieldRow& row) { return row.tier == Tier::kPass && row.bound > 0.0; });
}

}  // namespace

Evasion evade(const ShieldSettings& settings, const Surroundings& now, const ShieldRows& rows,
              const VelocityRange& range, const Nearness& nearness, const JointVector& plan_radps) {
  if (!is_threatened(rows)) return {plan_radps, false};
  const Judge judge(settings, now, nearness);
  if (judge.missing_m(plan_radps, 0.0) <= 0.0) return {plan_radps, false};
  JointVector best = plan_radps;
  double best_cost = judge.cost(plan_radps, std::numeric_limits<double>::infinity());
  const auto consider = [&](const JointVector& candidate, double advantage) {
    const double cost = advantage * judge.cost(candidate, best_cost / advantage);
    if (cost >= best_cost) return;
    best = candidate;
    best_cost = cost;
  };
  const Ways ways = find_ways(rows);
  for (int sides = 1; sides < 1 << ways.count; ++sides)
    consider(solve(turn(rows, ways, sides), range, nearness).velocity_radps, 1.0);
  for (int joint = 0; joint < now.arm.joints; ++joint) {
    for (const double speed : {range.lower_radps[joint], range.upper_radps[joint]}) {
      JointVector single = JointVector::Zero(now.arm.joints);
      single[joint] = speed;
      consider(single, 1.0);
    }
  }
  if (now.evasion_radps.size() > 0)
    consider(now.evasion_radps.cwiseMax(range.lower_radps).cwiseMin(range.upper_radps), kClearlyBetter);
  return {best, true};
}

}  // namespace sidestep
