#include "firmware/control/shield/required_clearance.h"

namespace sidestep {

double doubt(const Obstacle& obstacle) {
  if (obstacle.kind == Kind::kPerson || obstacle.id <= kNeighbourIds) return 1.0;
  return std::min(1.0, fastest_point_mps(obstacle) / kMoves_mps);
}

double hard_clearance_m(const ShieldSettings& settings, double doubt, double link_mps) {
  const double full_m = settings.hard_clearance_m;
  const double share = std::min(1.0, std::max(doubt, link_mps / kFastLink_mps));
  return full_m - (1.0 - share) * std::max(0.0, full_m - settings.rest_clearance_m);
}

}  // namespace sidestep
