#include "firmware/control/paper/speed_deviation.h"

#include <algorithm>
#include <cmath>

namespace sidestep {

double deviation_share(const PaperGains& gains, double d_0_m) {
  if (d_0_m >= gains.d_m_m) return 0.0;
  return std::clamp(1.0 - std::sin(M_PI * d_0_m / (2.0 * gains.d_m_m)), 0.0, 1.0);
}

double task_priority(const PaperGains& gains, double d_0_m) {
  if (d_0_m < gains.d_2_m) return 1.0;
  if (d_0_m >= gains.d_1_m) return 0.0;
  return 1.0 - std::sin(M_PI * (d_0_m - gains.d_2_m) / (2.0 * (gains.d_1_m - gains.d_2_m)));
}

JointVector speed_deviation(const PaperGains& gains, const Arm& arm, const LinkPoses& poses, const Proximity& nearest,
                            const TaskInverse& inverse, const JointVector& task_velocity_radps) {
  const double beta = task_priority(gains, nearest.axis_distance_m);
  const PointJacobian j_0 = point_jacobian(poses, shape_at(arm, poses, nearest.shape).body, nearest.on_arm);
  const Vector3 x_0 = deviation_share(gains, nearest.axis_distance_m) * gains.x_m_mps * nearest.normal;
  const PointJacobian j_0_n = j_0.lazyProduct(inverse.null_space);
  return beta * damped_solve(j_0_n, gains.lambda_n, x_0 - j_0 * task_velocity_radps);
}

}  // namespace sidestep
