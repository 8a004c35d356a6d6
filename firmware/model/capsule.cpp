#include "firmware/model/capsule.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/nearest_points.h"

namespace sidestep {

Vector3 Capsule::centre() const {
  return 0.5 * (start + end);
}

double Capsule::extent_m() const {
  return 0.5 * (end - start).norm() + radius_m;
}

Capsule capsule_around_box(const Vector3& edges_m) {
  int longest = 0;
  edges_m.maxCoeff(&longest);
  Vector3 half = Vector3::Zero();
  half[longest] = 0.5 * edges_m[longest];
  const double radius_m = 0.5 * std::sqrt(edges_m.squaredNorm() - edges_m[longest] * edges_m[longest]);
  return {-half, half, radius_m};
}

bool contains(const Capsule& outer, const Capsule& inner) {
  const auto reach = [&](const Vector3& p) {
    return (p - nearest_on_segment(outer.start, outer.end, p)).norm() + inner.radius_m;
  };
  const double slack_m = 1e-9;
  return std::max(reach(inner.start), reach(inner.end)) <= outer.radius_m + slack_m;
}

}  // namespace sidestep
