#include "firmware/control/shield_rows.h"

#include <algorithm>

namespace sidestep {
namespace {

/// Penetration and missing time make demands that no arm can meet; beyond this they say nothing more.
constexpr double kLargestDemand_mps = 3.0;
constexpr double kShortestPass_s = 0.05;

/// A way that meets the link's axis within this distance can be left to either side.
constexpr double kTwoSides_m = 0.08;

/// What the row lacks with the worst velocity in range; not positive: every velocity meets it.
double worst_shortfall(const ShieldRow& row, const VelocityRange& range) {
  return row.bound - row.row.cwiseProduct(range.lower_radps).cwiseMin(row.row.cwiseProduct(range.upper_radps)).sum();
}

void add(const VelocityRange& range, ShieldRow row, ShieldRows& rows) {
  row.bound = std::min(row.bound, kLargestDemand_mps);
  const double shortfall = worst_shortfall(row, range);
  if (shortfall <= 0.0) return;
  if (rows.count < kMaxRows) {
    rows.rows[rows.count++] = row;
    return;
  }
  const auto least = std::min_element(rows.rows.begin(), rows.rows.end(), [&](const auto& a, const auto& b) {
    return worst_shortfall(a, range) < worst_shortfall(b, range);
  });
  if (worst_shortfall(*least, range) < shortfall) *least = row;
}

/// The side on which a link leaves the way of an obstacle that comes straight at it: the one it is already moving to.
Vector3 chosen_side(const Approach& approach, const PointJacobian& jacobian, const JointVector& last_velocity_radps,
                    const Vector3& obstacle_velocity_mps) {
  if (!approach.head_on) return approach.normal;
  const double decisive_mps = 0.02;
  const Vector3 drift = jacobian * last_velocity_radps + decisive_mps * obstacle_velocity_mps.unitOrthogonal();
  return drift.dot(approach.normal) < 0.0 ? Vector3(-approach.normal) : approach.normal;
}

/// Distance barrier of one tier: d' >= -gain (d - clearance).
double barrier(double gain_per_s, double distance_m, double clearance_m) {
  return -gain_per_s * (distance_m - clearance_m);
}

/// The hard barrier, which has to be kept with the accelerations that the joints have: the arm itself never goes nearer
/// at a speed that it could not brake within the room left, one period of travel included. Along a row the joints brake
/// with sum |row_i| a_i together; other rows need their share of it. closing_mps is the obstacle's part.
double hard_barrier(const ShieldSettings& settings, const Surroundings& now, const JointVector& row, double room_m,
                    double closing_mps) {
  const double share = 0.5;
  const double braking_mps2 = share * row.cwiseAbs().dot(now.arm.limits.acceleration_radps2);
  const double by_gain_mps = closing_mps - settings.hard_gain_per_s * room_m;
  if (room_m <= 0.0) return by_gain_mps;
  return std::max(by_gain_mps, std::min(closing_mps, 0.0) - stopping_velocity(room_m, braking_mps2, now.period_s));
}

void add_pass(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& range, const NearPair& pair,
              const Vector3& obstacle_velocity_mps, ShieldRows& rows) {
  const Approach& approach = pair.approach;
  if (approach.time_s <= 0.0) return;
  const PointJacobian jacobian = point_jacobian(now.posture, now.arm.shapes[pair.now.shape].body, approach.on_arm);
  const Vector3 side = chosen_side(approach, jacobian, now.last_velocity_radps, obstacle_velocity_mps);
  const JointVector row = jacobian.transpose() * side;
  const double missing_m = settings.pass_clearance_m - approach.distance_m;
  if (missing_m <= 0.0) {
    add(range, {row, barrier(settings.pass_gain_per_s, approach.distance_m, settings.pass_clearance_m), Tier::kPass},
        rows);
    return;
  }
  // The arm needs a while to get moving; what is left of the time has to do.
  const double time_s = std::max(approach.time_s - settings.pass_reaction_s, kShortestPass_s);
  const bool two_sides = approach.axis_distance_m < kTwoSides_m;
  const double other_m = two_sides ? missing_m + 2.0 * approach.axis_distance_m : 0.0;
  add(range, {row, missing_m / time_s, Tier::kPass, other_m / time_s}, rows);
}

void add_distance(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& range,
                  const NearPair& pair, const Vector3& obstacle_velocity_mps, bool hard_only, ShieldRows& rows) {
  const double distance_m = pair.now.distance_m;
  if (distance_m > settings.range_m) return;
  const int body = now.arm.shapes[pair.now.shape].body;
  const JointVector row = point_jacobian(now.posture, body, pair.now.on_arm).transpose() * pair.now.normal;
  const double approaching_mps = pair.now.normal.dot(obstacle_velocity_mps);

  // An obstacle whose way leads past the link need not be run away from: what counts is where it will be.
  const double passing = std::clamp(
      (pair.approach.distance_m - settings.hard_clearance_m) / (settings.pass_clearance_m - settings.hard_clearance_m),
      0.0, 1.0);
  const double threat_mps = approaching_mps > 0.0 ? (1.0 - passing) * approaching_mps : approaching_mps;
  const double room_m = distance_m - settings.hard_clearance_m;
  add(range, {row, hard_barrier(settings, now, row, room_m, threat_mps), Tier::kHard}, rows);
  if (hard_only) return;
  add(range,
      {row, approaching_mps + barrier(settings.comfort_gain_per_s, distance_m, settings.comfort_clearance_m),
       Tier::kComfort},
      rows);
}

void add_self(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& range, int a, int b,
              ShieldRows& rows) {
  const LinkShape &first = now.arm.shapes[a], &second = now.arm.shapes[b];
  const Proximity pair = measure_pair(placed(now.posture, first), placed(now.posture, second));
  const PointJacobian relative =
      point_jacobian(now.posture, first.body, pair.on_arm) - point_jacobian(now.posture, second.body, pair.on_obstacle);
  const JointVector row = relative.transpose() * pair.normal;
  add(range, {row, hard_barrier(settings, now, row, pair.distance_m - settings.self_clearance_m, 0.0), Tier::kHard},
      rows);
}

}  // namespace

ShieldRows make_rows(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& range,
                     bool hard_only) {
  ShieldRows rows;
  for (const auto& [a, b] : now.self_pairs) add_self(settings, now, range, a, b, rows);
  for (int i = 0; i < now.clearance.near_count; ++i) {
    const NearPair& pair = now.clearance.near[i];
    add_distance(settings, now, range, pair, pair.velocity_mps, hard_only, rows);
    if (!hard_only) add_pass(settings, now, range, pair, pair.velocity_mps, rows);
  }
  return rows;
}

}  // namespace sidestep
