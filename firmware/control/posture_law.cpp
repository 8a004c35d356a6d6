#include "firmware/control/posture_law.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr double kBrakingShare = 0.9;  // of the acceleration limit; the rest is left to the shield

/// The largest speed of a joint at this distance; its deceleration on the way is at most a.
double approach_speed(double distance_rad, double k_per_s, double a_radps2) {
  const double linear_rad = a_radps2 / (k_per_s * k_per_s);
  if (distance_rad <= linear_rad) return k_per_s * distance_rad;
  return std::sqrt(a_radps2 * (2.0 * distance_rad - linear_rad));
}

}  // namespace

NominalCommand posture_law(const SidestepGains& gains, const LawInput& input) {
  const JointLimits& limits = input.arm.limits;
  const JointVector left_rad = input.target.posture_rad - input.position_rad;
  double per_s = gains.k_pos_per_s;  // one rate for all joints keeps the line straight
  for (Eigen::Index i = 0; i < left_rad.size(); ++i) {
    const double distance_rad = std::abs(left_rad[i]);
    if (distance_rad == 0.0) continue;
    const double speed_radps =
        approach_speed(distance_rad, gains.k_pos_per_s, kBrakingShare * limits.acceleration_radps2[i]);
    per_s = std::min(per_s, std::min(speed_radps, limits.velocity_radps[i]) / distance_rad);
  }
  NominalCommand nominal{per_s * left_rad};
  nominal.tool_velocity_mps = input.tool_jacobian.topRows<3>() * nominal.velocity_radps;
  const double tool_mps = nominal.tool_velocity_mps.norm();
  nominal.task_speed_limited = tool_mps > gains.v_max_mps;
  if (!nominal.task_speed_limited) return nominal;
  nominal.velocity_radps *= gains.v_max_mps / tool_mps;
  nominal.tool_velocity_mps *= gains.v_max_mps / tool_mps;
  return nominal;
}

}  // namespace sidestep
