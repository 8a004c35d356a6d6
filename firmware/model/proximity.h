#pragma once

#include <limits>

#include "firmware/model/obstacle.h"

namespace sidestep {

/// One link shape and one obstacle. Points and directions in the base frame.
struct Proximity {
  int shape = -1;                                                    ///< index into Arm::shapes, -1 for none
  int obstacle = -1;                                                 ///< index into the ObstacleView
  double distance_m = std::numeric_limits<double>::infinity();       ///< between surfaces, negative when they overlap
  double axis_distance_m = std::numeric_limits<double>::infinity();  ///< between axes; a box is its own axis
  Vector3 on_arm = Vector3::Zero();                                  ///< nearest point of the link's axis, m
  Vector3 on_obstacle = Vector3::Zero();                             ///< nearest point of its axis or box, m
  Vector3 normal = Vector3::UnitZ();                                 ///< unit, from the obstacle to the arm
};

/// The closest that a moving obstacle will come to a link that stays where it is.
struct ClosestApproach {
  double time_s = 0.0;           ///< from now; 0 when it is not coming closer
  double distance_m = 0.0;       ///< between surfaces then
  double axis_distance_m = 0.0;  ///< between axes then; infinite for a box
  Vector3 on_arm = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();  ///< unit, from the obstacle to the arm then; across the obstacle's path
  bool head_on = false;               ///< the path meets the link's axis, so that -normal would do as well
};

/// The proximity of a link to an axis or point of that radius, whose nearest points are known, and the gap between them
/// (from the obstacle to the arm) and its length; the normal is defined even where the axes meet.
inline Proximity proximity_of(const Capsule& link, double radius_m, const NearestPoints& points, const Vector3& gap,
                              double gap_m) {
  Proximity pair;
  pair.on_arm = points.a;
  pair.on_obstacle = points.b;
  pair.axis_distance_m = gap_m;
  pair.distance_m = gap_m - link.radius_m - radius_m;
  if (gap_m > 1e-9)
    pair.normal = gap / gap_m;
  else if (link.end != link.start)  // the axes meet: any way out across the link
    pair.normal = (link.end - link.start).unitOrthogonal();
  return pair;
}

/// The proximity of two placed capsules; the normal is defined even where the axes meet.
Proximity measure_pair(const Capsule& link, const Capsule& obstacle);

/// The same to an obstacle of any shape.
Proximity measure_pair(const Capsule& link, const Obstacle& obstacle);

/// Between surfaces, m, as measure_pair() says. Exact below enough_m, else anything from there up to what it is.
double surface_distance_m(const Capsule& link, const Obstacle& obstacle, double enough_m);

/// The closest approach within horizon_s at the velocity of the point that is nearest now: of that point, or of a whole
/// box.
ClosestApproach predict_closest_approach(const Capsule& link, const Obstacle& obstacle, const Proximity& now,
                                         double horizon_s);

/// The same of a ball around a point.
ClosestApproach predict_closest_approach(const Capsule& link, double radius_m, const Vector3& point,
                                         const Vector3& velocity_mps, double horizon_s);

}  // namespace sidestep
