#pragma once

#include <string>

namespace sidestep::test {

/// The folder for this process's temporary files, created by the first call and removed when the process ends.
const std::string& scratch_folder();

/// Writes a file into the scratch folder and returns its path.
std::string scratch_file(const std::string& name, const std::string& text);

/// A whole file as text; fails the test when it cannot be read.
std::string text_of(const std::string& file);

/// The text with the first occurrence of `from` replaced; fails the test if there is none, so that a change of the file
/// cannot make the replacement ineffective.
std::string replaced(const std::string& text, const std::string& from, const std::string& to);

}  // namespace sidestep::test
