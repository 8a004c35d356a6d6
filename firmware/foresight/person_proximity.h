#pragma once

#include "firmware/foresight/snapshot.h"
#include "firmware/model/kinematics.h"

namespace sidestep {

/// How near the whole arm is to persons: the mean of exp(-d / 0.2 m) over the straight lines from joint to joint and to
/// the tool, where d is the distance of a point to the nearest person, taken as its enclosing capsule. 0 without a
/// person or far away from all, 1 if persons touch every link. Unlike the least distance, which the base often
/// determines alone, it tells two configurations apart in which the same link is the nearest. Base frame.
double person_proximity(const LinkPoses& poses, const Obstacle* obstacles, int count);

}  // namespace sidestep
