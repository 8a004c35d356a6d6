#pragma once

#include <thread>

#include "firmware/io/blackbox/blackbox_log.h"
#include "firmware/io/lcm/received.h"

namespace sidestep {

/// Records the last seconds of a loop in a ring. Its own thread, without real-time priority, writes them to a file in
/// Config::blackbox.folder after a fault or on request; the loop never waits for it.
class Blackbox {
 public:
  /// Allocates all memory. `requested` requests a log and is reset when the log is written; config and `requested`
  /// outlive this.
  Blackbox(const Config& config, std::atomic<bool>& requested);
  ~Blackbox();  ///< first writes a requested log

  /// Records a cycle and the messages that it used. For one thread, which neither waits nor allocates.
  void record(const LatestInputs& latest, const RecordedCycle& cycle);

  /// The last log could not be written.
  bool failed() const { return failed_; }

 private:
  template <typename Message>
  bool record(RecordKind kind, const Received<Message>& received);
  void run();
  void write(const std::string& reason);

  struct Last {
    int64_t count = 0;
    uint64_t at_bytes = 0;
  };

  const Config& config_;
  std::atomic<bool>& requested_;
  RecordRing ring_;
  RecordRing::Copy copy_;
  std::array<Last, kMessageKinds> last_;
  Mode mode_ = Mode::kWait;
  double quiet_until_s_ = 0.0;
  std::atomic<bool> fault_{false}, failed_{false}, end_{false};
  std::thread writing_;
};

}  // namespace sidestep
