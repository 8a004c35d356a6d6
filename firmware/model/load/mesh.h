#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/model/types.h"

namespace sidestep {

/// Triangles, m. Every vertex is a corner of at least one triangle.
struct Mesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< three indices of vertices each
};

/// The path of the file that a URDF's mesh element names. `package://NAME/rest` is searched in each folder of
/// package_path, then of ROS_PACKAGE_PATH, then in the URDF's folder and the folders above it: as NAME/rest, or as rest
/// in a folder called NAME. `file://PATH` and absolute names are used as they are. A relative name is searched in the
/// URDF's folder and the folders above it. Throws std::runtime_error, one line with the name and the searched places.
std::string find_mesh(const std::string& name, const std::string& urdf_file,
                      const std::vector<std::string>& package_path);

/// Reads an STL, DAE or OBJ file of at most 256 MB. The unit of a DAE file is applied, its up axis is ignored (as by
/// the ROS tools). Each coordinate is then multiplied by its scale, which must be finite and not 0. Throws
/// std::runtime_error, one line that names the file, unless the file contains at least one triangle, and all corners
/// have finite coordinates within 100 m.
Mesh load_mesh(const std::string& file, const Vector3& scale);

}  // namespace sidestep
