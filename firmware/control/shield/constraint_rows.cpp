#include "firmware/control/shield/constraint_rows.h"

#include <algorithm>

#include "firmware/model/joint_axes.h"

namespace sidestep {
namespace {

/// Penetration and missing time make demands that no arm can meet; beyond this they say nothing more.
constexpr double kLargestDemand_mps = 3.0;
constexpr double kShortestPass_s = 0.05;

/// A way that meets the link's axis within this distance can be left to either side.
constexpr double kTwoSides_m = 0.08;

/// The least that a row can come to within a range of velocities.
double least_mps(const JointVector& row, const VelocityRange& range) {
  double sum_mps = 0.0;
  for (Eigen::Index i = 0; i < row.size(); ++i)
    sum_mps += std::min(row.coeff(i) * range.lower_radps.coeff(i), row.coeff(i) * range.upper_radps.coeff(i));
  return sum_mps;
}

/// Whether all velocities of one range are in another.
bool is_within(const VelocityRange& inner, const VelocityRange& outer) {
  return (inner.lower_radps.array() >= outer.lower_radps.array()).all() &&
         (inner.upper_radps.array() <= outer.upper_radps.array()).all();
}

/// Puts a row into a full list, instead of the least pressing one there, if it presses more.
void press_in(const VelocityRange& range, const ConstraintRow& row, ConstraintRows& rows) {
  const auto pressing_mps = [&](const ConstraintRow& r) { return r.bound - least_mps(r.row, range); };
  const auto least = std::min_element(rows.begin(), rows.end(),
                                      [&](const auto& a, const auto& b) { return pressing_mps(a) < pressing_mps(b); });
  if (pressing_mps(*least) < pressing_mps(row)) *least = row;
}

void add(const VelocityRange& range, const JointVector& row, double bound, Tier tier, double other_bound,
         ConstraintRows& rows) {
  if (rows.is_full())
    press_in(range, {row, bound, tier, other_bound}, rows);
  else
    rows.emplace(row, bound, tier, other_bound);
}

/// Distance barrier of one tier: d' >= -gain (d - clearance).
double barrier(double gain_per_s, double distance_m, double clearance_m) {
  return -gain_per_s * (distance_m - clearance_m);
}

/// How fast the joints can brake together along a row.
double braking_mps2(const JointVector& row, const JointLimits& limits) {
  double sum_mps2 = 0.0;
  for (Eigen::Index i = 0; i < row.size(); ++i)
    sum_mps2 += std::abs(row.coeff(i)) * limits.acceleration_radps2.coeff(i);
  return sum_mps2;
}

/// The hard barrier, which has to be kept with the accelerations that the joints have: the arm itself never goes nearer
/// at a speed that it could not brake within the room left, one period of travel included; other rows need their share
/// of the braking. closing_mps is the obstacle's part.
double hard_barrier(const ShieldSettings& settings, const ShieldInput& now, const JointVector& row, double room_m,
                    double closing_mps) {
  const double by_gain_mps = closing_mps - settings.hard_gain_per_s * room_m;
  if (room_m <= 0.0) return by_gain_mps;
  const double share = 0.5;
  const double braked_mps = stopping_velocity(room_m, share * braking_mps2(row, now.arm.limits), now.period_s);
  return std::max(by_gain_mps, std::min(closing_mps, 0.0) - braked_mps);
}

/// Works out the rows of one cycle.
class RowMaker {
 public:
  RowMaker(const ShieldSettings& settings, const ShieldInput& now, const VelocityRange& sustainable,
           const VelocityRange& range, RowSets& rows)
      : settings_(settings),
        now_(now),
        axes_(now.poses),
        sustainable_(sustainable),
        range_(range),
        within_(is_within(range, sustainable)),
        rows_(rows) {
    for (const LinkShape& shape : now.arm.shapes) links_.add(transformed(now.poses, shape));
  }

  void add_self(int a, int b) {
    const Proximity pair = measure_pair(links_[a], links_[b]);
    const JointVector row = axes_.row(now_.arm.shapes[a].body, pair.on_arm, pair.normal) -
                            axes_.row(now_.arm.shapes[b].body, pair.on_obstacle, pair.normal);
    add_hard(row, least_mps(row, sustainable_), pair.distance_m - settings_.self_clearance_m, 0.0);
  }

  void add_distance(const NearPair& pair) {
    const double distance_m = pair.now.distance_m;
    if (distance_m > settings_.range_m) return;
    const JointVector row = axes_.row(body_of(pair), pair.now.on_arm, pair.now.normal);
    const double least = least_mps(row, sustainable_);
    const double approaching_mps = pair.now.normal.dot(pair.velocity_mps);

    // An obstacle whose way leads past the link need not be run away from: what counts is where it will be.
    const double passing = std::clamp((pair.approach.distance_m - settings_.hard_clearance_m) /
                                          (settings_.pass_clearance_m - settings_.hard_clearance_m),
                                      0.0, 1.0);
    const double threat_mps = approaching_mps > 0.0 ? (1.0 - passing) * approaching_mps : approaching_mps;
    add_hard(row, least, distance_m - settings_.hard_clearance_m, threat_mps);
    const double comfort_mps = barrier(settings_.comfort_gain_per_s, distance_m, settings_.comfort_clearance_m);
    add_plan(row, least, approaching_mps + comfort_mps, Tier::kComfort);
  }

  void add_pass(const NearPair& pair) {
    const ClosestApproach& approach = pair.approach;
    if (approach.time_s <= 0.0) return;
    const Vector3 side = approach.head_on ? chosen_side(pair) : approach.normal;
    const JointVector row = axes_.row(body_of(pair), approach.on_arm, side);
    const double least = least_mps(row, sustainable_);
    const double clearance_deficit_m = settings_.pass_clearance_m - approach.distance_m;
    if (clearance_deficit_m <= 0.0) {
      const double pass_mps = barrier(settings_.pass_gain_per_s, approach.distance_m, settings_.pass_clearance_m);
      add_plan(row, least, pass_mps, Tier::kPass);
      return;
    }
    // The arm needs a while to get moving; what is left of the time has to do.
    const double time_s = std::max(approach.time_s - settings_.pass_reaction_s, kShortestPass_s);
    const bool two_sides = approach.axis_distance_m < kTwoSides_m;
    const double other_m = two_sides ? clearance_deficit_m + 2.0 * approach.axis_distance_m : 0.0;
    add_plan(row, least, clearance_deficit_m / time_s, Tier::kPass, other_m / time_s);
  }

 private:
  int body_of(const NearPair& pair) const { return now_.arm.shapes[pair.now.shape].body; }

  /// `least`: m/s, that the row can come to within lasting_. Rows that every velocity meets are left out.
  void add_hard(const JointVector& row, double least, double room_m, double closing_mps) {
    const double bound_mps = std::min(hard_barrier(settings_, now_, row, room_m, closing_mps), kLargestDemand_mps);
    const bool lasts = bound_mps > least;
    if (lasts) add(sustainable_, row, bound_mps, Tier::kHard, 0.0, rows_.plan);
    if (within_ && !lasts) return;
    if (bound_mps > least_mps(row, range_)) add(range_, row, bound_mps, Tier::kHard, 0.0, rows_.step);
  }
  void add_plan(const JointVector& row, double least, double bound_mps, Tier tier, double other_bound_mps = 0.0) {
    bound_mps = std::min(bound_mps, kLargestDemand_mps);
    if (bound_mps > least) add(sustainable_, row, bound_mps, tier, other_bound_mps, rows_.plan);
  }

  /// The side on which a link leaves the way of an obstacle that comes straight at it: the one it is already moving to.
  Vector3 chosen_side(const NearPair& pair) const {
    const double decisive_mps = 0.02;
    const ClosestApproach& approach = pair.approach;
    const Vector3 drift = point_jacobian(now_.poses, body_of(pair), approach.on_arm) * now_.last_velocity_radps +
                          decisive_mps * pair.velocity_mps.unitOrthogonal();
    return drift.dot(approach.normal) < 0.0 ? Vector3(-approach.normal) : approach.normal;
  }

  const ShieldSettings& settings_;
  const ShieldInput& now_;
  const JointAxes axes_;
  BoundedList<Capsule, kMaxShapes> links_;
  const VelocityRange& sustainable_;
  const VelocityRange& range_;
  const bool within_;  ///< range_, in lasting_: then no row can come to less in it
  RowSets& rows_;
};

}  // namespace

RowSets make_rows(const ShieldSettings& settings, const ShieldInput& now, const VelocityRange& sustainable,
                  const VelocityRange& range) {
  RowSets rows;
  RowMaker maker(settings, now, sustainable, range, rows);
  for (const auto& [a, b] : now.self_pairs) maker.add_self(a, b);
  for (const NearPair& pair : now.clearance.near) {
    maker.add_distance(pair);
    maker.add_pass(pair);
  }
  return rows;
}

}  // namespace sidestep
