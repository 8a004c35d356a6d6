#include "firmware/control/evasion.h"

#include <algorithm>

namespace sidestep {
namespace {

constexpr int kMostWays = 4;         // 2^4 combinations of sides
constexpr int kMostObstacles = 16;   // looked at in a rollout
constexpr double kStep_s = 0.05;     // of a rollout
constexpr double kAfter_s = 0.2;     // looked at beyond the last approach
constexpr double kMissWeight = 1e3;  // cost of a metre of missing clearance

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
  double least_m = std::numeric_limits<double>::infinity();
  for (const LinkShape& shape : now.arm.shapes) {
    if (shape.body == 0) continue;
    const Capsule link = placed(posture, shape);
    for (int i = 0; i < threats.count; ++i) {
      const Capsule then = moved(now.obstacles.set->obstacles[threats.obstacles[i]], now.obstacles.age_s + time_s);
      const NearestPoints points = nearest_on_axes(link, then);
      least_m = std::min(least_m, (points.a - points.b).norm() - link.radius_m - then.radius_m);
    }
  }
  return least_m;
}

/// The least clearance on the way when the arm takes up a joint velocity as fast as it can and keeps it.
double least_clearance(const Surroundings& now, const Threats& threats, const JointVector& velocity_radps) {
  const JointLimits& limits = now.arm.limits;
  const JointVector change = limits.acceleration_radps2 * kStep_s;
  JointVector q_rad = now.position_rad, qd_radps = now.last_velocity_radps;
  double least_m = std::numeric_limits<double>::infinity();
  for (double time_s = kStep_s; time_s <= threats.last_s + kAfter_s; time_s += kStep_s) {
    const JointVector next = qd_radps + (velocity_radps - qd_radps).cwiseMax(-change).cwiseMin(change);
    q_rad = (q_rad + 0.5 * kStep_s * (qd_radps + next)).cwiseMax(limits.lower_rad).cwiseMin(limits.upper_rad);
    qd_radps = next;
    least_m = std::min(least_m, clearance_at(now, threats, q_rad, time_s));
  }
  return least_m;
}

}  // namespace

QpSolution choose_sides(const ShieldSettings& settings, const Surroundings& now, const ShieldRows& rows,
                        const VelocityRange& range, const Nearness& nearness, const QpSolution& plan) {
  std::array<int, kMostWays> ways;
  int count = 0;
  for (int i = 0; i < rows.count && count < kMostWays; ++i)
    if (rows.rows[i].other_bound > 0.0) ways[count++] = i;
  if (count == 0) return plan;

  const Threats threats = find_threats(now.clearance);
  const auto judge = [&](const QpSolution& candidate) {
    const double missing_m = settings.pass_clearance_m - least_clearance(now, threats, candidate.velocity_radps);
    return candidate.cost + kMissWeight * std::max(0.0, missing_m);
  };
  QpSolution best = plan;
  double best_cost = judge(plan);
  for (int sides = 1; sides < 1 << count; ++sides) {
    ShieldRows turned = rows;
    for (int way = 0; way < count; ++way) {
      if (!(sides >> way & 1)) continue;
      ShieldRow& row = turned.rows[ways[way]];
      row.row = -row.row;
      std::swap(row.bound, row.other_bound);
    }
    const QpSolution candidate = solve(turned, range, nearness);
    const double cost = judge(candidate);
    if (cost >= kClearlyBetter * best_cost) continue;
    best = candidate;
    best_cost = cost;
  }
  return best;
}

}  // namespace sidestep
