#include "firmware/control/shield/shield.h"

#include "firmware/control/shield/evasion.h"

namespace sidestep {

Shielded shield(const ShieldSettings& settings, const ShieldInput& now, const VelocityRange& sustainable,
                const VelocityRange& range, const TaskJacobian& tool_jacobian, const JointVector& nominal_radps) {
  const RowSets rows = make_rows(settings, now, sustainable, range);
  const QpObjective to_nominal{nominal_radps, tool_jacobian, settings.tool_weight, now.comfort_weight};
  const QpSolution first = solve(rows.plan, sustainable, to_nominal);
  const Evasion plan = evade(settings, now, rows.plan, sustainable, to_nominal, first.velocity_radps);

  const QpObjective to_plan{plan.velocity_radps, tool_jacobian, 0.0, now.comfort_weight};
  const QpSolution safe = solve(rows.step, range, to_plan);
  return {safe.velocity_radps, safe.hard_slack_mps, plan};
}

}  // namespace sidestep
