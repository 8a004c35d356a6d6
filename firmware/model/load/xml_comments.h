#pragma once

#include <string>

namespace sidestep {

/// The text of an XML file without its <!-- comments -->. A comment without an end reaches to the end of the text.
std::string without_comments(std::string xml);

}  // namespace sidestep
