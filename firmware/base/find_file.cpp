#include "firmware/base/find_file.h"

#include <dlfcn.h>

#include <array>
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

/// The files that this code may be running from: the program, or a library in a program of somebody else.
std::array<fs::path, 2> own_files() {
  std::error_code ignored;
  Dl_info library{};
  dladdr(reinterpret_cast<const void*>(&find_file), &library);
  return {fs::read_symlink("/proc/self/exe", ignored), library.dli_fname ? library.dli_fname : ""};
}

}  // namespace

std::string find_file(const std::string& name, const std::string& beside) {
  fs::path found;
  if (!beside.empty()) found = find_upwards(fs::absolute(beside).parent_path(), name);
  if (found.empty()) found = find_upwards(fs::current_path(), name);
  for (const fs::path& own : own_files())
    if (found.empty()) found = find_upwards(fs::absolute(own).parent_path(), "share/sidestep" / fs::path(name));
  return found.lexically_normal().string();
}

}  // namespace sidestep
