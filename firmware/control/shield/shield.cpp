#include "firmware/control/shield/shield.h"

#include "firmware/control/shield/evasion.h"

namespace sidestep {

namespace {

/// A pass row that demands more is urgent: what it keeps away comes fast, or is near. Joints that made up for others
/// would evade it later: spheres at 2 m/s were passed 4 mm nearer in the mean.
constexpr double kUrgent_mps = 0.5;

}  // namespace

ShieldResult shield(const ShieldSettings& settings, const ShieldInput& input, const VelocityRange& sustainable,
                    const VelocityRange& range, const TaskJacobian& tool_jacobian, const JointVector& nominal_radps) {
  const RowSets rows = make_rows(settings, input, sustainable, range, nominal_radps);
  const JointVector* scale = input.arm.prismatic.any() ? &input.arm.joint_scale : nullptr;
  const QpObjective to_nominal{nominal_radps, tool_jacobian, input.tool_weight, input.comfort_weight, scale};
  const QpSolution nearest = solve(rows.plan, sustainable, to_nominal);
  const Plan plan = evade(settings, input, rows.plan, sustainable, to_nominal, nearest.velocity_radps);

  const bool clearance_first = plan.evading || rows.step.size() > 0 || largest_pass_mps(rows.plan) > kUrgent_mps;
  const double step_tool_weight = clearance_first ? 0.0 : input.step_tool_weight;
  const QpObjective to_plan{plan.velocity_radps, tool_jacobian, step_tool_weight, input.comfort_weight, scale};
  const QpSolution safe = solve(rows.step, range, to_plan);
  return {safe.velocity_radps, safe.hard_slack_mps, nearest.failed || safe.failed, plan,
          rows.nearest_links,  rows.links_limit};
}

}  // namespace sidestep
