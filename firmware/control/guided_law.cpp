#include "firmware/control/guided_law.h"

#include "firmware/control/sidestep_law.h"

namespace sidestep {

NominalCommand guided_law(const SidestepGains& gains, const LawInput& input, const Guide& guide, double now_s) {
  const GuidePoint point = point_of(guide, now_s);
  const JointVector feedback_radps = gains.k_guide_per_s * (point.position_rad - input.position_rad);
  if (now_s >= guide.end_s() && guide.foresight_status != ForesightStatus::kWaiting) {
    const JointVector fastest = gains.guide_posture_share * input.arm.limits.velocity_radps;
    return sidestep_law(gains, input, feedback_radps.cwiseMax(-fastest).cwiseMin(fastest));
  }
  NominalCommand nominal{point.velocity_radps + feedback_radps};
  nominal.tool_velocity_mps = input.tool_jacobian.topRows<3>() * nominal.velocity_radps;
  return nominal;
}

}  // namespace sidestep
