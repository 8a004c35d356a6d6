#pragma once

#include "firmware/control/message_order.h"
#include "firmware/control/obstacle_memory.h"

namespace sidestep {

/// From what somebody reports to the values of a cycle, whatever way it came.

/// An obstacle of that shape at rest; not plausible() when shape, size or turn make no sense. size_m as in obstacle_t.
Obstacle reported_obstacle(Shape shape, const Vector3& centre, const Quaternion& turn, const Vector3& size_m);

/// Whether what is reported is plausible; if so it is made complete: what does not count is as if nobody had said it.
bool complete(Target& target);
bool complete(Shape shape, Obstacle& obstacle);

/// The memory of old places that the settings ask for.
ObstacleMemory obstacle_memory_of(const Settings& settings);

}  // namespace sidestep
