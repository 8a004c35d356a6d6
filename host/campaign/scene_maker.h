#pragma once

#include "host/campaign/lwa3_arm.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// The scene of a family, a seed and an arm; the same one everywhere and always. Draws until the benchmark's rules keep
/// one: the witness stays 0.05 m clear of every sphere and each comes within 0.25 m of it, and plain tracking hits one,
/// where there is any.
/// The arm must outlive the scene. Throws std::runtime_error for an arm that allows no scene.
Scene make_scene(const Family& family, uint64_t seed, const JudgeArm& arm = lwa3_arm());

/// Clearance of the witness that makes a sphere part of a scene.
constexpr double kWitnessClearance_m = 0.05;
constexpr double kWitnessNear_m = 0.25;

}  // namespace sidestep::campaign
