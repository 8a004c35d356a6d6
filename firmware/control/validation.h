#pragma once

#include "firmware/control/types/messages.h"
#include "firmware/model/attachments.h"
#include "firmware/model/other_joints.h"

namespace sidestep {

/// Checks of values from outside. A value is plausible when every number is finite and within what an arm or a room can
/// have (lengths up to 1000 m, speeds up to 1000 m/s or rad/s), sizes are not negative, and quaternions that are used
/// have length 1 within 1e-3.
bool plausible(const ArmState& state, int joints);
bool plausible(const Target& target);  ///< its number of joints is not checked
bool plausible(const Obstacle& obstacle);
bool plausible(const OtherJoints& joints);
bool plausible(const Control& control);  ///< a known command, a scale from 0 to 1

/// Each returns false for an implausible value. Otherwise fields without meaning get neutral values: the orientation of
/// a target that tracks none, all but the posture of a posture target, the angular velocity of a sphere.
bool sanitize(Target& target);
bool sanitize(ObstacleSet& set);
bool sanitize(Attachments& attachments);  ///< what is held has no velocity of its own

/// Makes an obstacle at rest from the fields of a report; size_m as in obstacle_t. For an invalid shape, size or
/// orientation the result is not plausible().
Obstacle reported_obstacle(Shape shape, const Vector3& centre, const Quaternion& orientation, const Vector3& size_m);

}  // namespace sidestep
