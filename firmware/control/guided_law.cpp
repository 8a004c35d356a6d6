#include "firmware/control/guided_law.h"

#include "firmware/control/sidestep_law.h"

namespace sidestep {

NominalCommand guided_law(const SidestepGains& gains, const Situation& now, const Guide& guide, double now_s) {
  const GuidePoint point = point_of(guide, now_s);
  const JointVector back_radps = gains.k_guide_per_s * (point.position_rad - now.position_rad);
  if (now_s >= guide.end_s() && guide.foresight_status != ForesightStatus::kWaiting) {
    const JointVector fastest = gains.guide_posture_share * now.arm.limits.velocity_radps;
    return sidestep_law(gains, now, back_radps.cwiseMax(-fastest).cwiseMin(fastest));
  }
  NominalCommand wish{point.velocity_radps + back_radps};
  wish.tool_velocity_mps = now.tool_jacobian.topRows<3>() * wish.velocity_radps;
  return wish;
}

}  // namespace sidestep
