#pragma once

#include "firmware/control/types/settings.h"
#include "firmware/model/damped_inverse.h"

namespace sidestep {

/// The two inverses of one m x n task Jacobian that the paper uses, m = 3 or 6.
struct TaskInverse {
  TaskJacobian damped_transposed;  ///< m x n: J*^T, paper eq (5); J* x = damped_transposed^T x
  JointMatrix null_space;  ///< n x n projector I - J+ J with the exact, truncated inverse (docs/paper.md, item 6)
  double lambda;           ///< damping, paper eq (6)

  JointVector operator*(const TaskVector& task_velocity) const { return damped_transposed.transpose() * task_velocity; }
};

TaskInverse invert(const PaperGains& gains, const TaskJacobian& jacobian);

}  // namespace sidestep
