#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

namespace sidestep {

/// Reads a URDF of at most 20000 tags. Throws std::runtime_error, one line that names the file, also for an error that
/// urdfdom would only report and then skip the element.
urdf::ModelInterfaceSharedPtr read_urdf(const std::string& file);

/// Whether the joint to the link's parent is fixed; false for the root.
bool is_fixed(const urdf::Link& link);

}  // namespace sidestep
