#pragma once

#include <vector>

#include "firmware/model/load/mesh.h"

namespace sidestep {

/// Distances to the triangles of a mesh, by a tree of bounding boxes.
class MeshDistance {
 public:
  /// The mesh has at least one triangle and must outlive this.
  explicit MeshDistance(const Mesh& mesh);

  /// From p to the nearest point of the surface, m.
  double to_m(const Vector3& p) const;

 private:
  struct Node {
    Vector3 lower, upper;
    int first, count;  ///< a leaf's part of triangles_; count 0: the two nodes from `first` on
  };
  void build(int node, int first, int count);
  double box_distance_m(const Node& node, const Vector3& p) const;
  void search(int node, const Vector3& p, double& least_m) const;

  const Mesh& mesh_;
  std::vector<int> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace sidestep
