#pragma once

#include <vector>

#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// Least clearance between the witness and a sphere of a scene, and the distance that every sphere comes within.
constexpr double kWitnessClearance_m = 0.05;
constexpr double kWitnessNear_m = 0.25;

/// Whether the sphere comes within kWitnessNear_m of the witness, whose poses at all periods are given, but never
/// closer than kWitnessClearance_m.
bool fits_witness(const JudgeArm& arm, const std::vector<ArmPose>& witness, const SpherePath& sphere);

}  // namespace sidestep::campaign
