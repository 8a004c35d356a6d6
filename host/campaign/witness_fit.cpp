#include "host/campaign/witness_fit.h"

#include <algorithm>
#include <limits>

namespace sidestep::campaign {

bool fits_witness(const JudgeArm& arm, const std::vector<ArmPose>& witness, const SpherePath& sphere) {
  double least_m = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < witness.size(); ++k) {
    const Vector3 center_m = sphere.at(static_cast<double>(k) * kPeriod_s).position_m;
    least_m = std::min(least_m, arm.controller_clearance(witness[k], center_m, kSphereRadius_m));
    if (least_m < kWitnessClearance_m) return false;
    if (arm.clearance(witness[k], center_m, kSphereRadius_m, kWitnessClearance_m) < kWitnessClearance_m) return false;
  }
  return least_m <= kWitnessNear_m;
}

}  // namespace sidestep::campaign
