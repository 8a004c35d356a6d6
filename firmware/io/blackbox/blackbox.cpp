#include "firmware/io/blackbox/blackbox.h"

#include <fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "firmware/base/realtime.h"

namespace sidestep {
namespace {

namespace fs = std::filesystem;

constexpr double kLookAround_s = 0.02;
constexpr size_t kMostLogs = 20;  // in the folder; the oldest give way

constexpr size_t kObstacle_bytes = 133, kOtherMessages_bytes = 400;
constexpr double kUsualObstacles = 64, kUsualSets_hz = 100;

/// Enough for the seconds with a usual number of obstacles. With more of them the log reaches back less far, but always
/// over a few of the largest messages.
size_t ring_bytes(const Config& config) {
  const double cycles_per_s = config.model.settings.rate_hz;
  const double bytes_per_s = cycles_per_s * static_cast<double>(sizeof(RecordedCycle) + kOtherMessages_bytes) +
                             kUsualSets_hz * kUsualObstacles * kObstacle_bytes;
  return static_cast<size_t>(config.blackbox.seconds * bytes_per_s) + 4 * kObstacle_bytes * kMaxObstacles;
}

bool is_log(const fs::path& file) {
  return file.filename().string().rfind("blackbox-", 0) == 0 && file.extension() == ".lcmlog";
}

/// Their names sort by time.
void remove_oldest(const fs::path& folder) {
  std::vector<fs::path> logs;
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_log(entry.path())) logs.push_back(entry.path());
  std::sort(logs.begin(), logs.end());
  for (size_t i = 0; i + kMostLogs < logs.size(); ++i) fs::remove(logs[i]);
}

fs::path name_for(const std::string& reason) {
  const double now_s = wall_s();
  const auto second = static_cast<time_t>(now_s);
  const auto microsecond = static_cast<int>((now_s - static_cast<double>(second)) * 1e6);
  return fmt::format("blackbox-{:%Y%m%dT%H%M%S}.{:06d}-{}.lcmlog", fmt::gmtime(second), microsecond, reason);
}

}  // namespace

Blackbox::Blackbox(const Config& config, std::atomic<bool>& requested)
    : config_(config), requested_(requested), ring_(ring_bytes(config)), copy_(ring_), writing_([this] { attend(); }) {}

Blackbox::~Blackbox() {
  end_ = true;
  writing_.join();
}

/// A message is kept once, and again before it would be overwritten while it is still in use. Returns whether it is
/// now.
template <typename Message>
bool Blackbox::keep(RecordKind kind, const Received<Message>& mail) {
  Last& last = last_[static_cast<size_t>(kind)];
  const bool fades = ring_.written_bytes() - last.at_bytes > ring_.capacity_bytes() / 2;
  if (mail.count == 0 || (mail.count == last.count && !fades)) return false;
  last = {mail.count, ring_.written_bytes()};
  ring_.write(static_cast<uint8_t>(kind), mail.bytes.data(), mail.bytes.size());
  return true;
}

void Blackbox::keep(const LatestInputs& post, const RecordedCycle& cycle) {
  keep(RecordKind::kArmState, post.arm);
  keep(RecordKind::kTarget, post.target);
  const ObstacleSet& set = post.obstacles.message;
  if (keep(RecordKind::kObstacles, post.obstacles) && set.obstacle_memory > 0)
    ring_.write(static_cast<uint8_t>(RecordKind::kRemembered),
                &set.obstacles[static_cast<size_t>(set.count - set.obstacle_memory)],
                static_cast<size_t>(set.obstacle_memory) * sizeof(Obstacle));
  ring_.write(static_cast<uint8_t>(RecordKind::kCycle), &cycle, sizeof cycle);
  if (cycle.report.mode == Mode::kFault && mode_ != Mode::kFault) fault_ = true;
  mode_ = cycle.report.mode;
}

/// Faults may come thick and fast; a log holds all that have come since the one before.
void Blackbox::attend() {
  for (bool last = false; !last;) {
    last = end_;
    if (!last) sleep_until(monotonic_s() + kLookAround_s);
    if (requested_.exchange(false)) write("request");
    if ((!last && monotonic_s() < quiet_until_s_) || !fault_.exchange(false)) continue;
    write("fault");
    quiet_until_s_ = monotonic_s() + config_.blackbox.seconds;
  }
}

void Blackbox::write(const std::string& reason) {
  ring_.copy(copy_);
  const fs::path file = fs::path(config_.blackbox.folder) / name_for(reason), part = file.string() + ".part";
  try {
    fs::create_directories(file.parent_path());
    const int64_t cycles = write_blackbox_log(part, config_, reason, copy_);
    fs::rename(part, file);
    remove_oldest(file.parent_path());
    spdlog::info("blackbox: {} cycles in {}", cycles, file.string());
    failed_ = false;
  } catch (const std::exception& error) {
    spdlog::warn("blackbox: {}", error.what());
    std::error_code ignored;
    fs::remove(part, ignored);
    failed_ = true;
  }
}

}  // namespace sidestep
