#pragma once

#include <limits>

#include "firmware/model/obstacle.h"

namespace sidestep {

/// One link shape and one obstacle at one instant, in the base frame. The points lie on the link's axis and on the
/// obstacle's core (obstacle.h), not on the surfaces: on_arm = on_obstacle + axis_distance_m * normal.
struct Proximity {
  int shape = -1;                                                    ///< index into Arm::shapes, -1 for none
  int obstacle = -1;                                                 ///< index into the ObstacleView
  double distance_m = std::numeric_limits<double>::infinity();       ///< between surfaces, negative if they overlap
  double axis_distance_m = std::numeric_limits<double>::infinity();  ///< from the link's axis to the core
  Vector3 on_arm = Vector3::Zero();       ///< nearest point, m: of the link's axis; on its surface if it is no capsule
  Vector3 on_obstacle = Vector3::Zero();  ///< the core's nearest point, m
  Vector3 normal = Vector3::UnitZ();      ///< unit, from the obstacle to the arm
};

/// The closest approach of a moving obstacle to a link at rest.
struct ClosestApproach {
  double time_s = 0.0;      ///< from now; 0 if the obstacle is not coming closer
  double distance_m = 0.0;  ///< between surfaces at that time
  double axis_distance_m =
      0.0;  ///< from the link's axis to the core at that time; not computed (infinite) for a box or cylinder
  Vector3 on_arm = Vector3::Zero();   ///< the link axis' nearest point at that time, m
  Vector3 normal = Vector3::UnitZ();  ///< unit, from the obstacle to the arm at that time; if head_on, any direction
                                      ///< perpendicular to the path
  bool head_on = false;  ///< the path passes the link's axis within 5 mm: passing on the side of -normal is as good
};

/// The Proximity (without its indices) of a link, first, to a capsule, which may be another link: the normal points
/// from the second to the first.
Proximity measure_pair(const Capsule& link, const Capsule& obstacle);

/// The same for an obstacle of any shape.
Proximity measure_pair(const Capsule& link, const Obstacle& obstacle);

/// Distance between surfaces, m, as of measure_pair(), if it is below enough_m. Otherwise a lower bound of the
/// distance that is at least enough_m. For a box that is far away it is the distance to the enclosing capsule.
double surface_distance_m(const Capsule& link, const Obstacle& obstacle, double enough_m);

/// A bound, m: distance to the core >= distance to the axis of the enclosing capsule - core_reach_m(). 0 for a sphere
/// or capsule, the radius of `capsule` for a box, that of the core for a cylinder. A caller can discard pairs by the
/// distance between axes alone.
double core_reach_m(const Obstacle& obstacle);

/// The closest approach within horizon_s. `present` is the result of measure_pair(link, obstacle). The whole obstacle
/// is assumed to translate at the velocity of its point present.on_obstacle.
///   sphere   exact
///   capsule  only that point, grown by the radius, is followed; other points of the capsule may come nearer
///   box, cylinder  sampled at the present and at no more than 5 instants up to horizon_s; the true closest approach
///   may be
///            nearer than the nearest sample, never farther
ClosestApproach predict_closest_approach(const Capsule& link, const Obstacle& obstacle, const Proximity& present,
                                         double horizon_s);

/// The closest approach of a ball of radius_m around a moving point; exact.
ClosestApproach predict_closest_approach(const Capsule& link, double radius_m, const Vector3& point,
                                         const Vector3& velocity_mps, double horizon_s);

}  // namespace sidestep
