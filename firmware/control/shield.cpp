#include "firmware/control/shield.h"

#include "firmware/control/evasion.h"

namespace sidestep {

Shielded shield(const ShieldSettings& settings, const Surroundings& now, const VelocityRange& lasting,
                const VelocityRange& range, const TaskJacobian& tool_jacobian, const JointVector& wish_radps) {
  const RowSets rows = make_rows(settings, now, lasting, range);
  const Nearness to_wish{wish_radps, tool_jacobian, settings.tool_weight, now.comfort_weight};
  const QpSolution first = solve(rows.plan, lasting, to_wish);
  const Evasion plan = evade(settings, now, rows.plan, lasting, to_wish, first.velocity_radps);

  const Nearness to_plan{plan.velocity_radps, tool_jacobian, 0.0, now.comfort_weight};
  const QpSolution safe = solve(rows.step, range, to_plan);
  return {safe.velocity_radps, safe.loss_mps, plan};
}

}  // namespace sidestep
