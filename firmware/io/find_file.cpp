#include "firmware/io/find_file.h"

#include <filesystem>

namespace sidestep {
namespace {

namespace fs = std::filesystem;

/// What the system cannot look up, as a name that is too long, is not there.
bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

fs::path find_upwards(fs::path folder, const fs::path& name) {
  for (;; folder = folder.parent_path()) {
    if (is_file(folder / name)) return folder / name;
    if (folder == folder.root_path()) return {};
  }
}

/// PREFIX/share/sidestep for the program PREFIX/bin/NAME.
fs::path installed_folder() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path().parent_path() / "share/sidestep";
}

}  // namespace

std::string find_file(const std::string& name, const std::string& beside) {
  fs::path found;
  if (!beside.empty()) found = find_upwards(fs::absolute(beside).parent_path(), name);
  if (found.empty()) found = find_upwards(fs::current_path(), name);
  if (found.empty() && is_file(installed_folder() / name)) found = installed_folder() / name;
  return found.lexically_normal().string();
}

}  // namespace sidestep
