#include "firmware/base/find_file.h"

#include <dlfcn.h>

#include <array>
#include <filesystem>

namespace sidestep {
namespace {

namespace fs = std::filesystem;

/// The files that may contain this code: the running program, or a library that another program has loaded.
std::array<fs::path, 2> own_files() {
  std::error_code ignored;
  Dl_info library{};
  dladdr(reinterpret_cast<const void*>(&find_file), &library);
  return {fs::read_symlink("/proc/self/exe", ignored), library.dli_fname ? library.dli_fname : ""};
}

}  // namespace

bool is_file(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string folder_above(const std::string& folder) {
  const fs::path above = fs::path(folder).parent_path();
  return above == fs::path(folder) ? "" : above.string();
}

std::string find_upwards(const std::string& folder, const std::string& name) {
  for (std::string above = folder; !above.empty(); above = folder_above(above))
    if (const fs::path file = fs::path(above) / name; is_file(file.string())) return file.string();
  return {};
}

std::string find_file(const std::string& name, const std::string& reference) {
  std::string found;
  if (!reference.empty()) found = find_upwards(fs::absolute(reference).parent_path().string(), name);
  if (found.empty()) found = find_upwards(fs::current_path().string(), name);
  const std::string shared = ("share/sidestep" / fs::path(name)).string();
  for (const fs::path& own : own_files())
    if (found.empty()) found = find_upwards(fs::absolute(own).parent_path().string(), shared);
  return fs::path(found).lexically_normal().string();
}

}  // namespace sidestep
