#pragma once

#include <string>
#include <vector>

namespace sidestep::test {

/// A program started by a test. It is killed with this object, by kill_processes(), or when the test binary ends,
/// whichever comes first.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  int id() const { return id_; }
  void signal(int number);

  /// Exit code, 128 + signal if a signal ended the program, or kStillRunning after limit_s.
  int wait(double limit_s);
  static constexpr int kStillRunning = -1;

  /// Standard output and error so far.
  std::string output() const;

 private:
  int id_ = -1;
  int code_ = kStillRunning;
  std::string log_file_;
};

/// The limit, or ten times as long in a build whose times mean nothing (UNTIMED), as one with sanitizers.
double patient_s(double limit_s);

/// Teardown of every test that starts processes: a failed check skips destructors.
int kill_processes(void** state);

}  // namespace sidestep::test
