#include "firmware/model/box.h"

#include <limits>

namespace sidestep {
namespace {

constexpr double kTouching_m = 1e-9;

Vector3 nearest_in_box(const Vector3& p, const Vector3& half) {
  return p.cwiseMax(-half).cwiseMin(half);
}

/// A segment in the frame of a box around the origin.
struct Segment {
  Vector3 start;
  Vector3 way;

  Vector3 at(double t) const { return start + t * way; }
  /// Half the derivative by t of the squared distance to the box: it grows, linearly from face plane to face plane.
  double slope(double t, const Vector3& half) const { return way.dot(at(t) - nearest_in_box(at(t), half)); }
};

/// The t in [0, 1] that is nearest to the box: where the slope is zero. A bracket of it without a face plane inside
/// makes that one linear equation.
double nearest_parameter(const Segment& segment, const Vector3& half) {
  double low = 0.0, high = 1.0;
  double at_low = segment.slope(low, half), at_high = segment.slope(high, half);
  if (at_low >= 0.0) return low;
  if (at_high <= 0.0) return high;
  for (int axis = 0; axis < 3; ++axis) {
    if (segment.way[axis] == 0.0) continue;
    for (const double face : {-half[axis], half[axis]}) {
      const double t = (face - segment.start[axis]) / segment.way[axis];
      if (!(t > low && t < high)) continue;
      const double slope = segment.slope(t, half);
      (slope < 0.0 ? low : high) = t;
      (slope < 0.0 ? at_low : at_high) = slope;
    }
  }
  return low + (high - low) * at_low / (at_low - at_high);
}

/// The shortest way out of a box for a segment that overlaps it.
class WayOut {
 public:
  WayOut(const Segment& segment, const Vector3& half) : segment_(segment), half_(half) {
    // What the segment sweeps over the box is a polytope; these are the normals of its faces.
    for (int axis = 0; axis < 3; ++axis) consider(Vector3::Unit(axis));
    const double parallel_m = 1e-6 * segment.way.norm();
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 across = segment.way.cross(Vector3::Unit(axis));
      if (across.norm() > parallel_m) consider(across.normalized());
    }
  }
  Vector3 normal = Vector3::UnitZ();
  double depth_m = std::numeric_limits<double>::infinity();

 private:
  void consider(const Vector3& direction) {
    const double off_m = segment_.at(0.5).dot(direction);
    const double reach_m = half_.dot(direction.cwiseAbs()) + 0.5 * std::abs(segment_.way.dot(direction));
    if (reach_m - std::abs(off_m) >= depth_m) return;
    depth_m = reach_m - std::abs(off_m);
    normal = off_m < 0.0 ? Vector3(-direction) : direction;
  }

  const Segment& segment_;
  const Vector3& half_;
};

}  // namespace

BoxGap gap_to_box(const Vector3& start, const Vector3& end, const Box& box) {
  Segment segment{box.axes.transpose() * (start - box.centre), box.axes.transpose() * (end - start)};
  const auto in_base = [&](const Vector3& p) { return Vector3(box.centre + box.axes * p); };
  const Vector3 on_segment = segment.at(nearest_parameter(segment, box.half_m));
  const Vector3 on_box = nearest_in_box(on_segment, box.half_m);
  const double distance_m = (on_segment - on_box).norm();
  if (distance_m > kTouching_m)
    return {distance_m, in_base(on_segment), in_base(on_box), box.axes * (on_segment - on_box) / distance_m};

  // Moved out that way, and a bit farther, the segment is nearest to the box with its deepest point.
  const WayOut out(segment, box.half_m);
  const double bit_m = 0.01;
  const Segment outside{segment.start + (out.depth_m + bit_m) * out.normal, segment.way};
  const Vector3 deepest = segment.at(nearest_parameter(outside, box.half_m));
  return {-out.depth_m, in_base(deepest), in_base(deepest + out.depth_m * out.normal), box.axes * out.normal};
}

}  // namespace sidestep
