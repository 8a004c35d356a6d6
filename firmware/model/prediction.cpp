#include "firmware/model/prediction.h"

#include <algorithm>

#include "firmware/model/bounded_list.h"
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
  BoundedList<Capsule, kMaxShapes> links;
  BoundedList<Ball, kMaxShapes> around;
  for (const LinkShape& shape : arm.shapes) {
    if (shape.body == 0) continue;
    links.add(placed(posture, shape));
    around.add(Ball(links[links.size() - 1]));
  }

  double least_m = enough_m;
  for (int o = 0; o < count; ++o) {
    const Obstacle& obstacle = obstacles[o];
    const Vector3 centre = obstacle.capsule.centre() + obstacle.velocity_mps * after_s;
    const double extent_m = obstacle.capsule.extent_m();
    for (int l = 0; l < links.size(); ++l) {
      const double near_m = around[l].radius_m + extent_m + least_m;
      if (near_m <= 0.0 || (around[l].centre - centre).squaredNorm() >= near_m * near_m) continue;
      least_m = std::min(least_m, surface_distance_m(links[l], moved(obstacle, after_s), least_m));
    }
  }
  return least_m;
}

}  // namespace sidestep
