#pragma once

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Joint velocity that tracks the target without obstacle avoidance: the paper's attraction, eqs (7) and (8), through
/// its damped inverse, eqs (5) and (6), within the joint limits. The benchmark keeps only scenes in which plain
/// tracking touches an obstacle.
Joints plain_tracking(const JudgeArm& arm, const Limits& limits, const PointMotion& target, const Joints& q_rad,
                      const Joints& qd_radps);

/// Whether an ideal arm under plain tracking touches a sphere of the scene.
bool plain_tracking_hits(const Scene& scene);

}  // namespace sidestep::campaign
