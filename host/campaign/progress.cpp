#include "host/campaign/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace sidestep::campaign {
namespace {

constexpr size_t kBarWidth = 40;

}  // namespace

Progress::Progress(size_t total, bool quiet)
    : total_(total), quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), drawn_(std::chrono::steady_clock::now()) {}

void Progress::add(bool touched, bool succeeded) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  touched_ += touched ? 1 : 0;
  succeeded_ += succeeded ? 1 : 0;
  if (quiet_) return;
  if (terminal_)
    draw_bar();
  else if (done_ * 10 / total_ != (done_ - 1) * 10 / total_)
    print_line();
}

Progress::~Progress() {
  if (!quiet_ && terminal_) fmt::print(stderr, "\r\033[K");
}

void Progress::draw_bar() {
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100) && done_ < total_) return;
  drawn_ = now;
  const size_t full = kBarWidth * done_ / total_;
  fmt::print(stderr, "\r[{}{}] {}/{}  success {}  contact {}\033[K", std::string(full, '#'),
             std::string(kBarWidth - full, '.'), done_, total_, succeeded_, touched_);
  std::fflush(stderr);
}

void Progress::print_line() const {
  fmt::print(stderr, "{}/{} scenes, {} succeeded, {} touched\n", done_, total_, succeeded_, touched_);
}

}  // namespace sidestep::campaign
