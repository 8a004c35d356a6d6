#pragma once

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

constexpr double kBoxStartClearance_m = 0.15;  ///< of the arm at its start to every box at t = 0
constexpr double kGroundClearance_m = 0.05;    ///< of the arm at start and goal to the ground
constexpr double kLinksClearance_m = 0.005;    ///< of its links to each other at start and goal
constexpr double kBaseRegion_m = 0.55;         ///< a box's centre is never nearer to the axis of the base column

/// Completes a scene among boxes, whose start and goal are given: each box moves to and fro on a random straight line
/// through the workspace (box_path.h), through other boxes, too. The workspace is a sphere around the base, whose
/// radius is the length of the arm and a box's edge, without what is below the ground or near the base column. The
/// boxes of an arm whose axes are all parallel move in its plane. The ground is four slabs at rest around a hole for
/// the base, its top at z = 0. There is no witness. Returns false if start or goal is too near to the ground or to self
/// contact, if the tool is at nearly the same place in both, if the boxes never leave the goal free for a while, or if
/// too few boxes fit.
bool make_boxes(Random& random, Scene& scene, const Joints& start_rad, const Joints& goal_rad);

}  // namespace sidestep::campaign
