#include "firmware/model/gjk.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sidestep {
namespace {

constexpr int kMostSteps = 64;
constexpr double kRelativeGap = 1e-10;    // of the squared distance, between its bounds, at the end
constexpr double kOverlap_m = 1e-9;       // cores that are nearer count as overlapping
constexpr double kOverlapShare = 1e-10;   // the same, of the extent of the two together
constexpr int kMostTranslations = 8;      // of overlapping cores
constexpr double kOverlapGain_m = 1e-9;   // by which a translation must shorten the next one
constexpr double kPartedMargin_m = 0.01;  // by which overlapping cores are moved apart to find their points
constexpr double kNudge_m = 1e-5;         // a translation that parts cores that only touch
constexpr double kTouching_m = 1e-8;      // an overlap that is no deeper needs no such translation

/// rotation * v and its inverse by columns, which are inlined; Eigen's product of small matrices is a function call.
EIGEN_ALWAYS_INLINE Vector3 rotated(const Matrix3& rotation, const Vector3& v) {
  return rotation.col(0) * v[0] + rotation.col(1) * v[1] + rotation.col(2) * v[2];
}
EIGEN_ALWAYS_INLINE Vector3 rotated_back(const Matrix3& rotation, const Vector3& v) {
  return {rotation.col(0).dot(v), rotation.col(1).dot(v), rotation.col(2).dot(v)};
}

/// A point of core a, a point of core b, and their difference a - b.
struct Vertex {
  Vector3 a, b, difference;
};

/// One to four vertices, and the weights of the point of their hull that is the nearest to the origin.
struct Simplex {
  int count = 0;
  std::array<Vertex, 4> vertices;
  std::array<double, 4> weights;

  Vector3 nearest() const {
    Vector3 sum = Vector3::Zero();
    for (size_t i = 0; i < static_cast<size_t>(count); ++i) sum += weights[i] * vertices[i].difference;
    return sum;
  }
  bool contains(const Vector3& difference) const {
    return std::any_of(vertices.begin(), vertices.begin() + count,
                       [&](const Vertex& v) { return (v.difference.array() == difference.array()).all(); });
  }
  void drop_unweighted() {
    int kept = 0;
    for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
      if (weights[i] <= 0.0) continue;
      vertices[static_cast<size_t>(kept)] = vertices[i];
      weights[static_cast<size_t>(kept++)] = weights[i];
    }
    count = kept;
  }
};

using Weights2 = std::array<double, 2>;
using Weights3 = std::array<double, 3>;

Weights2 nearest_of_segment(const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp(-a.dot(ab) / length2, 0.0, 1.0) : 0.0;
  return {1.0 - t, t};
}

/// The best of the three edges of a triangle.
Weights3 nearest_of_edges(const std::array<Vector3, 3>& corners) {
  Weights3 best{};
  double least_m2 = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3;
    const Weights2 weights = nearest_of_segment(corners[i], corners[j]);
    const double distance2_m2 = (weights[0] * corners[i] + weights[1] * corners[j]).squaredNorm();
    if (!(distance2_m2 < least_m2)) continue;
    least_m2 = distance2_m2;
    best = {};
    best[i] = weights[0], best[j] = weights[1];
  }
  return best;
}

/// From the longest edge and the height above it: on a round surface the triangles are slivers, whose area as a
/// difference of products would be all rounding.
Weights3 nearest_of_triangle(const std::array<Vector3, 3>& corners) {
  size_t first = 0;
  double longest_m2 = -1.0;
  for (size_t i = 0; i < 3; ++i) {
    const double length2_m2 = (corners[(i + 1) % 3] - corners[i]).squaredNorm();
    if (length2_m2 > longest_m2) longest_m2 = length2_m2, first = i;
  }
  const size_t second = (first + 1) % 3, third = (first + 2) % 3;
  const Vector3 &a = corners[first], edge = corners[second] - a, side = corners[third] - a;
  const Vector3 height = side - (side.dot(edge) / longest_m2) * edge;
  const double height2_m2 = height.squaredNorm();
  if (!(longest_m2 > 0.0 && height2_m2 > 0.0)) return nearest_of_edges(corners);
  Weights3 weights;
  weights[third] = -a.dot(height) / height2_m2;
  weights[second] = -(a + weights[third] * side).dot(edge) / longest_m2;
  weights[first] = 1.0 - weights[second] - weights[third];
  const bool inside = weights[0] > 0.0 && weights[1] > 0.0 && weights[2] > 0.0;
  return inside ? weights : nearest_of_edges(corners);
}

/// The search for the gap of one pair. Everything is in the frame of core a.
class Search {
 public:
  Search(const ConvexSolid& a, const ConvexSolid& b)
      : a_(a), b_(b), b_from_a_m_(rotated_back(a.rotation, b.centre - a.centre)) {
    for (int i = 0; i < 3; ++i) rotation_.col(i) = rotated_back(a.rotation, b.rotation.col(i));
  }

  SolidGap gap(const Vector3& guess, double enough_m) {
    search(guess, enough_m);
    if (overlap_) part();
    return result();
  }

  double distance_m(const Vector3& guess, double enough_m) {
    search(guess, enough_m);
    return result().distance_m;
  }

 private:
  void search(const Vector3& guess, double enough_m) {
    best_direction_ = normalised(rotated_back(a_.rotation, guess));
    iterate(best_direction_, enough_m + a_.radius_m + b_.radius_m);
  }

  static Vector3 normalised(const Vector3& v) {
    const double norm = v.norm();
    return norm > 0.0 ? Vector3(v / norm) : Vector3(Vector3::UnitZ());
  }

  /// The vertex of a - b that lies farthest against a direction.
  Vertex farthest_against(const Vector3& direction) {
    Vertex vertex;
    vertex.a = support(a_, -direction, vertex_of_a_);
    vertex.b = rotated(rotation_, support(b_, rotated_back(rotation_, direction), vertex_of_b_)) + b_from_a_m_;
    vertex.difference = vertex.a - vertex.b;
    return vertex;
  }

  /// Keeps the direction along which the cores are the farthest apart, or overlap the least. Its separation is a lower
  /// bound of their distance.
  void consider(const Vector3& direction, double separation_m) {
    if (!(separation_m > separation_m_)) return;
    separation_m_ = separation_m;
    best_direction_ = direction;
  }
  void consider(const Vector3& direction) {
    consider(direction, direction.dot(farthest_against(direction).difference));
  }

  /// Adds vertices until the nearest point of the simplex is the nearest of a - b. Stops once the distance of the cores
  /// is proven to be at least enough_m.
  void iterate(const Vector3& guess, double enough_m) {
    Vector3 nearest = guess;
    double nearest2_m2 = 1.0, extent2_m2 = 0.0;
    for (int step = 0; step < kMostSteps; ++step) {
      const Vertex vertex = farthest_against(nearest);
      const double along_m2 = nearest.dot(vertex.difference), nearest_m = std::sqrt(nearest2_m2);
      consider(nearest / nearest_m, along_m2 / nearest_m);
      if (step > 0 && (nearest2_m2 - along_m2 <= kRelativeGap * nearest2_m2 || simplex_.contains(vertex.difference)))
        return;
      if (separation_m_ >= enough_m) {
        if (step == 0) add(simplex_, vertex);
        enough_ = true;
        return;
      }
      Simplex next = simplex_;
      add(next, vertex);
      if (!find_nearest(next)) {
        simplex_ = next;
        overlap_ = true;
        return;
      }
      const Vector3 nearer = next.nearest();
      const double nearer2_m2 = nearer.squaredNorm();
      if (step > 0 && nearer2_m2 >= nearest2_m2) return;  // only rounding is left
      simplex_ = next;
      nearest = nearer;
      nearest2_m2 = nearer2_m2;
      extent2_m2 = std::max(extent2_m2, vertex.difference.squaredNorm());
      if (nearest2_m2 <= std::max(kOverlap_m * kOverlap_m, kOverlapShare * kOverlapShare * extent2_m2)) {
        overlap_ = true;
        return;
      }
    }
  }

  static void add(Simplex& simplex, const Vertex& vertex) {
    const size_t last = static_cast<size_t>(simplex.count++);
    simplex.vertices[last] = vertex;
    simplex.weights[last] = last == 0 ? 1.0 : 0.0;
  }

  /// Sets the weights and drops the vertices without one. False if the origin is inside a tetrahedron.
  bool find_nearest(Simplex& simplex) const {
    const auto& v = simplex.vertices;
    if (simplex.count == 2) {
      const Weights2 weights = nearest_of_segment(v[0].difference, v[1].difference);
      std::copy(weights.begin(), weights.end(), simplex.weights.begin());
    } else if (simplex.count == 3) {
      const Weights3 weights = nearest_of_triangle({v[0].difference, v[1].difference, v[2].difference});
      std::copy(weights.begin(), weights.end(), simplex.weights.begin());
    } else if (simplex.count == 4 && !find_nearest_of_tetrahedron(simplex)) {
      return false;
    }
    simplex.drop_unweighted();
    return true;
  }

  /// Only faces between the origin and the fourth vertex count. Where the cores are known to be apart all of them do:
  /// rounding may place the origin inside a flat tetrahedron.
  bool find_nearest_of_tetrahedron(Simplex& simplex) const {
    static constexpr size_t kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    const auto& v = simplex.vertices;
    const bool apart = separation_m_ > 0.0;
    double least_m2 = std::numeric_limits<double>::infinity();
    std::array<double, 4> best{};
    for (const auto& [i, j, k, opposite] : kFaces) {
      const Vector3 &a = v[i].difference, &b = v[j].difference, &c = v[k].difference;
      const Vector3 normal = (b - a).cross(c - a);
      if (!apart && -a.dot(normal) * (v[opposite].difference - a).dot(normal) > 0.0) continue;
      const Weights3 weights = nearest_of_triangle({a, b, c});
      const double distance2_m2 = (weights[0] * a + weights[1] * b + weights[2] * c).squaredNorm();
      if (!(distance2_m2 < least_m2)) continue;
      least_m2 = distance2_m2;
      best = {};
      best[i] = weights[0], best[j] = weights[1], best[k] = weights[2];
    }
    simplex.weights = best;
    return least_m2 < std::numeric_limits<double>::infinity();
  }

  /// Of overlapping cores: the best direction, and the points after a translation along it. The normal after the
  /// translation is a better direction, until none is.
  void part() {
    consider_simplex();
    consider_faces(a_, Matrix3::Identity(), b_from_a_m_, -1.0);
    consider_faces(b_, rotation_, -b_from_a_m_, 1.0);
    for (int round = 0; round < kMostTranslations; ++round) {
      const Vector3 direction = best_direction_;
      const double separation_m = separation_m_;
      consider_normal_after(kPartedMargin_m - separation_m, direction);
      if (separation_m_ - separation_m <= kOverlapGain_m) break;
    }
    if (separation_m_ < -kTouching_m) nudge();
  }

  /// Considers the normal that the pair has after a translation of a along a unit vector. Returns the separation there.
  /// The simplex remains that of the translated pair.
  double consider_normal_after(double by_m, const Vector3& along) {
    const Vector3 shift = by_m * along, direction = best_direction_;
    const double separation_m = separation_m_;
    b_from_a_m_ -= shift;
    simplex_ = {};
    separation_m_ = -std::numeric_limits<double>::infinity();
    iterate(along, std::numeric_limits<double>::infinity());
    const Vector3 normal = best_direction_;
    const double after_m = separation_m_;
    b_from_a_m_ += shift;
    best_direction_ = direction;
    separation_m_ = separation_m;
    consider(normal);
    return after_m;
  }

  /// Cores that touch, or overlap by a few micrometres, come apart by a short translation along one of the axes, whose
  /// angle to the normal of the contact is the smallest: the normal after it is that of the contact. A search that
  /// began along any other direction may have ended in another local minimum of the depth.
  void nudge() {
    const Simplex parted = simplex_;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0})
        if (consider_normal_after(kNudge_m, side * Vector3::Unit(axis)) > 0.0) return;
    simplex_ = parted;
  }

  /// The normals of the simplex around the origin. Where the cores only touch, one of them is that of the contact.
  void consider_simplex() {
    const Simplex around = simplex_;
    for (int i = 2; i < around.count; ++i)
      for (int j = 1; j < i; ++j)
        for (int k = 0; k < j; ++k) {
          const Vector3 &a = around.vertices[i].difference, &b = around.vertices[j].difference;
          const Vector3 normal = normalised((b - a).cross(around.vertices[k].difference - a));
          consider(normal);
          consider(-normal);
        }
  }

  /// The face normals of one core. sign: -1 for core a, because a leaves b against the normal of its own face.
  void consider_faces(const ConvexSolid& solid, const Matrix3& rotation, const Vector3& to_other, double sign) {
    if (solid.kind == CoreKind::kPolyhedron)
      for (const Vector3& normal : solid.polyhedron->normals) consider(sign * rotated(rotation, normal));
    if (solid.kind == CoreKind::kBox)
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) consider(side * rotation.col(axis));
    if (solid.kind == CoreKind::kCylinder) {
      const Vector3 axis = rotation.col(2), across = to_other - to_other.dot(axis) * axis;
      consider(axis);
      consider(-axis);
      if (across.norm() > 1e-9) consider(sign * across.normalized());
    }
  }

  SolidGap result() const {
    Vector3 on_a = Vector3::Zero(), on_b = Vector3::Zero();
    for (size_t i = 0; i < static_cast<size_t>(simplex_.count); ++i) {
      on_a += simplex_.weights[i] * simplex_.vertices[i].a;
      on_b += simplex_.weights[i] * simplex_.vertices[i].b;
    }
    const Vector3 between = on_a - on_b;
    double core_m = between.norm();
    Vector3 normal = core_m > 0.0 ? Vector3(between / core_m) : best_direction_;
    if (overlap_ || enough_) {
      core_m = separation_m_;
      normal = best_direction_;
    }
    if (overlap_) on_b = on_a - core_m * normal;
    const auto in_base = [&](const Vector3& p) { return Vector3(a_.centre + rotated(a_.rotation, p)); };
    return {core_m - a_.radius_m - b_.radius_m, core_m, in_base(on_a), in_base(on_b), rotated(a_.rotation, normal)};
  }

  const ConvexSolid& a_;
  const ConvexSolid& b_;
  Matrix3 rotation_;    ///< a_from_b
  Vector3 b_from_a_m_;  ///< from the origin of core a to that of core b
  int vertex_of_a_ = 0, vertex_of_b_ = 0;
  Simplex simplex_;
  double separation_m_ = -std::numeric_limits<double>::infinity();
  Vector3 best_direction_ = Vector3::UnitZ();
  bool overlap_ = false, enough_ = false;
};

}  // namespace

SolidGap gap_between(const ConvexSolid& a, const ConvexSolid& b, const Vector3& guess, double enough_m) {
  return Search(a, b).gap(guess, enough_m);
}

double distance_between_m(const ConvexSolid& a, const ConvexSolid& b, const Vector3& guess, double enough_m) {
  return Search(a, b).distance_m(guess, enough_m);
}

}  // namespace sidestep
