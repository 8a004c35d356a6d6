#pragma once

#include "firmware/base/bounded_list.h"
#include "firmware/model/link_proximity.h"

namespace sidestep {

/// Where a link and an obstacle that are nearest at other points will be nearest after a turn: up to one point of the
/// link against the obstacle, and one point of the obstacle against the link.
///
/// Faces, edges and axes that are nearly parallel are nearest at one end now and at the other after a small turn, so
/// that the motion of the present nearest points says nothing about the next ones. To first order a point p of the
/// link changes its distance from the plane across the normal n by n . (turn x p), therefore the link's next point is
/// its extreme point along -(n + n x turn). The same plane turns with the link past the obstacle, whose next point is
/// its extreme point along n - n x turn.
///
/// now: the pair's Proximity. turn_rad: rotation vector of the link relative to the obstacle, base frame; it may be
/// large, the points are then approximate. Points within 1 cm of the present ones are left out. Every result has the
/// indices of `now`.
BoundedList<Proximity, 2> proximities_after_turn(const PosedShape& link, const Obstacle& obstacle, const Proximity& now,
                                                 const Vector3& turn_rad);

/// The same of two links; `second` takes the place of the obstacle.
BoundedList<Proximity, 2> proximities_after_turn(const PosedShape& first, const PosedShape& second,
                                                 const Proximity& now, const Vector3& turn_rad);

}  // namespace sidestep
