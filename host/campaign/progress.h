#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

namespace sidestep::campaign {

/// Reports the campaign's progress on stderr: a bar on a terminal, otherwise a line after every tenth of the scenes,
/// nothing if quiet. add() may be called from several threads.
class Progress {
 public:
  Progress(size_t total, bool quiet);

  /// Counts one finished trial.
  void add(bool touched, bool succeeded);
  /// Removes the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

 private:
  void draw_bar();
  void print_line() const;

  size_t total_;
  bool quiet_;
  bool terminal_;
  size_t done_ = 0, touched_ = 0, succeeded_ = 0;
  std::chrono::steady_clock::time_point drawn_;
  std::mutex mutex_;
};

}  // namespace sidestep::campaign
