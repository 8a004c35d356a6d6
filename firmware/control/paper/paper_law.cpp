#include "firmware/control/paper/paper_law.h"

#include "firmware/control/paper/attraction.h"
#include "firmware/control/paper/damped_inverse.h"
#include "firmware/control/paper/repulsion.h"
#include "firmware/control/paper/speed_deviation.h"

namespace sidestep {

NominalCommand paper_law(const PaperGains& gains, double period_s, const Situation& now, const Vector3* planned_mps) {
  const TaskJacobian& jacobian = now.tool_jacobian;
  const Vector3 v_tool = jacobian.topRows<3>() * now.velocity_radps;
  const Vector3& p_tool = now.poses.tool_position;

  // Force to velocity: unit mass, X = V + F T (paper-notes, "Force to velocity" and item 4).
  NominalCommand wish;
  const Vector3 force = attraction(gains, now.target, p_tool, v_tool) + repulsion(gains, now.obstacles, p_tool, v_tool);
  const bool planned = gains.tool_velocity == ToolVelocity::kPlanned && planned_mps;
  wish.tool_velocity_mps = (planned ? *planned_mps : v_tool) + force * period_s;
  const double speed_mps = wish.tool_velocity_mps.norm();
  wish.task_speed_limited = speed_mps > gains.v_max_mps;
  if (wish.task_speed_limited) wish.tool_velocity_mps *= gains.v_max_mps / speed_mps;

  TaskVector x(jacobian.rows());
  x.head<3>() = wish.tool_velocity_mps;
  if (now.target.tracks_orientation) x.tail<3>() = orientation_rate(gains, now.target, now.poses.tool_rotation);

  const TaskInverse inverse = invert(gains, jacobian);
  wish.damping = inverse.lambda;
  wish.velocity_radps = inverse * x;

  const Proximity& nearest = now.clearance.nearest_axis;
  if (nearest.shape < 0) return wish;
  wish.beta = task_priority(gains, nearest.axis_distance_m);
  wish.velocity_radps = (1.0 - wish.beta) * wish.velocity_radps +  // eq (18)
                        speed_deviation(gains, now.arm, now.poses, nearest, inverse, wish.velocity_radps);
  return wish;
}

}  // namespace sidestep
