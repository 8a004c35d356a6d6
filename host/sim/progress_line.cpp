#include "host/sim/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "host/sim/clock.h"

namespace sidestep::sim {
namespace {

const char* name_of(Mode mode) {
  switch (mode) {
    case Mode::kWait:
      return "WAIT";
    case Mode::kHold:
      return "HOLD";
    case Mode::kTrack:
      return "TRACK";
    case Mode::kBrake:
      return "BRAKE";
    case Mode::kFault:
      return "FAULT";
  }
  return "?";
}

/// Empty while the law needs no guide.
std::string foresight_text(const Status& status) {
  if (status.foresight == 1 && status.guide_horizon_s > 0.0)
    return fmt::format(", guided {:.1f} s", status.guide_horizon_s);
  if (status.foresight == 1) return ", guided, at the end of the path";
  return status.foresight == 2 ? ", no path known" : "";
}

/// Empty without a target.
std::string target_text(const Row& row) {
  return row.world.target ? fmt::format("target {:.3f} m  ", row.target_distance_m) : "";
}

/// Empty where the obstacles are those of other processes.
std::string clearance_text(const Row& row) {
  const double clearance_m = std::min(row.nearest.clearance_m, row.neighbour_m);
  if (clearance_m < kNothingNear) return fmt::format("clearance {:.3f} m  ", clearance_m);
  return row.world.obstacles_from_others ? "" : "no obstacle  ";
}

std::string bar(double done) {
  constexpr int kWidth = 20;
  const int filled = static_cast<int>(kWidth * std::clamp(done, 0.0, 1.0));
  return '[' + std::string(filled, '=') + std::string(kWidth - filled, ' ') + ']';
}

size_t terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace

ProgressLine::ProgressLine(bool quiet, bool lockstep) : terminal_(isatty(STDERR_FILENO) != 0) {
  every_us_ = quiet ? 0 : terminal_ ? 100'000 : lockstep ? 0 : 1'000'000;
}

void ProgressLine::end() {
  if (shown_ && terminal_) std::fputc('\n', stderr);
  shown_ = false;
}

bool ProgressLine::due() {
  const int64_t now_us = monotonic_us();
  if (every_us_ == 0 || now_us < next_us_) return false;
  next_us_ = now_us + every_us_;
  return true;
}

void ProgressLine::show(const std::string& line) {
  shown_ = true;
  if (terminal_) {
    fmt::print(stderr, "\r\x1b[K{}", line.substr(0, terminal_columns() - 1));
    std::fflush(stderr);
  } else {
    fmt::print(stderr, "{}\n", line);
  }
}

void ProgressLine::show_waiting(const std::string& for_what) {
  if (due()) show("waiting for " + for_what);
}

void ProgressLine::show_running(const std::vector<const Row*>& arms, double duration_s) {
  if (!due()) return;
  const double t_s = arms.front()->t_s;
  std::string line = duration_s > 0.0 ? fmt::format("{} {:.2f}/{:.2f} s", bar(t_s / duration_s), t_s, duration_s)
                                      : fmt::format("{:.2f} s", t_s);
  for (const Row* row : arms) {
    line += fmt::format("  {}{}{}{}{}  cycle {:.0f} us", row->arm.empty() ? "" : row->arm + ": ", target_text(*row),
                        clearance_text(*row), name_of(row->status.mode), foresight_text(row->status),
                        row->status.cycle_time_s * 1e6);
  }
  show(line);
}

}  // namespace sidestep::sim
