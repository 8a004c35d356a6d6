#include "firmware/control/evasion.h"

#include <algorithm>

namespace sidestep {
namespace {

constexpr int kMostWays = 4;         // 2^4 combinations of sides
constexpr int kMostObstacles = 16;   // looked at in a rollout
constexpr double kStep_s = 0.05;     // of a rollout
constexpr double kAfter_s = 0.2;     // looked at beyond the last approach
constexpr double kMissWeight = 1e4;  // cost of a metre of missing clearance

/// Another side has to be better by this much, or the arm would dither between two.
constexpr double kClearlyBetter = 0.8;

/// The obstacles of the near pairs, and when the last of them comes closest.
struct Threats {
  int count = 0;
  std::array<int, kMostObstacles> obstacles;
  double last_s = 0.0;
};

Threats find_threats(const Clearance& clearance) {
  Threats threats;
  for (int i = 0; i < clearance.near_count; ++i) {
    const NearPair& pair = clearance.near[i];
    threats.last_s = std::max(threats.last_s, pair.approach.time_s);
    const auto end = threats.obstacles.begin() + threats.count;
    if (threats.count < kMostObstacles && std::find(threats.obstacles.begin(), end, pair.now.obstacle) == end)
      threats.obstacles[threats.count++] = pair.now.obstacle;
  }
  return threats;
}

double clearance_at(const Surroundings& now, const Threats& threats, const JointVector& q_rad, double time_s) {
  const Posture posture = forward(now.arm, q_rad);
  std::array<Capsule, kMaxShapes> links;
  int count = 0;
  for (const LinkShape& shape : now.arm.shapes)
    if (shape.body > 0) links[count++] = placed(posture, shape);
  double least_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < threats.count; ++i) {
    const Obstacle then = now.obstacles.present(threats.obstacles[i], time_s);
    for (int l = 0; l < count; ++l) least_m = std::min(least_m, surface_distance_m(links[l], then, least_m));
  }
  return least_m;
}

/// The least clearance on the way when the arm takes up a joint velocity as fast as it can and keeps it. Below enough_m
/// the rest of the way is not looked at.
double least_clearance(const Surroundings& now, const Threats& threats, const JointVector& velocity_radps,
                       double enough_m) {
  const JointLimits& limits = now.arm.limits;
  const JointVector change = limits.acceleration_radps2 * kStep_s;
  JointVector q_rad = now.position_rad, qd_radps = now.last_velocity_radps;
  double least_m = std::numeric_limits<double>::infinity();
  for (double time_s = kStep_s; time_s <= threats.last_s + kAfter_s && least_m >= enough_m; time_s += kStep_s) {
    const JointVector next = qd_radps + (velocity_radps - qd_radps).cwiseMax(-change).cwiseMin(change);
    q_rad = (q_rad + 0.5 * kStep_s * (qd_radps + next)).cwiseMax(limits.lower_rad).cwiseMin(limits.upper_rad);
    qd_radps = next;
    least_m = std::min(least_m, clearance_at(now, threats, q_rad, time_s));
  }
  return least_m;
}

/// What a way out costs: how far it is from the wish, and what it will miss of the hard clearance.
class Judge {
 public:
  Judge(const ShieldSettings& settings, const Surroundings& now, const Nearness& nearness)
      : settings_(settings), now_(now), nearness_(nearness), threats_(find_threats(now.clearance)) {}

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
    const double enough_m = settings_.hard_clearance_m - most_m;
    return std::max(0.0, settings_.hard_clearance_m - least_clearance(now_, threats_, velocity_radps, enough_m));
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
  for (int i = 0; i < rows.count && ways.count < kMostWays; ++i)
    if (rows.rows[i].other_bound > 0.0) ways.rows[ways.count++] = i;
  return ways;
}

/// The rows with the ways of a set left on their other side.
ShieldRows turn(const ShieldRows& rows, const Ways& ways, int sides) {
  ShieldRows turned = rows;
  for (int way = 0; way < ways.count; ++way) {
    if (!(sides >> way & 1)) continue;
    ShieldRow& row = turned.rows[ways.rows[way]];
    row.row = -row.row;
    std::swap(row.bound, row.other_bound);
  }
  return turned;
}

bool is_threatened(const ShieldRows& rows) {
  return std::any_of(rows.rows.begin(), rows.rows.begin() + rows.count,
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
