#include "firmware/control/guided_law.h"

#include <algorithm>

#include "firmware/control/posture_law.h"
#include "firmware/control/sidestep_law.h"

namespace sidestep {

namespace {

constexpr double kFollows_rad = 0.05;
constexpr double kLeft_rad = 0.2;
constexpr double kLeastRate = 0.1;

}  // namespace

double guide_time_s(const Arm& arm, const Guide& guide, const JointVector& position_rad, double now_s, double period_s,
                    double step_s, GuideProgress& progress) {
  if (progress.start_s != guide.time_s[0]) progress = {guide.time_s[0], 0.0};
  const JointVector deviation_rad = point_of(guide, now_s - progress.delay_s).position_rad - position_rad;
  const double largest_rad = max_norm(deviation_rad, arm.joint_scale);
  const double rate = std::clamp((kLeft_rad - largest_rad) / (kLeft_rad - kFollows_rad), kLeastRate, 1.0);
  progress.delay_s += period_s - rate * step_s;
  return now_s - progress.delay_s;
}

NominalCommand guided_law(const SidestepGains& gains, const LawInput& input, const Guide& guide, double time_s) {
  const GuidePoint point = point_of(guide, time_s);
  const JointVector feedback_radps = gains.k_guide_per_s * (point.position_rad - input.position_rad);
  if (time_s >= guide.end_s() && !guide.is_retreat()) {
    if (input.target.is_posture()) return posture_law(gains, input);
    const JointVector fastest = gains.guide_posture_share * input.arm.limits.velocity_radps;
    return sidestep_law(gains, input, feedback_radps.cwiseMax(-fastest).cwiseMin(fastest));
  }
  NominalCommand nominal{point.velocity_radps + feedback_radps};
  nominal.tool_velocity_mps = input.tool_jacobian.topRows<3>() * nominal.velocity_radps;
  return nominal;
}

}  // namespace sidestep
