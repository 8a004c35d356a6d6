#pragma once

#include "firmware/control/shield/shield.h"

namespace sidestep {

/// Tiers of constraint rows.
///
/// Notation, for a link and an obstacle: d is their surface distance, n the unit normal from the obstacle to the link,
/// a = n^T J_p with the Jacobian J_p of the link's nearest point, v = n^T (velocity of the obstacle's nearest point)
/// the speed at which the obstacle approaches. Then d' = a q' - v. m is the least distance predicted for the next
/// pass_horizon at constant velocity, t its time. Gains and clearances are those of ShieldSettings.
///
/// hard: with r = d - e - c, c the clearance that the obstacle needs (required_clearance.h) and e the part of the
/// following error that closes the pair, b is the larger of b1 and b2:
///     b1 = k v - hard_gain r            the clearance decays at most exponentially
///     b2 = min(k v, 0) - v_stop(r)      the arm can stop within r; only for r > 0. The speed of an approaching
///                                       obstacle does not count here, that of a receding one does
///   v is at least what it would be without the lead (Obstacle::lead_mps): an obstacle that is expected to recede is
///   not followed before it does.
///   k is the counted share of the obstacle's speed. For a receding obstacle k = 1. For an approaching one k falls
///   linearly from 1 to 0 while m rises from hard_clearance to pass_clearance: an obstacle that will pass is no threat.
///   v_stop(r) is the largest speed that can be braked within r, one period of travel included, at the deceleration
///   1/2 sum over joints j of |a_j| * acceleration limit_j. The other half is left for other rows.
///   e = -a (commanded - measured position), within 0 and 0.1 s times the closing speed at the last commanded velocity:
///   the pair comes nearer by e until the arm has reached its last command, unless the arm rests beside it.
///   For a pair of links with the clearance c, r = d - e - c; 0 if d - e is from c / 2 to c, and d - e - c / 2 below;
///   k = 1, and v is the speed at which joints outside the chain (another arm, a lift) bring the two together. Row and
///   b are multiplied by 512: where an obstacle's approach cannot be met and the slack is shared, links yield by 1/512
///   of the speed by which obstacles do. A pair of links has about 1 mm of clearance, an obstacle 20 mm. Of the 3 m/s
///   that an obstacle may demand links then yield 6 mm/s, which hard_gain stops 0.4 mm below c / 2.
///   A person with r < 0.05 m has a second hard row, b = min(b1, b2, 0) with v = 0, and row and b are multiplied by 64:
///   where another limb cannot be met, the arm does not evade it into this one, and it does not follow one that
///   recedes. While the arm keeps separation, r is 0.1 m less in this row: a hand that rests there may stroke at any
///   time. In RowSets::step b is at most max a q' over the range: what an arm that brakes cannot do at once would
///   otherwise be slack, and the rows of links would yield by 64/512 of its speed.
///   A link and a box or capsule that turn against each other have up to two more hard rows, for the points at which
///   they will be nearest after the time that the arm takes to stop (model/turning_proximity.h); an approaching
///   obstacle's speed does not count in these. So have two links whose distance is less than 30 mm above c.
/// pass: for an approaching obstacle; n, J_p and a are those at the time t.
///     b = (pass_clearance - m) / max(t - pass_reaction, 0.05 s)    if m < pass_clearance
///     b = -pass_gain (m - pass_clearance)                          otherwise
///   There is none for a person from whom the arm keeps separation while t > 0.3 s (approach_counts()).
/// comfort:
///     b = v - comfort_gain (d - comfort_clearance)
/// separation, in place of comfort for a person in TRACK; with the largest speed a_max = max a q' over the range:
///     b = min((min(v, 1 m/s) - person_gain (d - person_clearance)) min(1, a_max / v_0), a_max)
///   v_0 = person_gain person_clearance is the demand at the touch of a person at rest. Slower links are asked for the
///   same share of what they can do: a link that can hardly leave would otherwise use up the shared slack, and the
///   others would not move either. The row and b are multiplied by sqrt(person_weight / comfort_weight), so that
///   person_weight takes the place of the weight of the tier.
///
/// Every other b is capped at 3 m/s: penetration or a short time would demand more than any arm can do.
enum class Tier { kHard, kPass, kComfort };
constexpr int kTiers = 3;

/// One row of the programme: row . q' >= bound.
struct ConstraintRow {
  JointVector row;  ///< a_i as a column, n x 1, m
  double bound;     ///< b_i, m/s
  Tier tier;
  /// A pass row is two-sided if its obstacle can be passed on either side (ClosestApproach::head_on). For the other
  /// side the row is -row, and this is its bound, m/s. 0: the row is not two-sided.
  double other_bound = 0.0;
};

constexpr int kMaxRows = 56;

/// The rows that some velocity within the range violates. If there are more than kMaxRows, a hard row is kept before a
/// pass row, a pass row before a comfort row, and within a tier those with the largest b - min (a q') over the range.
/// While the arm keeps separation from a person near it, 24 places of the plan are reserved for hard rows, 16 for pass
/// rows and 16 for comfort rows; that order applies to the places that a tier leaves free.
using ConstraintRows = BoundedList<ConstraintRow, kMaxRows>;

/// The largest bound of the pass rows, m/s; 0 if none is positive.
double largest_pass_mps(const ConstraintRows& rows);

/// The rows of the two programmes of a cycle, and what was found on the way.
struct RowSets {
  ConstraintRows plan;  ///< all tiers, within the sustainable range
  ConstraintRows step;  ///< the hard tier, within the range of the coming period
  NearestLinks nearest_links;
  bool links_limit = false;  ///< the nominal velocity violates the hard row of a pair of links
};

/// The rows of all near pairs (clearance.near) and self pairs. nominal_radps: n x 1, decides links_limit alone.
RowSets make_rows(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
                  const VelocityRange& range, const JointVector& nominal_radps);

}  // namespace sidestep
