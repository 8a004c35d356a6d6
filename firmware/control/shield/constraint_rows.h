#pragma once

#include "firmware/control/shield/shield.h"

namespace sidestep {

/// Tiers of constraint rows. Notation: d surface distance of a pair, n unit normal from the obstacle to the link, a =
/// n^T J_p the row with J_p the Jacobian of the link's nearest point, v = n^T (velocity of the obstacle's nearest
/// point) its approach speed. So d' = a q' - v. Gains and clearances are those of ShieldSettings. All b are capped at 3
/// m/s, since penetration or a short time would demand more than any arm can do.
///
///   hard     b = max(k v - hard_gain r, min(k v, 0) - v_stop(r)) with r = d - hard_clearance; for r <= 0 only the
///   first.
///            k is 1 for a receding obstacle; for an approaching one it falls linearly from 1 to 0 as its predicted
///            least distance m rises from hard_clearance to pass_clearance. v_stop(r): the largest speed that can be
///            braked within r, one period of travel included, with the deceleration 1/2 sum |a_j| acceleration_limit_j
///            (the other half is left for other rows). Self pairs: r = d - self_clearance, v = 0.
///   pass     for a moving obstacle whose closest approach within pass_horizon is at time t with distance m, and a
///   taken
///            there: m < pass_clearance: b = (pass_clearance - m) / max(t - pass_reaction, 0.05 s);
///            else b = -pass_gain (m - pass_clearance).
///   comfort  b = v - comfort_gain (d - comfort_clearance)
enum class Tier { kHard, kPass, kComfort };
constexpr int kTiers = 3;

/// One row of the programme: row . q' >= bound.
struct ConstraintRow {
  JointVector row;  ///< a_i, n x 1, m: rate of the distance over the joint velocities
  double bound;     ///< b_i, m/s
  Tier tier;
  double other_bound = 0.0;  ///< pass: b for -row, which passes the obstacle on its other side, m/s; 0: none
};

constexpr int kMaxRows = 56;

/// The rows that some velocity within the range violates. Of more than kMaxRows rows, of whatever tier, those with the
/// largest b - min (a q') over the range are kept.
using ConstraintRows = BoundedList<ConstraintRow, kMaxRows>;

/// The rows of the two programmes of a cycle.
struct RowSets {
  ConstraintRows plan;  ///< all tiers, within the sustainable range
  ConstraintRows step;  ///< the hard tier, within the range of the coming period
};

/// The rows of all near pairs (clearance.near) and self pairs.
RowSets make_rows(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
                  const VelocityRange& range);

}  // namespace sidestep
