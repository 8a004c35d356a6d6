#pragma once

#include "firmware/control/types/settings.h"
#include "firmware/model/clearance.h"

namespace sidestep {

/// How far to keep from an obstacle. A slow link needs rest_clearance_m from what rests and is exactly known. What
/// moves needs the full clearance: its report is old and its motion may change. So does a fast link, which a row of the
/// shield stops only nearly where it should. In between, the clearance grows linearly with the speed of the fastest
/// point of the obstacle, up to 0.05 m/s, and of the link, up to kFastLink_mps; the larger one counts. A person, a link
/// of another arm, and an obstacle that has grown because its position is uncertain always need the full clearance.

constexpr double kFastLink_mps = 0.5;
constexpr double kMoves_mps = 0.05;  ///< an obstacle whose fastest point is slower rests more or less

/// Speed of the fastest point of an obstacle, m/s; an upper bound.
inline double fastest_point_mps(const Obstacle& obstacle) {
  return obstacle.velocity_mps.norm() + obstacle.angular_velocity_radps.norm() * obstacle.capsule.extent_m();
}

/// 0: the obstacle rests and is exactly known; 1: it needs the full clearance.
double doubt(const Obstacle& obstacle);

/// The same of an obstacle of a view.
inline double doubt(const ObstacleView& view, int obstacle) {
  return view.growth_of(obstacle) > 0.0 ? 1.0 : doubt(view.at(obstacle));
}

/// The hard clearance of a link to an obstacle with this doubt(), m.
double hard_clearance_m(const ShieldSettings& settings, double doubt, double link_mps);

/// Whether obstacles at rest do not grow with these settings.
inline bool is_exact(const ObstacleTrust& trust) {
  return trust.uncertainty_m == 0.0 && trust.acceleration_bound_mps2 == 0.0;
}

/// The same of a slow link to an obstacle that has not grown, with `full_m` in place of the hard clearance and `rest_m`
/// in place of rest_clearance_m.
inline double required_clearance_m(double full_m, double rest_m, const Obstacle& obstacle) {
  return full_m - (1.0 - doubt(obstacle)) * std::max(0.0, full_m - rest_m);
}

}  // namespace sidestep
