#include "firmware/control/paper/paper_law.h"

#include "firmware/control/paper/attraction.h"
#include "firmware/control/paper/damped_inverse.h"
#include "firmware/control/paper/repulsion.h"
#include "firmware/control/paper/speed_deviation.h"

namespace sidestep {

NominalCommand paper_law(const PaperGains& gains, double period_s, const LawInput& input,
                         const std::optional<Vector3>& planned_mps) {
  const TaskJacobian& jacobian = input.tool_jacobian;
  const Vector3 v_tool = jacobian.topRows<3>() * input.velocity_radps;
  const Vector3& p_tool = input.poses.tool_position;

  // Force to velocity: unit mass, X = V + F T (docs/paper.md, "Force to velocity" and item 4).
  NominalCommand nominal;
  const Vector3 force =
      attraction(gains, input.target, p_tool, v_tool) + repulsion(gains, input.obstacles, p_tool, v_tool);
  const bool planned = gains.tool_velocity == ToolVelocity::kPlanned && planned_mps;
  nominal.tool_velocity_mps = (planned ? *planned_mps : v_tool) + force * period_s;
  const double speed_mps = nominal.tool_velocity_mps.norm();
  nominal.task_speed_limited = speed_mps > gains.v_max_mps;
  if (nominal.task_speed_limited) nominal.tool_velocity_mps *= gains.v_max_mps / speed_mps;

  TaskVector x(jacobian.rows());
  x.head<3>() = nominal.tool_velocity_mps;
  if (input.target.tracks_orientation) x.tail<3>() = orientation_rate(gains, input.target, input.poses.tool_rotation);

  const TaskInverse inverse = invert(gains, jacobian);
  nominal.damping = inverse.lambda;
  nominal.velocity_radps = inverse * x;

  const Proximity& nearest = input.clearance.nearest_axis;
  if (nearest.shape < 0) return nominal;
  nominal.beta = task_priority(gains, nearest.axis_distance_m);
  nominal.velocity_radps = (1.0 - nominal.beta) * nominal.velocity_radps +  // eq (18)
                           speed_deviation(gains, input.arm, input.poses, nearest, inverse, nominal.velocity_radps);
  return nominal;
}

}  // namespace sidestep
