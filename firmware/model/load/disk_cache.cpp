#include "firmware/model/load/disk_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "firmware/base/hash.h"

namespace sidestep {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLargest_bytes = 1u << 22;

fs::path folder() {
  for (const auto& [variable, below] : {std::pair("XDG_CACHE_HOME", "sidestep"), std::pair("HOME", ".cache/sidestep")})
    if (const char* const value = std::getenv(variable); value && *value) return fs::path(value) / below;
  return {};
}

/// The hash of an entry, in front of it.
std::string label_of(const std::string& line) {
  return fmt::format("{:016x} ", fnv1a(line.data(), line.size()));
}

}  // namespace

std::optional<std::string> read_cache(const std::string& name) {
  const fs::path cache = folder();
  if (cache.empty()) return {};
  std::ifstream stream(cache / name);
  std::string text;
  if (!std::getline(stream, text) || text.size() > kLargest_bytes) return {};
  const size_t label = label_of({}).size();
  const std::string line = text.size() > label ? text.substr(label) : "";
  if (text != label_of(line) + line) return {};  // truncated or altered
  return line;
}

/// Under another name first: two controllers may start at once.
void write_cache(const std::string& name, const std::string& line) {
  const fs::path cache = folder();
  if (cache.empty()) return;
  std::error_code ignored;
  fs::create_directories(cache, ignored);
  const fs::path file = cache / name, draft = file.string() + fmt::format(".{}", getpid());
  std::ofstream stream(draft);
  stream << label_of(line) << line << "\n";
  stream.close();
  if (stream) fs::rename(draft, file, ignored);
  fs::remove(draft, ignored);
}

}  // namespace sidestep
