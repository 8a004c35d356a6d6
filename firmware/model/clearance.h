#pragma once

#include <array>
#include <limits>

#include "firmware/model/kinematics.h"
#include "firmware/model/obstacle.h"

namespace sidestep {

/// One link shape and one obstacle. Points and directions in the base frame.
struct Proximity {
  int shape = -1;                                                    ///< index into Arm::shapes, -1 for none
  int obstacle = -1;                                                 ///< index into ObstacleSet::obstacles
  double distance_m = std::numeric_limits<double>::infinity();       ///< between surfaces, negative when they overlap
  double axis_distance_m = std::numeric_limits<double>::infinity();  ///< between axes, as the paper measures it
  Vector3 on_arm = Vector3::Zero();                                  ///< nearest point of the link's axis, m
  Vector3 on_obstacle = Vector3::Zero();                             ///< nearest point of the obstacle's axis, m
  Vector3 normal = Vector3::UnitZ();                                 ///< unit, from the obstacle to the arm
};

/// The closest that a moving obstacle will come to a link that stays where it is.
struct Approach {
  double time_s = 0.0;           ///< from now; 0 when it is not coming closer
  double distance_m = 0.0;       ///< between surfaces then
  double axis_distance_m = 0.0;  ///< between axes then
  Vector3 on_arm = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();  ///< unit, from the obstacle to the arm then; across the obstacle's path
  bool head_on = false;               ///< the path meets the link's axis, so that -normal would do as well
};

/// A pair that matters now or soon.
struct NearPair {
  Proximity now;
  Approach approach;
};

constexpr int kMaxNear = 64;

/// The arm among its obstacles at one instant.
struct Clearance {
  Proximity nearest;       ///< by surface distance, every shape of the arm
  Proximity nearest_axis;  ///< by axis distance, moving shapes only (paper-notes item 7: A_0 and d_0)
  int near_count = 0;
  std::array<NearPair, kMaxNear> near;  ///< the pairs within reach, the kMaxNear most pressing, in no order
};

/// What is known of the obstacles: the last set, its age, and by how much each has to be grown, m, for what is not
/// known.
struct ObstacleView {
  const ObstacleSet* set = nullptr;  ///< null: none
  double age_s = 0.0;
  double growth_m = 0.0;
};

/// Which pairs are collected: those nearer than range_m now, or so near within horizon_s at constant velocity.
struct Reach {
  double range_m;
  double horizon_s;
};

/// Distances of all link shapes to all obstacles, these moved forward to the present by their velocities. Work is
/// bounded by shapes x obstacles; obstacles that stay far cost one comparison each.
Clearance measure_clearance(const Arm& arm, const Posture& posture, const ObstacleView& view, const Reach& reach);

/// The proximity of two placed capsules; the normal is defined even where the axes meet.
Proximity measure_pair(const Capsule& link, const Capsule& obstacle);

/// The closest approach within horizon_s of the obstacle's point that is nearest now.
Approach predict_approach(const Capsule& link, const Capsule& obstacle, const Vector3& velocity_mps, double horizon_s);

}  // namespace sidestep
