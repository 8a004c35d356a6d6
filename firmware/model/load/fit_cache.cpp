#include "firmware/model/load/fit_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "firmware/base/hash.h"

namespace sidestep {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFitVersion = 1;  // raise it whenever fit_capsules() changes its results

std::uint64_t hash_of(const Mesh& mesh, int most) {
  std::uint64_t value = fnv1a(&kFitVersion, sizeof(kFitVersion));
  value = fnv1a(&most, sizeof(most), value);
  value = fnv1a(mesh.vertices.data(), mesh.vertices.size() * sizeof(mesh.vertices[0]), value);
  return fnv1a(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), value);
}

fs::path folder() {
  for (const auto& [variable, below] : {std::pair("XDG_CACHE_HOME", "sidestep"), std::pair("HOME", ".cache/sidestep")})
    if (const char* const value = std::getenv(variable); value && *value) return fs::path(value) / below;
  return {};
}

/// One line: a hash of the rest, the slack, then seven numbers per capsule, as hexadecimal floats, which are exact.
std::string to_text(const CapsuleFit& fit) {
  std::string body = fmt::format("{:a}", fit.slack_m);
  for (const Capsule& c : fit.capsules)
    for (double value : {c.start.x(), c.start.y(), c.start.z(), c.end.x(), c.end.y(), c.end.z(), c.radius_m})
      body += fmt::format(" {:a}", value);
  return fmt::format("{:016x} {}\n", fnv1a(body.data(), body.size()), body);
}

std::optional<CapsuleFit> read(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || line.size() > 1u << 16) return {};
  std::istringstream words(line.substr(std::min<size_t>(line.size(), 16)));
  std::vector<double> values;
  for (std::string word; words >> word;) values.push_back(std::strtod(word.c_str(), nullptr));
  if (values.size() < 8 || values.size() % 7 != 1) return {};
  CapsuleFit fit;
  fit.slack_m = values[0];
  for (size_t i = 1; i < values.size(); i += 7)
    fit.capsules.push_back({Vector3(values.data() + i), Vector3(values.data() + i + 3), values[i + 6]});
  if (to_text(fit) != line + "\n") return {};  // truncated or altered: the hash does not match
  return fit;
}

/// Under another name first: two controllers may start at once.
void write(const fs::path& file, const CapsuleFit& fit) {
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  const fs::path draft = file.string() + fmt::format(".{}", getpid());
  std::ofstream stream(draft);
  stream << to_text(fit);
  stream.close();
  if (stream) fs::rename(draft, file, ignored);
  fs::remove(draft, ignored);
}

}  // namespace

CapsuleFit fit_capsules_cached(const Mesh& mesh, int most) {
  const fs::path cache = folder();
  if (cache.empty()) return fit_capsules(mesh, most);
  const fs::path file = cache / fmt::format("{:016x}.capsules", hash_of(mesh, most));
  if (const std::optional<CapsuleFit> known = read(file)) return *known;
  CapsuleFit fit = fit_capsules(mesh, most);
  write(file, fit);
  return fit;
}

}  // namespace sidestep
