#include "host/campaign/segment.h"

#include <algorithm>
#include <cmath>

#include "host/sim/truth.h"

namespace sidestep::campaign {
namespace {

/// Distance of the segments' lines if both nearest points lie within the segments, else infinite.
double inner_distance(const Vector3& a_start, const Vector3& a_end, const Vector3& b_start, const Vector3& b_end) {
  const Vector3 a = a_end - a_start, b = b_end - b_start, from = b_start - a_start, normal = a.cross(b);
  const double squared = normal.squaredNorm();
  if (squared <= 1e-18 * a.squaredNorm() * b.squaredNorm()) return sim::kNothingNear;  // parallel, or a point
  const double on_a = from.cross(b).dot(normal) / squared, on_b = from.cross(a).dot(normal) / squared;
  const bool within = on_a >= 0.0 && on_a <= 1.0 && on_b >= 0.0 && on_b <= 1.0;
  return within ? std::abs(from.dot(normal)) / std::sqrt(squared) : sim::kNothingNear;
}

}  // namespace

double distance_to_segment(const Vector3& start, const Vector3& end, const Vector3& p) {
  const Vector3 along = end - start;
  const double squared = along.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - start).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - start - share * along).norm();
}

// Two segments are nearest at an end of one of them, or where their lines are nearest.
double segment_distance(const Vector3& a_start, const Vector3& a_end, const Vector3& b_start, const Vector3& b_end) {
  return std::min({distance_to_segment(a_start, a_end, b_start), distance_to_segment(a_start, a_end, b_end),
                   distance_to_segment(b_start, b_end, a_start), distance_to_segment(b_start, b_end, a_end),
                   inner_distance(a_start, a_end, b_start, b_end)});
}

}  // namespace sidestep::campaign
