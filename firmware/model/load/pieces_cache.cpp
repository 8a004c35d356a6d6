#include "firmware/model/load/pieces_cache.h"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "firmware/base/hash.h"
#include "firmware/model/load/disk_cache.h"

namespace sidestep {
namespace {

constexpr std::uint64_t kVersion = 5;  // raise it whenever split_mesh() changes its results

std::uint64_t hash_of(const Mesh& mesh, int most) {
  std::uint64_t value = fnv1a(&kVersion, sizeof(kVersion));
  value = fnv1a(&most, sizeof(most), value);
  value = fnv1a(mesh.vertices.data(), mesh.vertices.size() * sizeof(mesh.vertices[0]), value);
  return fnv1a(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), value);
}

/// Both excesses, then of each piece the radius, the number of vertices and the vertices, as hexadecimal floats, which
/// are exact.
std::string to_text(const MeshPieces& split) {
  std::string line = fmt::format("{:a} {:a}", split.excess_p95_m, split.excess_m);
  for (const MeshPiece& piece : split.pieces) {
    line += fmt::format(" {:a} {}", piece.radius_m, piece.polyhedron->vertices.size());
    for (const Vector3& p : piece.polyhedron->vertices) line += fmt::format(" {:a} {:a} {:a}", p.x(), p.y(), p.z());
  }
  return line;
}

MeshPieces from_text(const std::string& line) {
  std::istringstream words(line);
  const auto number = [&] {
    std::string word;
    words >> word;
    return std::strtod(word.c_str(), nullptr);
  };
  MeshPieces split;
  split.excess_p95_m = number();
  split.excess_m = number();
  while (words >> std::ws && !words.eof()) {
    const double radius_m = number();
    std::vector<Vector3> vertices(static_cast<size_t>(number()));
    for (Vector3& p : vertices)
      for (int axis = 0; axis < 3; ++axis) p[axis] = number();
    split.pieces.push_back({std::make_shared<Polyhedron>(polyhedron_of(convex_hull(vertices))), radius_m});
  }
  return split;
}

}  // namespace

/// Also a fresh result is read from its text: a hull orders the vertices of another hull differently, and so the first
/// start would differ from the later ones in the last bits.
MeshPieces split_mesh_cached(const Mesh& mesh, int most) {
  const std::string name = fmt::format("{:016x}.pieces", hash_of(mesh, most));
  if (const std::optional<std::string> known = read_cache(name)) return from_text(*known);
  const std::string line = to_text(split_mesh(mesh, most));
  write_cache(name, line);
  return from_text(line);
}

}  // namespace sidestep
