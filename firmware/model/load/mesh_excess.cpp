#include "firmware/model/load/mesh_excess.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sidestep {
namespace {

constexpr int kSamples = 6000;      // of the surface
constexpr int kClimbs = 40;         // of so many samples the largest excess nearby is searched
constexpr int kHalvings = 5;        // of the steps of this search
constexpr double kMargin_m = 1e-9;  // the shortest edge that counts

/// A point of the surface of all pieces, with the area that it stands for.
struct Sample {
  double excess_m, area_m2;
  size_t piece, face;
  double u, v;  ///< shares of the edges from the first corner of the face to the others
};

/// The surfaces of all pieces: their faces, moved outward by the rounding radius, where they lie in no other piece.
class Surface {
 public:
  Surface(const std::vector<ConvexHull>& hulls, const std::vector<MeshPiece>& pieces, const MeshDistance& mesh)
      : hulls_(hulls), pieces_(pieces), mesh_(mesh) {}

  double area_m2() const {
    double sum_m2 = 0.0;
    for (size_t piece = 0; piece < hulls_.size(); ++piece)
      for (size_t face = 0; face < hulls_[piece].faces.size(); ++face) sum_m2 += area_m2(edges(piece, face));
    return sum_m2;
  }

  /// Samples of a piece. The corners stand for no area.
  void sample(size_t piece, double per_sample_m2, std::vector<Sample>& samples) const {
    for (size_t face = 0; face < hulls_[piece].faces.size(); ++face) {
      const double face_m2 = area_m2(edges(piece, face));
      const auto add = [&](double u, double v, double share_m2) {
        if (const auto found_m = excess_m(piece, face, u, v))
          samples.push_back({*found_m, share_m2, piece, face, u, v});
      };
      add(0.0, 0.0, 0.0), add(1.0, 0.0, 0.0), add(0.0, 1.0, 0.0);
      const int rows = std::max(1, static_cast<int>(std::lround(std::sqrt(face_m2 / per_sample_m2))));
      // The centres of rows^2 congruent triangles.
      for (int i = 0; i < rows; ++i)
        for (int j = 0; j < 2 * (rows - i) - 1; ++j) {
          const double third = j % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
          const int column = j / 2;
          add((i + third) / rows, (column + third) / rows, face_m2 / (rows * rows));
        }
    }
  }

  /// Moves a sample over its face to where the excess is larger, in steps that begin at step_m and are halved.
  void climb(Sample& sample, double step_m) const {
    const auto [ab, ac] = edges(sample.piece, sample.face);
    for (int halvings = 0; halvings < kHalvings; ++halvings, step_m *= 0.5) {
      const double du = step_m / std::max(ab.norm(), kMargin_m), dv = step_m / std::max(ac.norm(), kMargin_m);
      const Sample centre = sample;
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) {
          const double u = centre.u + i * du, v = centre.v + j * dv;
          if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
          const auto found_m = excess_m(sample.piece, sample.face, u, v);
          if (found_m && *found_m > sample.excess_m) sample.excess_m = *found_m, sample.u = u, sample.v = v;
        }
    }
  }

 private:
  using Edges = std::pair<Vector3, Vector3>;  ///< from the first corner of a face to the others

  Edges edges(size_t piece, size_t face) const {
    const auto& [a, b, c] = hulls_[piece].faces[face].corners;
    const auto corner = [&](int i) { return hulls_[piece].vertices[static_cast<size_t>(i)]; };
    return {corner(b) - corner(a), corner(c) - corner(a)};
  }
  static double area_m2(const Edges& edges) { return 0.5 * edges.first.cross(edges.second).norm(); }

  /// Nothing inside another piece.
  std::optional<double> excess_m(size_t piece, size_t face, double u, double v) const {
    const ConvexHull& hull = hulls_[piece];
    const auto [ab, ac] = edges(piece, face);
    const Vector3 p = hull.vertices[static_cast<size_t>(hull.faces[face].corners[0])] + u * ab + v * ac +
                      pieces_[piece].radius_m * hull.faces[face].normal;
    for (size_t other = 0; other < hulls_.size(); ++other)
      if (other != piece && hulls_[other].outside_m(p) < pieces_[other].radius_m) return std::nullopt;
    return mesh_.to_m(p);
  }

  const std::vector<ConvexHull>& hulls_;
  const std::vector<MeshPiece>& pieces_;
  const MeshDistance& mesh_;
};

}  // namespace

size_t measure_excess(const std::vector<ConvexHull>& hulls, const MeshDistance& mesh, MeshPieces& pieces) {
  const Surface surface(hulls, pieces.pieces, mesh);
  const double per_sample_m2 = surface.area_m2() / kSamples;
  std::vector<Sample> samples;
  for (size_t piece = 0; piece < hulls.size(); ++piece) surface.sample(piece, per_sample_m2, samples);
  if (samples.empty()) return 0;
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.excess_m < b.excess_m; });
  double outer_m2 = 0.0, below_m2 = 0.0;
  for (const Sample& sample : samples) outer_m2 += sample.area_m2;
  for (const Sample& sample : samples) {
    below_m2 += sample.area_m2;
    if (below_m2 <= 0.95 * outer_m2) pieces.excess_p95_m = sample.excess_m;
  }
  const size_t first = samples.size() - std::min(samples.size(), static_cast<size_t>(kClimbs));
  for (size_t i = first; i < samples.size(); ++i) surface.climb(samples[i], std::sqrt(per_sample_m2));
  const auto largest = std::max_element(samples.begin() + static_cast<std::ptrdiff_t>(first), samples.end(),
                                        [](const Sample& a, const Sample& b) { return a.excess_m < b.excess_m; });
  pieces.excess_m = largest->excess_m;
  return largest->piece;
}

}  // namespace sidestep
