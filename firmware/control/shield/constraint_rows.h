#pragma once

#include "firmware/control/shield/shield.h"

namespace sidestep {

enum class Tier { kHard, kPass, kComfort };
constexpr int kTiers = 3;

/// One linear condition on the joint velocity: row . q' >= bound.
struct ConstraintRow {
  JointVector row;  ///< m
  double bound;     ///< m/s
  Tier tier;
  double other_bound = 0.0;  ///< pass: of -row, to leave the way to the other side; 0: there is no other side
};

constexpr int kMaxRows = 56;

/// The rows that can matter within the range of velocities; where there are too many, the most pressing.
using ConstraintRows = BoundedList<ConstraintRow, kMaxRows>;

/// What the shield asks twice in a cycle.
struct RowSets {
  ConstraintRows plan;  ///< all tiers, for the velocity that the arm shall come to
  ConstraintRows step;  ///< the hard tier alone, for the step toward it
};

/// The rows of all near pairs: those that can matter within `lasting`, and within `range`.
RowSets make_rows(const ShieldSettings& settings, const ShieldInput& now, const VelocityRange& sustainable,
                  const VelocityRange& range);

}  // namespace sidestep
