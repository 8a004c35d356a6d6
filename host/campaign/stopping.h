#pragma once

#include <cmath>

namespace sidestep::campaign {

/// Largest velocity from which a joint can still stop within gap_rad (0 or more) if it goes on for delay_s and then
/// brakes with its acceleration limit, rad/s.
inline double stoppable_radps(double gap_rad, double acceleration_radps2, double delay_s) {
  const double step_radps = acceleration_radps2 * delay_s;
  return std::sqrt(step_radps * step_radps + 2.0 * acceleration_radps2 * gap_rad) - step_radps;
}

}  // namespace sidestep::campaign
