#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

namespace sidestep {

/// Reads a URDF. Throws std::runtime_error, one line naming the file, also where urdfdom would complain and go on
/// without the element that it complains about.
urdf::ModelInterfaceSharedPtr read_urdf(const std::string& file);

/// Whether a fixed joint holds the link.
bool is_fixed(const urdf::Link& link);

}  // namespace sidestep
