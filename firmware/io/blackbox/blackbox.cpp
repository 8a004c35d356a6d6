#include "firmware/io/blackbox/blackbox.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "firmware/base/log.h"
#include "firmware/base/realtime.h"
#include "firmware/io/lcm/message_bytes.h"

namespace sidestep {
namespace {

namespace fs = std::filesystem;

constexpr double kPollEvery_s = 0.02;
constexpr size_t kMaxLogs = 10;  // of each reason in the folder; the oldest are removed

constexpr size_t kOtherMessagesBytes = 400;  // arm state and target of 10 joints, with the ring's own words
constexpr double kUsualObstacles = 64, kUsualSets_hz = 100;

/// Enough for the configured seconds with a usual number of obstacles. With more obstacles the log reaches back less
/// far, but always over a few of the largest sets.
size_t ring_bytes(const Config& config) {
  const double cycles_per_s = config.model.settings.rate_hz;
  const double bytes_per_s = cycles_per_s * static_cast<double>(sizeof(RecordedCycle) + kOtherMessagesBytes) +
                             kUsualSets_hz * kUsualObstacles * kObstacleBytes;
  return static_cast<size_t>(config.blackbox.seconds * bytes_per_s) + 4 * sizeof(Obstacle) * kMaxObstacles;
}

/// The folder's files blackbox-*ending; their names sort by time.
std::vector<fs::path> logs_in(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> logs;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const bool ends = name.size() >= ending.size() && name.substr(name.size() - ending.size()) == ending;
    if (name.rfind("blackbox-", 0) == 0 && ends) logs.push_back(entry.path());
  }
  std::sort(logs.begin(), logs.end());
  return logs;
}

std::string ending_for(const std::string& reason) {
  return "-" + reason + ".lcmlog";
}

/// By reason, so that requested logs never remove a log of a fault.
void remove_oldest(const fs::path& folder, const std::string& reason) {
  const std::vector<fs::path> logs = logs_in(folder, ending_for(reason));
  for (size_t i = 0; i + kMaxLogs < logs.size(); ++i) fs::remove(logs[i]);
}

/// Of processes that were killed while they wrote. Another controller that is writing has locked its file
/// (blackbox_log.cpp).
void remove_unfinished(const fs::path& folder) {
  if (!fs::is_directory(folder)) return;
  for (const fs::path& part : logs_in(folder, ".part")) {
    const int file = open(part.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) continue;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) fs::remove(part);
    close(file);
  }
}

}  // namespace

Blackbox::Blackbox(const Config& config, std::atomic<bool>& requested)
    : config_(config), requested_(requested), ring_(ring_bytes(config)), copy_(ring_), writing_([this] { run(); }) {}

Blackbox::~Blackbox() {
  end_ = true;
  writing_.join();
}

/// A message is recorded once, and again before it would be overwritten while it is still in use. Returns whether it
/// was recorded now.
template <typename Message>
bool Blackbox::record(RecordKind kind, const Received<Message>& received) {
  Last& last = last_[static_cast<size_t>(kind)];
  const bool fading = ring_.written_bytes() - last.at_bytes > ring_.capacity_bytes() / 2;
  if (received.count == 0 || (received.count == last.count && !fading)) return false;
  last = {received.count, ring_.written_bytes()};
  ring_.write(static_cast<uint8_t>(kind), received.bytes.data(), received.bytes.size());
  return true;
}

void Blackbox::record(const LatestInputs& latest, const RecordedCycle& cycle) {
  record(RecordKind::kArmState, latest.arm);
  record(RecordKind::kTarget, latest.target);
  record(RecordKind::kOtherJoints, latest.other_joints);
  record(RecordKind::kControl, latest.control);
  record(RecordKind::kAttachments, latest.attachments);
  const Received<ObstacleSet>& obstacles = latest.obstacles;
  const ObstacleSet& set = obstacles.message;
  if (record(RecordKind::kObstacles, obstacles) && (set.remembered > 0 || obstacles.bytes.empty()))
    ring_.write(static_cast<uint8_t>(RecordKind::kObstacleValues), set.obstacles.data(),
                static_cast<size_t>(set.count) * sizeof(Obstacle));
  ring_.write(static_cast<uint8_t>(RecordKind::kCycle), &cycle, sizeof cycle);
  if (cycle.report.mode == Mode::kFault && mode_ != Mode::kFault) fault_ = true;
  mode_ = cycle.report.mode;
}

/// After a log of a fault the next one waits for Config::blackbox.seconds; it then holds all faults since.
void Blackbox::run() {
  use_normal_scheduler();
  try {
    remove_unfinished(config_.blackbox.folder);
  } catch (const std::exception& error) {
    log_warning(fmt::format("blackbox: {}", error.what()));
  }
  for (bool last = false; !last;) {
    last = end_;
    if (!last) sleep_until(monotonic_s() + kPollEvery_s);
    if (requested_.exchange(false)) write("request");
    if ((!last && monotonic_s() < quiet_until_s_) || !fault_.exchange(false)) continue;
    write("fault");
    quiet_until_s_ = monotonic_s() + config_.blackbox.seconds;
  }
}

void Blackbox::write(const std::string& reason) {
  ring_.copy(copy_);
  const fs::path file = fs::path(config_.blackbox.folder) / fmt::format("blackbox-{}-{}.lcmlog", utc_stamp(), reason);
  const fs::path part = file.string() + ".part";
  try {
    fs::create_directories(file.parent_path());
    const int64_t cycles = write_blackbox_log(part, config_, reason, copy_);
    fs::rename(part, file);
    remove_oldest(file.parent_path(), reason);
    log_info(fmt::format("blackbox: {} cycles in {}", cycles, file.string()));
    failed_ = false;
  } catch (const std::exception& error) {
    log_warning(fmt::format("blackbox: {}", error.what()));
    std::error_code ignored;
    fs::remove(part, ignored);
    failed_ = true;
  }
}

}  // namespace sidestep
