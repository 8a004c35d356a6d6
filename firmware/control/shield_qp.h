#pragma once

#include "firmware/control/shield_rows.h"

namespace sidestep {

/// What "nearest to the wish" means: |q' - wish|^2 + tool_weight |J (q' - wish)|^2.
struct Nearness {
  const JointVector& wish_radps;
  const TaskJacobian& tool_jacobian;
  double tool_weight;     ///< 1/m2
  double comfort_weight;  ///< of the comfort rows against nearness, s2/m2
};

struct QpSolution {
  JointVector velocity_radps;
  double cost = 0.0;      ///< half the nearness, and what was given up of the rows
  double loss_mps = 0.0;  ///< by how much the worst hard row had to be given up
};

/// The velocity in range nearest to the wish that meets the rows. Always feasible: a tier's rows are given up together,
/// as little as possible, comfort before pass before hard; of the hard rows the worst first, so that the others do not
/// suffer for it. Bounded iterations; should the solver fail, the wish clipped into the range.
QpSolution solve(const ShieldRows& rows, const VelocityRange& range, const Nearness& nearness);

}  // namespace sidestep
