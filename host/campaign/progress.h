#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

namespace sidestep::campaign {

/// How far the campaign is, on stderr: a bar when it is a terminal, a line every tenth otherwise, nothing when quiet.
/// May be told from several threads.
class Progress {
 public:
  Progress(size_t total, bool quiet);

  void one_more(bool touched, bool succeeded);
  void end();

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
