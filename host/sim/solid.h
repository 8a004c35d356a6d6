#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace sidestep::sim {

/// The first three values are those of obstacle_t.
enum class Shape { kSphere = 0, kCapsule = 1, kBox = 2, kCylinder = 3, kMesh = 4 };

/// The triangles of a mesh in FCL's form.
struct Surface;

/// A shape around its own centre. size_m: sphere {radius, 0, 0}; capsule {radius, distance between the cap centres, 0}
/// and cylinder {radius, length, 0} along local z; box {edge, edge, edge}; mesh {full edges of its bounding box around
/// the centre}.
struct Solid {
  Shape shape = Shape::kSphere;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  std::shared_ptr<const Surface> surface = nullptr;  ///< of a mesh
};

/// A mesh file as a solid, and the position of its centre in the frame of the file.
struct CentredMesh {
  Solid solid;
  Eigen::Vector3d centre_m;
};

/// Reads a mesh of a URDF (firmware/model/load/mesh.h). Throws std::runtime_error, one line.
CentredMesh load_mesh_solid(const std::string& name, const std::string& urdf_file,
                            const std::vector<std::string>& package_path, const Eigen::Vector3d& scale);

/// Shape and size in the form of a scenario: "shape: sphere, radius_m: 0.1". Not for meshes.
std::string to_yaml(const Solid& solid);

/// Radius of the smallest sphere around the centre that contains the solid, m.
double bounding_radius_m(const Solid& solid);

/// Signed distance between the surfaces of a and b, m, with FCL: zero when touching, negative and finite when they
/// penetrate.
///
/// Separated solids: exact to 1e-9 m (two boxes: 1e-3 m, rarely a few 1e-3 m).
/// Penetration of a sphere is exact. Penetration of a capsule is that of the deepest sphere along its axis: exact until
/// the axis enters the other solid, then a lower bound of the depth. Penetration of a box and a box or a cylinder is an
/// upper bound of the depth, and so is that of two cylinders, which is at most what separates them across both axes.
/// A mesh is a surface without volume: a solid wholly inside it counts as separated.
/// Of solids that are farther apart than within_m some positive distance of at least within_m is returned, which costs
/// much less for meshes.
double signed_distance_m(const Solid& a, const Eigen::Isometry3d& base_from_a, const Solid& b,
                         const Eigen::Isometry3d& base_from_b,
                         double within_m = std::numeric_limits<double>::infinity());

}  // namespace sidestep::sim
