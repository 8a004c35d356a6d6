#pragma once

#include <vector>

#include "firmware/base/bounded_list.h"
#include "firmware/model/kinematics.h"
#include "firmware/model/proximity.h"

namespace sidestep {

/// A pair that matters now or soon.
struct NearPair {
  Proximity now;
  ClosestApproach approach;
  Vector3 velocity_mps = Vector3::Zero();  ///< of the obstacle's nearest point
};

constexpr int kMaxNear = 64;

/// The arm among its obstacles at one instant.
struct Clearance {
  Proximity nearest;                     ///< by surface distance, every shape of the arm
  Proximity nearest_axis;                ///< by axis distance, moving shapes only (paper-notes item 7: A_0 and d_0)
  BoundedList<NearPair, kMaxNear> near;  ///< the pairs within reach, the most pressing of too many, in no order
};

/// What is known of the obstacles: the last set, its age, and by how much each has to be grown, m, for what is not
/// known; and behind them, by index, those that always stand there.
struct ObstacleView {
  const ObstacleSet* set = nullptr;  ///< null: none
  double age_s = 0.0;
  double growth_m = 0.0;
  const std::vector<Obstacle>* surroundings = nullptr;  ///< null: none

  int reported() const { return set ? set->count : 0; }
  int count() const { return reported() + (surroundings ? static_cast<int>(surroundings->size()) : 0); }
  const Obstacle& at(int index) const {
    if (index < reported()) return set->obstacles[index];
    return (*surroundings)[index - reported()];
  }
  double growth_of(int index) const { return index < reported() ? growth_m : 0.0; }
  /// Where it is later_s from now, and grown.
  Obstacle extrapolated(int index, double later_s = 0.0) const;
};

/// Which pairs are collected: those nearer than range_m now, or so near within horizon_s at constant velocity.
struct Reach {
  double range_m;
  double horizon_s;
};

/// Distances of all link shapes to all obstacles, these moved forward to the present by their velocities. Work is
/// bounded by shapes x obstacles; obstacles that stay far cost one comparison each.
Clearance measure_clearance(const Arm& arm, const LinkPoses& poses, const ObstacleView& view, const Reach& reach);

}  // namespace sidestep
