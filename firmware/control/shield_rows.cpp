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

void add(const VelocityRange& range, const ShieldRow& row, ShieldRows& rows) {
  const double shortfall = worst_shortfall(row, range);
  if (shortfall <= 0.0) return;
  if (!rows.is_full()) {
    rows.add(row);
    return;
  }
  const auto least = std::min_element(rows.begin(), rows.end(), [&](const auto& a, const auto& b) {
    return worst_shortfall(a, range) < worst_shortfall(b, range);
  });
  if (worst_shortfall(*least, range) < shortfall) *least = row;
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

/// Works out the rows of one cycle.
class RowMaker {
 public:
  RowMaker(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& lasting,
           const VelocityRange& range, RowSets& rows)
      : settings_(settings), now_(now), lasting_(lasting), range_(range), rows_(rows) {}

  void add_self(int a, int b) {
    const LinkShape &first = now_.arm.shapes[a], &second = now_.arm.shapes[b];
    const Proximity pair = measure_pair(placed(now_.posture, first), placed(now_.posture, second));
    const JointVector row = point_row(now_.posture, first.body, pair.on_arm, pair.normal) -
                            point_row(now_.posture, second.body, pair.on_obstacle, pair.normal);
    add_hard(row, pair.distance_m - settings_.self_clearance_m, 0.0);
  }

  void add_distance(const NearPair& pair) {
    const double distance_m = pair.now.distance_m;
    if (distance_m > settings_.range_m) return;
    const JointVector row = point_row(now_.posture, body_of(pair), pair.now.on_arm, pair.now.normal);
    const double approaching_mps = pair.now.normal.dot(pair.velocity_mps);

    // An obstacle whose way leads past the link need not be run away from: what counts is where it will be.
    const double passing = std::clamp((pair.approach.distance_m - settings_.hard_clearance_m) /
                                          (settings_.pass_clearance_m - settings_.hard_clearance_m),
                                      0.0, 1.0);
    const double threat_mps = approaching_mps > 0.0 ? (1.0 - passing) * approaching_mps : approaching_mps;
    add_hard(row, distance_m - settings_.hard_clearance_m, threat_mps);
    add_plan(row, approaching_mps + barrier(settings_.comfort_gain_per_s, distance_m, settings_.comfort_clearance_m),
             Tier::kComfort);
  }

  void add_pass(const NearPair& pair) {
    const Approach& approach = pair.approach;
    if (approach.time_s <= 0.0) return;
    const Vector3 side = approach.head_on ? chosen_side(pair) : approach.normal;
    const JointVector row = point_row(now_.posture, body_of(pair), approach.on_arm, side);
    const double missing_m = settings_.pass_clearance_m - approach.distance_m;
    if (missing_m <= 0.0) {
      add_plan(row, barrier(settings_.pass_gain_per_s, approach.distance_m, settings_.pass_clearance_m), Tier::kPass);
      return;
    }
    // The arm needs a while to get moving; what is left of the time has to do.
    const double time_s = std::max(approach.time_s - settings_.pass_reaction_s, kShortestPass_s);
    const bool two_sides = approach.axis_distance_m < kTwoSides_m;
    const double other_m = two_sides ? missing_m + 2.0 * approach.axis_distance_m : 0.0;
    add_plan(row, missing_m / time_s, Tier::kPass, other_m / time_s);
  }

 private:
  int body_of(const NearPair& pair) const { return now_.arm.shapes[pair.now.shape].body; }

  void add_hard(const JointVector& row, double room_m, double closing_mps) {
    const double bound_mps = hard_barrier(settings_, now_, row, room_m, closing_mps);
    const ShieldRow hard{row, std::min(bound_mps, kLargestDemand_mps), Tier::kHard};
    add(lasting_, hard, rows_.plan);
    add(range_, hard, rows_.step);
  }
  void add_plan(const JointVector& row, double bound_mps, Tier tier, double other_bound_mps = 0.0) {
    add(lasting_, {row, std::min(bound_mps, kLargestDemand_mps), tier, other_bound_mps}, rows_.plan);
  }

  /// The side on which a link leaves the way of an obstacle that comes straight at it: the one it is already moving to.
  Vector3 chosen_side(const NearPair& pair) const {
    const double decisive_mps = 0.02;
    const Approach& approach = pair.approach;
    const Vector3 drift = point_jacobian(now_.posture, body_of(pair), approach.on_arm) * now_.last_velocity_radps +
                          decisive_mps * pair.velocity_mps.unitOrthogonal();
    return drift.dot(approach.normal) < 0.0 ? Vector3(-approach.normal) : approach.normal;
  }

  const ShieldSettings& settings_;
  const Surroundings& now_;
  const VelocityRange& lasting_;
  const VelocityRange& range_;
  RowSets& rows_;
};

}  // namespace

RowSets make_rows(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& lasting,
                  const VelocityRange& range) {
  RowSets rows;
  RowMaker maker(settings, now, lasting, range, rows);
  for (const auto& [a, b] : now.self_pairs) maker.add_self(a, b);
  for (const NearPair& pair : now.clearance.near) {
    maker.add_distance(pair);
    maker.add_pass(pair);
  }
  return rows;
}

}  // namespace sidestep
