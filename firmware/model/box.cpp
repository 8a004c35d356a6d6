#include "firmware/model/box.h"

#include <limits>

namespace sidestep {
namespace {

constexpr double kTouching_m = 1e-9;  // below this distance the segment overlaps the box

Vector3 nearest_in_box(const Vector3& p, const Vector3& half) {
  return p.cwiseMax(-half).cwiseMin(half);
}

/// A segment in the box's frame, whose origin is the box's centre.
struct Segment {
  Vector3 start;
  Vector3 displacement;  ///< from start to end

  Vector3 at(double t) const { return start + t * displacement; }
  /// Half the derivative by t of the squared distance to the box. Non-decreasing, and linear between the values of t at
  /// which the segment crosses the plane of a face.
  double slope(double t, const Vector3& half) const { return displacement.dot(at(t) - nearest_in_box(at(t), half)); }
};

/// The t in [0, 1] of the point nearest to the box: the root of the slope. The bracket low..high shrinks until no face
/// plane is crossed within it, where the root follows from one linear equation.
double nearest_parameter(const Segment& segment, const Vector3& half) {
  double low = 0.0, high = 1.0;
  double at_low = segment.slope(low, half), at_high = segment.slope(high, half);
  if (at_low >= 0.0) return low;
  if (at_high <= 0.0) return high;
  for (int axis = 0; axis < 3; ++axis) {
    if (segment.displacement[axis] == 0.0) continue;
    for (const double face : {-half[axis], half[axis]}) {
      const double t = (face - segment.start[axis]) / segment.displacement[axis];
      if (!(t > low && t < high)) continue;
      const double slope = segment.slope(t, half);
      (slope < 0.0 ? low : high) = t;
      (slope < 0.0 ? at_low : at_high) = slope;
    }
  }
  return low + (high - low) * at_low / (at_low - at_high);
}

/// The shortest translation that moves an overlapping segment out of the box: depth_m along normal.
class ShortestExit {
 public:
  ShortestExit(const Segment& segment, const Vector3& half) : segment_(segment), half_(half) {
    // All translations of the segment that overlap the box form a polytope (the Minkowski sum of the two). The normals
    // of its faces are those of the box and the cross products of the segment with the edges of the box.
    for (int axis = 0; axis < 3; ++axis) consider(Vector3::Unit(axis));
    const double parallel_m = 1e-6 * segment.displacement.norm();
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 across = segment.displacement.cross(Vector3::Unit(axis));
      if (across.norm() > parallel_m) consider(across.normalized());
    }
  }
  Vector3 normal = Vector3::UnitZ();
  double depth_m = std::numeric_limits<double>::infinity();

 private:
  void consider(const Vector3& direction) {
    const double off_m = segment_.at(0.5).dot(direction);
    const double touching_m = half_.dot(direction.cwiseAbs()) + 0.5 * std::abs(segment_.displacement.dot(direction));
    if (touching_m - std::abs(off_m) >= depth_m) return;
    depth_m = touching_m - std::abs(off_m);
    normal = off_m < 0.0 ? Vector3(-direction) : direction;
  }

  const Segment& segment_;
  const Vector3& half_;
};

}  // namespace

SegmentGap gap_to_box(const Vector3& start, const Vector3& end, const Box& box) {
  Segment segment{box.axes.transpose() * (start - box.centre), box.axes.transpose() * (end - start)};
  const auto in_base = [&](const Vector3& p) { return Vector3(box.centre + box.axes * p); };
  const Vector3 on_segment = segment.at(nearest_parameter(segment, box.half_m));
  const Vector3 on_box = nearest_in_box(on_segment, box.half_m);
  const double distance_m = (on_segment - on_box).norm();
  if (distance_m > kTouching_m)
    return {distance_m, in_base(on_segment), in_base(on_box), box.axes * (on_segment - on_box) / distance_m};

  // The point of the segment that is deepest in the box is the nearest one after a translation out of the box by a
  // little more than the depth.
  const ShortestExit exit(segment, box.half_m);
  const double margin_m = 0.01;
  const Segment outside{segment.start + (exit.depth_m + margin_m) * exit.normal, segment.displacement};
  const Vector3 deepest = segment.at(nearest_parameter(outside, box.half_m));
  return {-exit.depth_m, in_base(deepest), in_base(deepest + exit.depth_m * exit.normal), box.axes * exit.normal};
}

}  // namespace sidestep
