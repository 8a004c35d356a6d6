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

/// The file that a mesh of a URDF names. `package://NAME/rest` is looked for in each folder of package_path, then of
/// ROS_PACKAGE_PATH, then from the URDF's folder upwards: there as NAME/rest, or as rest where the folder itself is
/// called NAME. `file://` and absolute names stand for themselves; relative ones are looked for from the URDF's folder
/// upwards. Throws std::runtime_error, one line with the name and where it was looked for.
std::string find_mesh(const std::string& name, const std::string& urdf_file,
                      const std::vector<std::string>& package_path);

/// Reads an STL, DAE or OBJ file. DAE: its unit is honoured, its up axis is not (as the ROS tools do). Each coordinate
/// is then multiplied by its scale. Throws std::runtime_error, one line naming the file, unless it holds triangles with
/// finite corners within 100 m.
Mesh load_mesh(const std::string& file, const Vector3& scale);

}  // namespace sidestep
