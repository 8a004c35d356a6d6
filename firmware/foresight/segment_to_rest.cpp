#include "firmware/foresight/segment_to_rest.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr double kLonger = 1.1;  // the factor by which a duration grows until it is long enough

/// Of a segment from rest to rest: 1.5 distance / duration is the largest velocity, and 6 distance / duration^2 the
/// largest acceleration.
double from_rest_to_rest_s(const JointLimits& limits, const JointVector& displacement_rad) {
  const JointVector distance_rad = displacement_rad.cwiseAbs();
  const double by_velocity_s = 1.5 * distance_rad.cwiseQuotient(limits.velocity_radps).maxCoeff();
  const double by_acceleration_s = std::sqrt(6.0 * distance_rad.cwiseQuotient(limits.acceleration_radps2).maxCoeff());
  return std::max(by_velocity_s, by_acceleration_s);
}

}  // namespace

double SegmentToRest::largest_velocity_radps() const {
  const double mean_radps = displacement_rad / duration_s;
  const double u = (4.0 * from_radps - 6.0 * mean_radps) / (6.0 * from_radps - 12.0 * mean_radps);
  const double at_start_radps = std::abs(from_radps);
  if (!(u > 0.0 && u < 1.0)) return at_start_radps;  // without acceleration in between
  const double extreme_radps = (1.0 - u) * (from_radps * (1.0 - 3.0 * u) + 6.0 * u * mean_radps);
  return std::max(at_start_radps, std::abs(extreme_radps));
}

double SegmentToRest::largest_acceleration_radps2() const {
  const double mean_radps = displacement_rad / duration_s;
  return std::max(std::abs(6.0 * mean_radps - 4.0 * from_radps), std::abs(2.0 * from_radps - 6.0 * mean_radps)) /
         duration_s;
}

double SegmentToRest::turning_rad() const {
  const double u = from_radps / (3.0 * from_radps - 6.0 * displacement_rad / duration_s);
  if (!(u > 0.0 && u < 1.0)) return 0.0;
  return displacement_rad * (u * u * (3.0 - 2.0 * u)) + from_radps * duration_s * u * (1.0 - u) * (1.0 - u);
}

double duration_to_rest_s(const JointLimits& limits, double share, const JointVector& displacement_rad,
                          const JointVector& from_radps) {
  const double at_rest_s = from_rest_to_rest_s(limits, displacement_rad) / share;
  if (from_radps.isZero(0.0)) return at_rest_s;
  const auto is_long_enough = [&](double duration_s) {
    for (Eigen::Index i = 0; i < displacement_rad.size(); ++i) {
      const SegmentToRest segment{displacement_rad[i], from_radps[i], duration_s};
      const double fastest_radps = std::max(share * limits.velocity_radps[i], std::abs(from_radps[i]));
      if (segment.largest_velocity_radps() > fastest_radps) return false;
      if (segment.largest_acceleration_radps2() > share * limits.acceleration_radps2[i]) return false;
    }
    return true;
  };
  // Lower bounds: a joint brakes no faster than at its limit, and a velocity at the start saves less than half of the
  // duration from rest.
  const double braking_s = from_radps.cwiseAbs().cwiseQuotient(limits.acceleration_radps2).maxCoeff();
  double duration_s = std::max(0.5 * at_rest_s, braking_s);
  while (!is_long_enough(duration_s)) duration_s *= kLonger;
  return duration_s;
}

bool turns_within_limits(const JointLimits& limits, const Guide& guide) {
  const JointVector &from_rad = guide.position_rad[0], &to_rad = guide.position_rad[1];
  const double duration_s = guide.time_s[1] - guide.time_s[0];
  for (Eigen::Index i = 0; i < from_rad.size(); ++i) {
    const SegmentToRest segment{to_rad[i] - from_rad[i], guide.velocity_radps[0][i], duration_s};
    const double turns_rad = from_rad[i] + segment.turning_rad();
    if (turns_rad < limits.lower_rad[i] || turns_rad > limits.upper_rad[i]) return false;
  }
  return true;
}

}  // namespace sidestep
