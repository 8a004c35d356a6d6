#pragma once

#include <algorithm>
#include <vector>

#include "firmware/base/bounded_list.h"
#include "firmware/model/kinematics.h"
#include "firmware/model/proximity.h"

namespace sidestep {

/// A link shape and an obstacle that are near each other now or will be within the horizon.
struct NearPair {
  Proximity now;
  ClosestApproach approach;
  Vector3 velocity_mps = Vector3::Zero();  ///< of the obstacle's material at now.on_obstacle

  /// The lesser of the surface distances now and at the closest approach.
  double least_distance_m() const { return std::min(now.distance_m, approach.distance_m); }
};

constexpr int kMaxNear = 64;

/// Distances between the arm and its obstacles at one instant.
struct Clearance {
  /// The link shapes and held shapes in the base frame, numbered as by shape_at(), for the other computations of the
  /// cycle.
  BoundedList<Capsule, kMaxShapes> links;

  Proximity nearest;       ///< least surface distance, over all shapes of the arm
  Proximity nearest_axis;  ///< least axis distance, over the moving shapes (docs/paper.md item 7: A_0 and d_0)

  /// Pairs of a movable link shape and an obstacle within the Reach, unordered. If there are more than kMaxNear, the
  /// most urgent are kept: those with the least least_distance_m() - v t, where v is the speed at which the arm's own
  /// motion closes the pair, if it does, and t is Reach::stopping_s. A crowd beside a link that rests thus leaves
  /// places for what a fast link comes to.
  BoundedList<NearPair, kMaxNear> near;
};

/// The obstacles as they are known now: the newest set, its age, and the growth that covers what is uncertain. Indices
/// >= in_set() are the surroundings from the configuration file, which neither move nor grow.
struct ObstacleView {
  const ObstacleSet* set = nullptr;                     ///< null: no set was received
  double age_s = 0.0;                                   ///< of the set at the time of the cycle, since its measurement
  double growth_m = 0.0;                                ///< added to the radius of each obstacle of the set
  const std::vector<Obstacle>* surroundings = nullptr;  ///< the static obstacles; null: none
  /// How much nearer than computed an obstacle of the set may be, because the set is too old. It is part of the
  /// reported clearance, not of the distances: the arm brakes then, and obstacles that grow on all sides would push it
  /// about.
  double possible_m = 0.0;

  int in_set() const { return set ? set->count : 0; }
  int count() const { return in_set() + (surroundings ? static_cast<int>(surroundings->size()) : 0); }
  /// As in the set: neither extrapolated nor grown.
  const Obstacle& at(int index) const {
    if (index < in_set()) return set->obstacles[index];
    return (*surroundings)[index - in_set()];
  }
  double growth_of(int index) const { return index < in_set() ? growth_m : 0.0; }
  /// The obstacle later_s from now: extrapolated by age_s + later_s, and grown.
  Obstacle extrapolated(int index, double later_s = 0.0) const;
};

/// Which pairs are collected: those with a surface distance below range_m now, or at the closest approach within
/// horizon_s at constant velocity. For persons person_range_m counts where it is larger. velocity_radps: of the joints,
/// n x 1; null for an arm at rest. stopping_s: a bound of the time that the arm takes to stop.
struct Reach {
  double range_m;
  double horizon_s;
  double person_range_m = 0.0;
  const JointVector* velocity_radps = nullptr;
  double stopping_s = 0.0;
};

/// Distances of all link shapes to all obstacles, extrapolated to now and grown. Takes time proportional to shapes x
/// obstacles at most; an obstacle too far away for any result takes one comparison. Pairs whose contact is allowed
/// (Attachments) are left out. No allocation.
Clearance measure_clearance(const Arm& arm, const LinkPoses& poses, const ObstacleView& view, const Reach& reach);

}  // namespace sidestep
