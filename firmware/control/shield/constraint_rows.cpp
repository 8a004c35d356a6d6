#include "firmware/control/shield/constraint_rows.h"

#include <algorithm>
#include <array>
#include <bitset>

#include "firmware/control/shield/required_clearance.h"
#include "firmware/model/joint_axes.h"
#include "firmware/model/turning_proximity.h"

namespace sidestep {
namespace {

/// Saturates the demanded speed: penetration or a short remaining time would demand more than any arm can do.
constexpr double kLargestDemand_mps = 3.0;
constexpr double kShortestPass_s = 0.05;

/// An obstacle whose path passes the link's axis within this distance can be passed on either side.
constexpr double kTwoSides_m = 0.08;

/// A body that turns less while the arm brakes meets obstacles where it is nearest now.
constexpr double kLeastTurn_rad = 0.01;

/// Links farther apart than this above their clearance do not turn into each other while the arm brakes.
constexpr double kNearLinks_m = 0.03;

/// A link that can leave a person only more slowly has no row for it.
constexpr double kLeastSpeed_mps = 0.02;

/// The longest time by which an arm is assumed to lag behind its command.
constexpr double kLongestLag_s = 0.1;

/// The largest approach of a person that separation counts, about that of a walker. Limbs that are faster turn back
/// within tenths of a second: an arm that made room for each of their strokes would be on its way when the next one,
/// or the other person, comes from elsewhere. What does hit the arm counts in the other tiers.
constexpr double kLargestApproach_mps = 1.0;

/// A row that is violated by less is met.
constexpr double kViolated_mps = 1e-4;

/// The hard rows of two links are multiplied by it, so that they are granted 1/512 of the slack (constraint_rows.h). A
/// power of two: nothing is rounded.
constexpr double kLinksWeight = 512.0;

/// The same for the rows that keep the arm from approaching a near person by itself. They keep the required clearance,
/// while the arm keeps separation kBesidePerson_m more: a hand at 4 m/s covers both in 30 ms, before an arm that
/// approaches has stopped. A person has such a row nearer than kNearPerson_m above what the row keeps.
constexpr double kPersonsWeight = 64.0;
constexpr double kNearPerson_m = 0.05;
constexpr double kBesidePerson_m = 0.1;

/// Places of a list that are reserved for each tier. Beside persons, so that separation from them remains where hard
/// and pass rows alone would fill the list.
using Places = std::array<int, kTiers>;
constexpr Places kReservedBesidePersons{24, 16, 16}, kNoneReserved{};
static_assert(kReservedBesidePersons[0] + kReservedBesidePersons[1] + kReservedBesidePersons[2] == kMaxRows);

/// The least and the largest value of row . q' within a range of velocities, m/s.
double least_mps(const JointVector& row, const VelocityRange& range) {
  double sum_mps = 0.0;
  for (Eigen::Index i = 0; i < row.size(); ++i)
    sum_mps += std::min(row.coeff(i) * range.lower_radps.coeff(i), row.coeff(i) * range.upper_radps.coeff(i));
  return sum_mps;
}

double most_mps(const JointVector& row, const VelocityRange& range) {
  return -least_mps(-row, range);
}

/// Whether one range lies in another.
bool is_within(const VelocityRange& inner, const VelocityRange& outer) {
  return (inner.lower_radps.array() >= outer.lower_radps.array()).all() &&
         (inner.upper_radps.array() <= outer.upper_radps.array()).all();
}

/// Fills a list of rows, and chooses among more than it can hold (ConstraintRows). Within a tier the rows with the
/// largest violation by the worst velocity of the range are kept.
class RowFiller {
 public:
  RowFiller(ConstraintRows& rows, const Places& reserved) : rows_(rows), reserved_(reserved) {}

  void add(const JointVector& row, double bound, Tier tier, double violation_mps, double other_bound = 0.0) {
    if (!rows_.is_full()) {
      rows_.emplace(row, bound, tier, other_bound);
      violations_mps_.add(violation_mps);
      ++count_[index(tier)];
      return;
    }
    const Tier yielding = yielding_tier(tier);
    const int place = least_violated(yielding);
    if (place < 0 || (yielding == tier && !(violations_mps_[place] < violation_mps))) return;
    rows_[place] = {row, bound, tier, other_bound};
    violations_mps_[place] = violation_mps;
    --count_[index(yielding)];
    ++count_[index(tier)];
    least_violated_[index(tier)] = least_violated_[index(yielding)] = -1;
  }

 private:
  static size_t index(Tier tier) { return static_cast<size_t>(tier); }

  /// The tier that gives a place in the full list to a row of `tier`: the last one that has more than are reserved for
  /// it. The tiers before `tier` give it only what is reserved for it.
  Tier yielding_tier(Tier tier) const {
    const bool is_reserved = count_[index(tier)] < reserved_[index(tier)];
    for (const Tier other : {Tier::kComfort, Tier::kPass, Tier::kHard})
      if ((is_reserved || other > tier) && count_[index(other)] > reserved_[index(other)]) return other;
    return tier;
  }
  /// Index of the tier's row with the least violation; -1 if the tier has none.
  int least_violated(Tier tier) {
    int& least = least_violated_[index(tier)];
    if (least >= 0) return least;
    for (int i = 0; i < rows_.size(); ++i)
      if (rows_[i].tier == tier && (least < 0 || violations_mps_[i] < violations_mps_[least])) least = i;
    return least;
  }

  ConstraintRows& rows_;
  const Places& reserved_;
  BoundedList<double, kMaxRows> violations_mps_;
  std::array<int, kTiers> count_{};                     ///< of each tier
  std::array<int, kTiers> least_violated_{-1, -1, -1};  ///< least_violated(); -1: not known
};

/// Distance barrier of one tier: d' >= -gain (d - clearance).
double barrier(double gain_per_s, double distance_m, double clearance_m) {
  return -gain_per_s * (distance_m - clearance_m);
}

/// Deceleration along a row when all joints brake at their limits, m/s2.
double braking_mps2(const JointVector& row, const JointLimits& limits) {
  double sum_mps2 = 0.0;
  for (Eigen::Index i = 0; i < row.size(); ++i)
    sum_mps2 += std::abs(row.coeff(i)) * limits.acceleration_radps2.coeff(i);
  return sum_mps2;
}

/// Bound of a hard row, m/s. The barrier by the gain alone may demand more deceleration than the joints have, so the
/// arm's own approach is also limited to the speed that it can brake within room_m, one period of travel included.
/// room_m: distance less the hard clearance. closing_mps: the obstacle's part of the approach.
double hard_barrier(const ShieldSettings& settings, const ShieldInput& input, const JointVector& row, double room_m,
                    double closing_mps) {
  const double by_gain_mps = closing_mps - settings.hard_gain_per_s * room_m;
  if (room_m <= 0.0) return by_gain_mps;
  const double share = 0.5;  // the rest remains for other rows
  const double braked_mps = stopping_velocity(room_m, share * braking_mps2(row, input.arm.limits), input.period_s);
  return std::max(by_gain_mps, std::min(closing_mps, 0.0) - braked_mps);
}

/// The speed at which an obstacle's point approaches along a normal, m/s, with the lead only if that adds to it.
/// velocity_mps: of the point, with the lead. An obstacle that is about to recede makes no room yet: the arm would
/// follow it faster than it leaves.
double certain_approach_mps(const Obstacle& obstacle, const Vector3& normal, const Vector3& velocity_mps) {
  return normal.dot(velocity_mps) + std::max(0.0, -normal.dot(obstacle.lead_mps));
}

/// The room of two links. A posture that is nearer than the clearance may come no nearer, but it need not retreat
/// unless it is nearer than half of it.
double self_room_m(double distance_m, double clearance_m) {
  return std::max(distance_m - clearance_m, std::min(distance_m - 0.5 * clearance_m, 0.0));
}

/// Computes the rows of one cycle.
class RowMaker {
 public:
  RowMaker(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
           const VelocityRange& range, RowSets& rows)
      : settings_(settings),
        input_(input),
        axes_(input.poses),
        following_error_rad_(input.commanded_rad - input.position_rad),
        braking_s_(stopping_time_s(input.arm.limits, input.last_velocity_radps)),
        sustainable_(sustainable),
        range_(range),
        within_(is_within(range, sustainable)),
        rows_(rows),
        plan_(rows.plan, keeps_separation(input) ? kReservedBesidePersons : kNoneReserved),
        step_(rows.step, kNoneReserved) {}

  void add_self(const SelfPair& self, const JointVector& nominal_radps) {
    const BodyShape &a = shape(self.first), &b = shape(self.second);
    const PosedShape first{a, input_.poses, input_.clearance.links[self.first]};
    const PosedShape second{b, input_.poses, input_.clearance.links[self.second]};
    const Proximity pair = measure_pair(first, second);
    const JointVector row = row_of_links(a, b, pair);
    const Vector3 closing_mps = other_velocity(b, pair.on_obstacle) - other_velocity(a, pair.on_arm);
    const double bound_mps = add_links(row, pair.distance_m, self.clearance_m, pair.normal.dot(closing_mps));
    add_turning(self, pair, first, second);
    rows_.links_limit |= row.dot(nominal_radps) < bound_mps - kViolated_mps;
    const double room_m = pair.distance_m - self.clearance_m;
    if (!(room_m < least_room_m_)) return;
    least_room_m_ = room_m;
    rows_.nearest_links = {self.first, self.second, pair.distance_m};
  }

  void add_distance(const NearPair& pair) {
    const double distance_m = pair.now.distance_m;
    const bool separates = keeps_separation(input_, pair);
    if (distance_m > settings_.range_m && !separates) return;
    const JointVector row = axes_.row(body_of(pair), pair.now.on_arm, pair.now.normal);
    const double least = least_mps(row, sustainable_);
    const double approaching_mps = pair.now.normal.dot(pair.velocity_mps);
    if (separates) add_separation(row, least, approaching_mps, distance_m);
    if (distance_m > settings_.range_m) return;

    // An obstacle that will pass clear of the link counts with a share of its speed only (constraint_rows.h).
    const double passing = std::clamp((pair.approach.distance_m - settings_.hard_clearance_m) /
                                          (settings_.pass_clearance_m - settings_.hard_clearance_m),
                                      0.0, 1.0);
    const Obstacle& obstacle = input_.obstacles.at(pair.now.obstacle);
    const double certain_mps = certain_approach_mps(obstacle, pair.now.normal, pair.velocity_mps);
    const double threat_mps = certain_mps > 0.0 ? (1.0 - passing) * certain_mps : certain_mps;
    const double room = room_m(row, distance_m, pair);
    add_hard(row, least, room, threat_mps);
    const double to_person_m = separates ? room - kBesidePerson_m : room;
    if (is_person(input_, pair) && to_person_m < kNearPerson_m) add_no_approach(row, least, to_person_m);
    if (input_.comfort_weight == 0.0 || separates) return;
    const double comfort_mps = barrier(settings_.comfort_gain_per_s, distance_m, settings_.comfort_clearance_m);
    add_plan(row, least, approaching_mps + comfort_mps, Tier::kComfort);
  }

  void add_turning(const NearPair& pair) {
    const Obstacle& reported = input_.obstacles.at(pair.now.obstacle);
    if (reported.capsule.is_sphere()) return;
    const Vector3 turn_rad = braking_s_ * (angular_velocity(body_of(pair)) - reported.angular_velocity_radps);
    if (turn_rad.norm() < kLeastTurn_rad) return;
    const PosedShape link{shape(pair.now.shape), input_.poses, input_.clearance.links[pair.now.shape]};
    const Obstacle present = input_.obstacles.extrapolated(pair.now.obstacle);
    for (const Proximity& next : proximities_after_turn(link, present, pair.now, turn_rad)) {
      if (next.distance_m > settings_.range_m) continue;
      const JointVector row = axes_.row(body_of(pair), next.on_arm, next.normal);
      const double approaching_mps = certain_approach_mps(present, next.normal, velocity_at(present, next.on_obstacle));
      add_hard(row, least_mps(row, sustainable_), room_m(row, next.distance_m, pair), std::min(approaching_mps, 0.0));
    }
  }

  void add_pass(const NearPair& pair) {
    const ClosestApproach& approach = pair.approach;
    if (approach.time_s <= 0.0 || !approach_counts(input_, pair)) return;
    const Vector3 side = approach.head_on ? chosen_side(pair) : approach.normal;
    const JointVector row = axes_.row(body_of(pair), approach.on_arm, side);
    const double least = least_mps(row, sustainable_);
    const double deficit_m = settings_.pass_clearance_m - approach.distance_m;
    if (deficit_m <= 0.0) {
      const double pass_mps = barrier(settings_.pass_gain_per_s, approach.distance_m, settings_.pass_clearance_m);
      add_plan(row, least, pass_mps, Tier::kPass);
      return;
    }
    // The arm needs pass_reaction_s to start moving; the rest of the time remains for the evasion.
    const double time_s = std::max(approach.time_s - settings_.pass_reaction_s, kShortestPass_s);
    const bool two_sides = approach.axis_distance_m < kTwoSides_m;
    const double other_m = two_sides ? deficit_m + 2.0 * approach.axis_distance_m : 0.0;
    add_plan(row, least, deficit_m / time_s, Tier::kPass, other_m / time_s);
  }

 private:
  /// In place of comfort for a person (constraint_rows.h). least: the least value of the row, m/s.
  void add_separation(const JointVector& row, double least, double approaching_mps, double distance_m) {
    const double largest_mps = most_mps(row, sustainable_);
    if (largest_mps < kLeastSpeed_mps) return;
    const double demand_mps = std::min(approaching_mps, kLargestApproach_mps) +
                              barrier(settings_.person_gain_per_s, distance_m, settings_.person_clearance_m);
    const double touched_mps = settings_.person_gain_per_s * settings_.person_clearance_m;
    const double bound_mps = std::min(demand_mps * std::min(1.0, largest_mps / touched_mps), largest_mps);
    const double scale = std::sqrt(input_.person_weight / input_.comfort_weight);
    if (!(bound_mps > least)) return;
    const JointVector scaled = scale * row;
    plan_.add(scaled, scale * bound_mps, Tier::kComfort, scale * bound_mps - least_mps(scaled, sustainable_));
  }

  /// Two links of which one turns past the other.
  void add_turning(const SelfPair& self, const Proximity& pair, const PosedShape& first, const PosedShape& second) {
    if (pair.distance_m > self.clearance_m + kNearLinks_m) return;
    const int a = first.shape.body, b = second.shape.body;
    const Vector3 turn_rad = braking_s_ * (angular_velocity(a) - angular_velocity(b));
    if (turn_rad.norm() < kLeastTurn_rad) return;
    for (const Proximity& next : proximities_after_turn(first, second, pair, turn_rad)) {
      const JointVector row = row_of_links(first.shape, second.shape, next);
      add_links(row, next.distance_m, self.clearance_m, 0.0);
    }
  }

  /// Of the distance between two links.
  JointVector row_of_links(const BodyShape& a, const BodyShape& b, const Proximity& pair) const {
    JointVector row = axes_.row(a.body, pair.on_arm, pair.normal);
    row -= axes_.row(b.body, pair.on_obstacle, pair.normal);
    return row;
  }
  /// The part of the following error that closes a pair, m: how much nearer it comes until the arm has reached its last
  /// command. An arm that is at rest beside its command stays there.
  double lag_m(const JointVector& row) const {
    const double closing_mps = std::max(0.0, -row.dot(input_.last_velocity_radps));
    return std::clamp(-row.dot(following_error_rad_), 0.0, kLongestLag_s * closing_mps);
  }
  const BodyShape& shape(int index) const { return shape_at(input_.arm, input_.poses, index); }

  /// Of a body, by the last commanded velocity, rad/s.
  Vector3 angular_velocity(int body) const {
    Vector3 sum_radps = Vector3::Zero();
    for (int i = 0; i < body; ++i)
      if (!input_.arm.prismatic[i]) sum_radps += input_.last_velocity_radps[i] * input_.poses.rotation[i + 1].col(2);
    return sum_radps;
  }

  /// Velocity of a point of a shape by the joints outside the chain, m/s.
  Vector3 other_velocity(const BodyShape& shape, const Vector3& point) const {
    if (shape.other_joint < 0) return Vector3::Zero();
    return other_velocity_at(input_.arm, input_.poses, shape.other_joint, point);
  }
  /// Where the full clearance is needed in any case, the speed of the link need not be known.
  double required_m(const NearPair& pair) {
    const double obstacle_doubt = doubt(input_.obstacles, pair.now.obstacle);
    return hard_clearance_m(settings_, obstacle_doubt, obstacle_doubt < 1.0 ? link_speed_mps(pair.now.shape) : 0.0);
  }
  /// What is left of a pair's distance above the required clearance, m.
  double room_m(const JointVector& row, double distance_m, const NearPair& pair) {
    return distance_m - lag_m(row) - required_m(pair);
  }
  /// Of the fastest point of a link shape's axis, by the last commanded velocity, m/s.
  double link_speed_mps(int s) {
    const auto index = static_cast<size_t>(s);
    if (!knows_speed_[index]) {
      const Capsule& link = input_.clearance.links[s];
      const int body = shape(s).body;
      speed_mps_[index] = std::max(velocity_of(body, link.start).norm(), velocity_of(body, link.end).norm());
      knows_speed_[index] = true;
    }
    return speed_mps_[index];
  }
  /// Of a body's point, by the last commanded velocity, m/s.
  Vector3 velocity_of(int body, const Vector3& p_base) const {
    return point_velocity(input_.poses, body, p_base, input_.last_velocity_radps);
  }
  int body_of(const NearPair& pair) const { return shape(pair.now.shape).body; }

  /// `least`: the least value of the row within sustainable_, m/s. weight: of the row among those that share the slack.
  /// Returns the bound.
  double add_hard(const JointVector& row, double least, double room_m, double closing_mps, double weight = 1.0) {
    const double bound_mps = std::min(hard_barrier(settings_, input_, row, room_m, closing_mps), kLargestDemand_mps);
    add_to_both(row, least, bound_mps, bound_mps, weight);
    return bound_mps;
  }
  /// Hard row of a near person, which only keeps the arm from approaching by itself.
  void add_no_approach(const JointVector& row, double least, double room_m) {
    const double bound_mps = std::min(hard_barrier(settings_, input_, row, room_m, 0.0), 0.0);
    add_to_both(row, least, bound_mps, std::min(bound_mps, most_mps(row, range_)), kPersonsWeight);
  }
  /// The bounds of the row in the two programmes, m/s. Rows that every velocity meets are skipped.
  void add_to_both(const JointVector& row, double least, double plan_mps, double step_mps, double weight) {
    const bool counts = plan_mps > least;
    if (counts) plan_.add(weight * row, weight * plan_mps, Tier::kHard, plan_mps - least);
    if (within_ && !counts) return;
    const double violation_mps = step_mps - least_mps(row, range_);
    if (violation_mps > 0.0) step_.add(weight * row, weight * step_mps, Tier::kHard, violation_mps);
  }
  /// Hard row of two links. Returns the bound.
  double add_links(const JointVector& row, double distance_m, double clearance_m, double closing_mps) {
    const double room_m = self_room_m(distance_m - lag_m(row), clearance_m);
    return add_hard(row, least_mps(row, sustainable_), room_m, closing_mps, kLinksWeight);
  }
  void add_plan(const JointVector& row, double least, double bound_mps, Tier tier, double other_bound_mps = 0.0) {
    bound_mps = std::min(bound_mps, kLargestDemand_mps);
    if (bound_mps > least) plan_.add(row, bound_mps, tier, bound_mps - least, other_bound_mps);
  }

  /// The direction in which a link leaves the path of an obstacle that comes straight at it: the one in which it is
  /// already moving.
  Vector3 chosen_side(const NearPair& pair) const {
    const double decisive_mps = 0.02;
    const ClosestApproach& approach = pair.approach;
    const Vector3 drift =
        velocity_of(body_of(pair), approach.on_arm) + decisive_mps * pair.velocity_mps.unitOrthogonal();
    return drift.dot(approach.normal) < 0.0 ? Vector3(-approach.normal) : approach.normal;
  }

  const ShieldSettings& settings_;
  const ShieldInput& input_;
  const JointAxes axes_;
  const JointVector following_error_rad_;  ///< commanded - measured position
  const double braking_s_;
  const VelocityRange& sustainable_;
  const VelocityRange& range_;
  const bool within_;  ///< range_ lies in sustainable_: then the least value of a row is no smaller there
  std::array<double, kMaxShapes> speed_mps_;  ///< link_speed_mps() where knows_speed_
  std::bitset<kMaxShapes> knows_speed_;
  RowSets& rows_;
  RowFiller plan_, step_;
  double least_room_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace

double largest_pass_mps(const ConstraintRows& rows) {
  double largest_mps = 0.0;
  for (const ConstraintRow& row : rows)
    if (row.tier == Tier::kPass) largest_mps = std::max(largest_mps, row.bound);
  return largest_mps;
}

RowSets make_rows(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
                  const VelocityRange& range, const JointVector& nominal_radps) {
  RowSets rows;
  RowMaker maker(settings, input, sustainable, range, rows);
  for (const SelfPair& pair : input.self_pairs) maker.add_self(pair, nominal_radps);
  if (const Attachments* attachments = input.poses.others->attachments)
    for_each_held_pair(input.arm, *attachments, [&](const SelfPair& pair) { maker.add_self(pair, nominal_radps); });
  for (const NearPair& pair : input.clearance.near) {
    maker.add_distance(pair);
    maker.add_turning(pair);
    maker.add_pass(pair);
  }
  return rows;
}

}  // namespace sidestep
