#include "firmware/model/load/circle.h"

#include <algorithm>
#include <random>

namespace sidestep {
namespace {

using Point = Eigen::Vector2d;

bool holds(const Circle& circle, const Point& p) {
  return (p - circle.centre).norm() <= circle.radius_m * (1.0 + 1e-12) + 1e-15;
}

Circle through(const Point& a, const Point& b) {
  return {0.5 * (a + b), 0.5 * (a - b).norm()};
}

Circle through(const Point& a, const Point& b, const Point& c) {
  const Point ab = b - a, ac = c - a;
  const double twice_area = ab.x() * ac.y() - ab.y() * ac.x();
  const Circle sides[] = {through(a, b), through(b, c), through(c, a)};
  const Circle& longest = *std::max_element(std::begin(sides), std::end(sides),
                                            [](const auto& l, const auto& r) { return l.radius_m < r.radius_m; });
  if (std::abs(twice_area) <= 1e-12 * longest.radius_m * longest.radius_m)
    return longest;  // the points are on one line
  const Point to_centre = Point(ac.y() * ab.squaredNorm() - ab.y() * ac.squaredNorm(),
                                ab.x() * ac.squaredNorm() - ac.x() * ab.squaredNorm()) /
                          (2.0 * twice_area);
  return {a + to_centre, to_centre.norm()};
}

}  // namespace

Circle circle_around(std::vector<Point> points_m) {
  std::shuffle(points_m.begin(), points_m.end(), std::mt19937(1));  // linear time on average for any order of the input
  Circle circle;
  if (!points_m.empty()) circle.centre = points_m.front();
  for (size_t i = 1; i < points_m.size(); ++i) {
    if (holds(circle, points_m[i])) continue;
    circle = {points_m[i], 0.0};
    for (size_t j = 0; j < i; ++j) {
      if (holds(circle, points_m[j])) continue;
      circle = through(points_m[i], points_m[j]);
      for (size_t k = 0; k < j; ++k)
        if (!holds(circle, points_m[k])) circle = through(points_m[i], points_m[j], points_m[k]);
    }
  }
  // With three points nearly on one line, rounding may leave a point outside.
  for (const Point& p : points_m) circle.radius_m = std::max(circle.radius_m, (p - circle.centre).norm());
  return circle;
}

}  // namespace sidestep
