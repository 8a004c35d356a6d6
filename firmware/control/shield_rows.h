#pragma once

#include <array>

#include "firmware/control/shield.h"

namespace sidestep {

enum class Tier { kHard, kPass, kComfort };
constexpr int kTiers = 3;

/// One linear condition on the joint velocity: row . q' >= bound.
struct ShieldRow {
  JointVector row;  ///< m
  double bound;     ///< m/s
  Tier tier;
  double other_bound = 0.0;  ///< pass: of -row, to leave the way to the other side; 0: there is no other side
};

constexpr int kMaxRows = 56;

/// The rows that can matter within the range of velocities; where there are too many, the most pressing.
struct ShieldRows {
  int count = 0;
  std::array<ShieldRow, kMaxRows> rows;
};

/// The rows of all near pairs. Which tiers: hard only, or all.
ShieldRows make_rows(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& range,
                     bool hard_only);

}  // namespace sidestep
