#include "firmware/model/prediction.h"

#include <algorithm>

#include "firmware/model/proximity.h"

namespace sidestep {
namespace {

/// A ball around a capsule.
struct Ball {
  Vector3 centre;
  double radius_m;

  explicit Ball(const Capsule& capsule) : centre(capsule.centre()), radius_m(capsule.extent_m()) {}
};

}  // namespace

double clearance_after(const Arm& arm, const Posture& posture, const Obstacle* obstacles, int count, double after_s,
                       double enough_m) {
  std::array<Capsule, kMaxShapes> links;
  int moving = 0;
  for (const LinkShape& shape : arm.shapes)
    if (shape.body > 0) links[moving++] = placed(posture, shape);

  double least_m = enough_m;
  for (int o = 0; o < count; ++o) {
    const Obstacle then = moved(obstacles[o], after_s);
    const Ball there(then.capsule);
    for (int l = 0; l < moving; ++l) {
      const Ball link(links[l]);
      const double near_m = link.radius_m + there.radius_m + least_m;
      if (near_m <= 0.0 || (link.centre - there.centre).squaredNorm() >= near_m * near_m) continue;
      least_m = std::min(least_m, surface_distance_m(links[l], then, least_m));
    }
  }
  return least_m;
}

}  // namespace sidestep
