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

constexpr int kMaxNear = 64;

/// The arm among its obstacles at one instant.
struct Clearance {
  Proximity nearest;       ///< by surface distance, every shape of the arm
  Proximity nearest_axis;  ///< by axis distance, moving shapes only (paper-notes item 7: A_0 and d_0)
  int near_count = 0;
  std::array<Proximity, kMaxNear> near;  ///< the pairs within range, the kMaxNear nearest, in no order
};

/// What is known of the obstacles: the last set, its age, and by how much each has to be grown, m, for what is not
/// known.
struct ObstacleView {
  const ObstacleSet* set = nullptr;  ///< null: none
  double age_s = 0.0;
  double growth_m = 0.0;
};

/// Distances of all link shapes to all obstacles, these moved forward to the present by their velocities.
/// Collects the pairs nearer than range_m. Work is bounded by shapes x obstacles; obstacles whose bounds are far cost
/// one comparison each.
Clearance measure_clearance(const Arm& arm, const Posture& posture, const ObstacleView& view, double range_m);

/// The proximity of two placed capsules; the normal is defined even where the axes meet.
Proximity measure_pair(const Capsule& link, const Capsule& obstacle);

}  // namespace sidestep
