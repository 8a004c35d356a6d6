#pragma once

#include <vector>

#include "host/campaign/family.h"
#include "host/campaign/random.h"
#include "host/sim/world.h"

namespace sidestep::campaign {

/// Where the tool of a goal must be, base frame, and where it must point, for a piece of furniture around it.
struct GoalRegion {
  double nearest_m = 0.35, farthest_m = 0.80;  ///< from the base's axis, horizontally
  double lowest_m, highest_m;
  double most_upward;    ///< largest vertical part of the direction from wrist to tool, 1: any
  double least_outward;  ///< least part of it horizontally away from the base, -1: any
};

GoalRegion goal_region(Furniture kind);

/// Draws a piece of furniture and cans in it, of random sizes, around a goal of the tool; base frame. Nothing is
/// checked against the arm. The ranges are wide enough for links of 0.10 m diameter.
///   - shelf: two or three compartments with sides and a back, cans in them; the goal is in one of the compartments
///   - box: open at the top, up to three cans
///   - cage: bars along all edges and across the faces, on a board, up to three cans
///   - table: cans and boxes stand on it, around the goal
///   - under-table: a table above the goal, a board with cans below it
std::vector<sim::Obstacle> draw_furniture(Random& random, Furniture kind, const Eigen::Vector3d& goal_m);

}  // namespace sidestep::campaign
