#pragma once

#include "firmware/model/arm.h"

namespace sidestep {

/// Whether a point (base frame, m) is farther from the first joint than the tool can ever be: than the sum of the
/// distances from joint to joint and to the tool, and of the largest travels of prismatic joints. Nearer points may be
/// out of reach as well.
bool is_beyond_reach(const Arm& arm, const Vector3& point_m);

}  // namespace sidestep
