#include "firmware/model/load/mesh_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "firmware/model/gjk.h"
#include "firmware/model/load/mesh_excess.h"

namespace sidestep {
namespace {

// The largest excess is up to 0.5 mm more than that of the samples.
constexpr double kEnoughP95_m = 0.0045, kEnough_m = 0.01;
constexpr int kCells = 32;          // of the grid, along each axis
constexpr int kThinning = 48;       // points of one cell of so many along the longest edge count once in a candidate
constexpr int kCutsPerPiece = 3;    // so many more parts than pieces, which are then merged
constexpr double kRadius_m = 5e-4;  // vertices are added until the rounding radius is below this
constexpr double kMargin_m = 1e-9;  // added to radii; more than the rounding error

using Triangle = std::array<Vector3, 3>;

/// A part of the surface and of the inside, and the hull around it.
struct Part {
  std::vector<Triangle> triangles;
  ConvexHull hull;
  MeshPiece piece;
  ConvexHull piece_hull;  ///< of the piece's polyhedron
};

struct Plane {
  int axis;
  double at_m;
};

/// The halves of a triangle: its corners on one side of a plane, and the points where its edges cross it.
std::vector<Vector3> clipped(const Triangle& triangle, const Plane& plane, double side) {
  std::vector<Vector3> polygon;
  for (size_t i = 0; i < 3; ++i) {
    const Vector3 &a = triangle[i], &b = triangle[(i + 1) % 3];
    const double from_a_m = side * (a[plane.axis] - plane.at_m), from_b_m = side * (b[plane.axis] - plane.at_m);
    if (from_a_m >= 0.0) polygon.push_back(a);
    if (from_a_m * from_b_m < 0.0) polygon.push_back(a + from_a_m / (from_a_m - from_b_m) * (b - a));
  }
  return polygon;
}

std::vector<Triangle> half_of(const std::vector<Triangle>& triangles, const Plane& plane, double side) {
  std::vector<Triangle> half;
  for (const Triangle& triangle : triangles) {
    const std::vector<Vector3> polygon = clipped(triangle, plane, side);
    for (size_t i = 2; i < polygon.size(); ++i) half.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  return half;
}

std::vector<Vector3> corners_of(const std::vector<Triangle>& triangles) {
  std::vector<Vector3> corners;
  for (const Triangle& triangle : triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

/// One point of each cell of a grid.
std::vector<Vector3> thinned(const std::vector<Vector3>& points, double cell_m) {
  std::vector<std::pair<std::array<int, 3>, size_t>> cells;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector3 cell = (points[i] / cell_m).array().floor();
    cells.push_back({{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}, i});
  }
  std::sort(cells.begin(), cells.end());
  std::vector<Vector3> kept;
  for (size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || cells[i].first != cells[i - 1].first) kept.push_back(points[cells[i].second]);
  return kept;
}

/// The points below and above a plane, and on both sides those where edges of the triangles cross it.
std::array<std::vector<Vector3>, 2> points_beside(const std::vector<Vector3>& points,
                                                  const std::vector<Triangle>& triangles, const Plane& plane) {
  std::array<std::vector<Vector3>, 2> sides;
  for (const Vector3& p : points) {
    if (p[plane.axis] <= plane.at_m) sides[0].push_back(p);
    if (p[plane.axis] >= plane.at_m) sides[1].push_back(p);
  }
  for (const Triangle& triangle : triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vector3 &a = triangle[i], &b = triangle[(i + 1) % 3];
      const double from_a_m = a[plane.axis] - plane.at_m, from_b_m = b[plane.axis] - plane.at_m;
      if (from_a_m * from_b_m >= 0.0) continue;
      for (auto& side : sides) side.emplace_back(a + from_a_m / (from_a_m - from_b_m) * (b - a));
    }
  return sides;
}

/// Planes at equal distances across each axis through the bounding box of a mesh. Cuts are made along these.
struct Grid {
  Vector3 lower, cell_m;

  explicit Grid(const Mesh& mesh) : lower(mesh.vertices.front()) {
    Vector3 upper = lower;
    for (const Vector3& p : mesh.vertices) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
    cell_m = (upper - lower) / kCells;
  }
  double at_m(int axis, int i) const { return lower[axis] + i * cell_m[axis]; }
  int below(int axis, double at) const {
    return cell_m[axis] > 0.0 ? std::clamp(static_cast<int>((at - lower[axis]) / cell_m[axis]), 0, kCells) : 0;
  }
};

/// The first and the last point of a surface on each line of the grid along one axis.
class Lines {
 public:
  Lines(const Mesh& mesh, const Grid& grid, int axis)
      : grid_(grid), axis_(axis), ranges_m_((kCells + 1) * (kCells + 1)) {
    for (const auto& [i, j, k] : mesh.triangles)
      add(mesh.vertices[static_cast<size_t>(i)], mesh.vertices[static_cast<size_t>(j)],
          mesh.vertices[static_cast<size_t>(k)]);
  }
  /// Whether a node of the grid lies between surfaces on its line.
  bool encloses(const std::array<int, 3>& node) const {
    const auto& [first_m, last_m] = ranges_m_[index_of(node[static_cast<size_t>(u())], node[static_cast<size_t>(v())])];
    const double at_m = grid_.at_m(axis_, node[static_cast<size_t>(axis_)]);
    return first_m <= at_m && at_m <= last_m;
  }

 private:
  int u() const { return (axis_ + 1) % 3; }
  int v() const { return (axis_ + 2) % 3; }
  /// Of the line through node i along u and node j along v.
  static size_t index_of(int i, int j) { return static_cast<size_t>(i) * (kCells + 1) + static_cast<size_t>(j); }

  void add(const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 ab = b - a, ac = c - a, low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const double area2 = ab[u()] * ac[v()] - ab[v()] * ac[u()];
    if (area2 == 0.0) return;
    for (int i = grid_.below(u(), low[u()]); i <= grid_.below(u(), high[u()]); ++i)
      for (int j = grid_.below(v(), low[v()]); j <= grid_.below(v(), high[v()]); ++j) {
        const double pu_m = grid_.at_m(u(), i) - a[u()], pv_m = grid_.at_m(v(), j) - a[v()];
        const double s = (pu_m * ac[v()] - pv_m * ac[u()]) / area2, t = (ab[u()] * pv_m - ab[v()] * pu_m) / area2;
        const double rounding = 1e-9;
        if (s < -rounding || t < -rounding || s + t > 1.0 + rounding) continue;
        auto& [first_m, last_m] = ranges_m_[index_of(i, j)];
        const double at_m = a[axis_] + s * ab[axis_] + t * ac[axis_];
        first_m = std::min(first_m, at_m);
        last_m = std::max(last_m, at_m);
      }
  }

  struct Range {
    double first_m = std::numeric_limits<double>::infinity(), last_m = -first_m;
  };
  const Grid& grid_;
  int axis_;
  std::vector<Range> ranges_m_;
};

/// The nodes of the grid that lie between surfaces along all three axes, as segments along z (triangles without area).
/// Without them, parts of the surface around one inside would each have a hull of their own, with a hollow between
/// them. A hollow that is open along an axis stays one.
std::vector<Triangle> inside_of(const Mesh& mesh, const Grid& grid) {
  const Lines along_x(mesh, grid, 0), along_y(mesh, grid, 1), along_z(mesh, grid, 2);
  std::vector<Triangle> inside;
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      int first = -1;
      for (int k = 0; k <= kCells + 1; ++k) {
        const std::array<int, 3> node{i, j, k};
        const bool within = k <= kCells && along_x.encloses(node) && along_y.encloses(node) && along_z.encloses(node);
        if (within && first < 0) first = k;
        if (within || first < 0) continue;
        const Vector3 bottom(grid.at_m(0, i), grid.at_m(1, j), grid.at_m(2, first));
        const Vector3 top(bottom.x(), bottom.y(), grid.at_m(2, k - 1));
        inside.push_back({bottom, top, top});
        first = -1;
      }
    }
  return inside;
}

/// The plane that reduces the volume most; where none does, the middle one across the longest edge. The candidates'
/// volumes are those of thinned points.
Plane best_cut(const Part& part, const Grid& grid) {
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (const Vector3& p : part.hull.vertices) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  const double cell_m = (upper - lower).maxCoeff() / kThinning;
  const std::vector<Vector3> corners = thinned(corners_of(part.triangles), cell_m);
  double least_m3 = convex_hull(corners).volume_m3;
  int longest = 0;
  (upper - lower).maxCoeff(&longest);
  Plane best{longest, 0.5 * (lower[longest] + upper[longest])};
  for (int axis = 0; axis < 3; ++axis) {
    const int stride = upper[axis] - lower[axis] > 0.5 * kCells * grid.cell_m[axis] ? 2 : 1;
    for (int i = 1; i < kCells; ++i) {
      const Plane plane{axis, grid.at_m(axis, i)};
      if (i % stride != 0 || plane.at_m <= lower[axis] || plane.at_m >= upper[axis]) continue;
      double halves_m3 = 0.0;
      for (const std::vector<Vector3>& side : points_beside(corners, part.triangles, plane))
        if (!side.empty()) halves_m3 += convex_hull(thinned(side, cell_m)).volume_m3;
      if (halves_m3 < least_m3) least_m3 = halves_m3, best = plane;
    }
  }
  return best;
}

/// Vertices of a hull, each the farthest from the hull of those before it.
ConvexHull reduced(const ConvexHull& hull) {
  if (hull.vertices.size() <= static_cast<size_t>(kMostVertices)) return hull;
  std::vector<Vector3> chosen;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      chosen.push_back(*std::max_element(hull.vertices.begin(), hull.vertices.end(), [&](const auto& a, const auto& b) {
        return side * a[axis] < side * b[axis];
      }));
  ConvexHull inner = convex_hull(chosen);
  while (inner.vertices.size() < static_cast<size_t>(kMostVertices)) {
    const Vector3* farthest = nullptr;
    double largest_m = kRadius_m;
    for (const Vector3& p : hull.vertices)
      if (const double outside_m = inner.outside_m(p); outside_m > largest_m) largest_m = outside_m, farthest = &p;
    if (!farthest) break;
    chosen = inner.vertices;
    chosen.push_back(*farthest);
    inner = convex_hull(chosen);
  }
  return inner;
}

MeshPiece piece_of(const ConvexHull& hull) {
  const auto polyhedron = std::make_shared<Polyhedron>(polyhedron_of(reduced(hull)));
  ConvexSolid solid;
  solid.kind = CoreKind::kPolyhedron;
  solid.polyhedron = polyhedron.get();
  double radius_m = 0.0;
  for (const Vector3& p : hull.vertices) {
    const ConvexSolid point = ConvexSolid::of(Capsule{p, p, 0.0});
    radius_m = std::max(radius_m, gap_between(solid, point, Vector3(solid.centre - p)).distance_m);
  }
  return {polyhedron, radius_m + kMargin_m};
}

Part part_of(std::vector<Triangle> triangles, ConvexHull hull) {
  MeshPiece piece = piece_of(hull);
  ConvexHull piece_hull = convex_hull(piece.polyhedron->vertices);
  return {std::move(triangles), std::move(hull), std::move(piece), std::move(piece_hull)};
}

Part part_of(std::vector<Triangle> triangles) {
  ConvexHull hull = convex_hull(corners_of(triangles));
  return part_of(std::move(triangles), std::move(hull));
}

bool is_enough(const MeshPieces& pieces) {
  return pieces.excess_p95_m <= kEnoughP95_m && pieces.excess_m <= kEnough_m;
}

MeshPieces pieces_of(const std::vector<Part>& parts, const MeshDistance& mesh, size_t& worst) {
  MeshPieces result;
  std::vector<ConvexHull> hulls;
  for (const Part& part : parts) {
    result.pieces.push_back(part.piece);
    hulls.push_back(part.piece_hull);
  }
  worst = measure_excess(hulls, mesh, result);
  return result;
}

/// Cuts the part with the largest excess, until the excess is small or there are `most`. Returns what it has then.
MeshPieces split(std::vector<Part>& parts, const Grid& grid, size_t most, const MeshDistance& mesh) {
  for (;;) {
    size_t worst = 0;
    MeshPieces pieces = pieces_of(parts, mesh, worst);
    if (parts.size() >= most || is_enough(pieces)) return pieces;
    const Plane plane = best_cut(parts[worst], grid);
    std::vector<Triangle> halves[] = {half_of(parts[worst].triangles, plane, -1.0),
                                      half_of(parts[worst].triangles, plane, 1.0)};
    if (halves[0].empty() || halves[1].empty()) return pieces;
    parts[worst] = part_of(std::move(halves[0]));
    parts.push_back(part_of(std::move(halves[1])));
  }
}

ConvexHull common_hull(const Part& a, const Part& b) {
  std::vector<Vector3> vertices = a.hull.vertices;
  vertices.insert(vertices.end(), b.hull.vertices.begin(), b.hull.vertices.end());
  return convex_hull(vertices);
}

/// Merges the two parts whose common hull adds the least volume.
void merge_best(std::vector<Part>& parts) {
  size_t first = 0, second = 1;
  double least_m3 = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < parts.size(); ++i)
    for (size_t j = i + 1; j < parts.size(); ++j) {
      const double added_m3 =
          common_hull(parts[i], parts[j]).volume_m3 - parts[i].hull.volume_m3 - parts[j].hull.volume_m3;
      if (added_m3 < least_m3) least_m3 = added_m3, first = i, second = j;
    }
  parts[first] = part_of({}, common_hull(parts[first], parts[second]));
  parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(second));
}

}  // namespace

MeshPieces split_mesh(const Mesh& mesh, int most) {
  const MeshDistance distance(mesh);
  const Grid grid(mesh);
  std::vector<Triangle> triangles = inside_of(mesh, grid);
  const auto corner = [&](int i) { return mesh.vertices[static_cast<size_t>(i)]; };
  for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({corner(a), corner(b), corner(c)});
  std::vector<Part> parts{part_of(std::move(triangles))};
  const size_t most_parts = most > 1 ? static_cast<size_t>(kCutsPerPiece) * static_cast<size_t>(most) : 1;
  MeshPieces result = split(parts, grid, most_parts, distance);
  while (parts.size() > 1) {
    merge_best(parts);
    size_t worst = 0;
    MeshPieces fewer = pieces_of(parts, distance, worst);
    if (static_cast<int>(result.pieces.size()) <= most && !is_enough(fewer)) break;
    result = std::move(fewer);
  }
  return result;
}

}  // namespace sidestep
