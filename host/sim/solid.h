#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

namespace sidestep::sim {

/// The first three have the values of obstacle_t.
enum class Shape { kSphere = 0, kCapsule = 1, kBox = 2, kCylinder = 3, kMesh = 4 };

/// The triangles of a mesh as FCL holds them.
struct Surface;

/// A shape around its own centre. size_m: sphere {radius, 0, 0}; capsule {radius, distance between the cap centres, 0}
/// and cylinder {radius, length, 0} along local z; box {edge, edge, edge}; mesh {full edges of its bounding box around
/// the centre}.
struct Solid {
  Shape shape = Shape::kSphere;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  std::shared_ptr<const Surface> surface = nullptr;  ///< of a mesh
};

/// A mesh file as a solid, and where its centre is in the frame of the file.
struct CentredMesh {
  Solid solid;
  Eigen::Vector3d centre_m;
};

/// Reads a mesh that a URDF names (firmware/model/load/mesh.h). Throws std::runtime_error, one line.
CentredMesh load_mesh_solid(const std::string& name, const std::string& urdf_file,
                            const std::vector<std::string>& package_path, const Eigen::Vector3d& scale);

/// Radius of the smallest sphere around the centre that holds the solid, m.
double bounding_radius_m(const Solid& solid);

/// Signed distance between the surfaces of a and b, m, with FCL: zero when touching, negative and finite when they
/// penetrate.
///
/// Exact to 1e-9 m when apart (two boxes: 1e-3 m, rarely a few). Penetration is exact when one of the two is a sphere;
/// for a capsule it is that of the deepest sphere along its axis, exact until the axis itself enters the other solid
/// and a lower bound of the depth from there on; for a box against a box or a cylinder it is an upper bound.
/// A mesh is its surface only: what is wholly inside counts as apart.
double signed_distance_m(const Solid& a, const Eigen::Isometry3d& base_from_a, const Solid& b,
                         const Eigen::Isometry3d& base_from_b);

}  // namespace sidestep::sim
