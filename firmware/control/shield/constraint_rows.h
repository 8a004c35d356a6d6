#pragma once

#include "firmware/control/shield/shield.h"

namespace sidestep {

/// Tiers of constraint rows. d is a surface distance, d' its rate, all with the obstacle's own motion included.
///
///   hard     Distance barrier of every pair of a link with an obstacle or (self_clearance) with another link:
///              d' >= -hard_gain (d - hard_clearance), and the arm's own part of d' never faster than it can brake
///              within d - hard_clearance, at half of the joints' deceleration (the rest is left for other rows). Of an
///              approaching obstacle only a share counts: all of its speed where its closest approach would be at most
///              hard_clearance, none where it will pass at pass_clearance or farther.
///   pass     Closest approach of a moving obstacle within pass_horizon, at constant velocity: the link leaves the
///              obstacle's path sideways, so that their least distance becomes pass_clearance in the remaining time
///              (less pass_reaction, at least 0.05 s). Where it already exceeds pass_clearance: a barrier with
///              pass_gain.
///   comfort  d' >= -comfort_gain (d - comfort_clearance).
///
/// Demanded speeds are capped at 3 m/s: penetration or a short remaining time would demand more than any arm can do.
enum class Tier { kHard, kPass, kComfort };
constexpr int kTiers = 3;

/// One row of the programme: row . q' >= bound.
struct ConstraintRow {
  JointVector row;  ///< a_i, n x 1, m: rate of the distance over the joint velocities
  double bound;     ///< b_i, m/s
  Tier tier;
  double other_bound =
      0.0;  ///< pass: the bound for -row, to pass the obstacle on the other side, m/s; 0: no other side
};

constexpr int kMaxRows = 56;

/// The rows that some velocity within the range violates. Of more than kMaxRows rows those with the largest violation
/// by their worst velocity of the range are kept.
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
