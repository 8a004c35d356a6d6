#pragma once

#include <thread>

#include "firmware/io/blackbox/blackbox_log.h"
#include "firmware/io/loop/received.h"

namespace sidestep {

/// Remembers the last seconds of a loop. A thread of its own, without real-time priority, writes them into a file of
/// Config::blackbox.folder when a fault comes up or somebody asks; the loop never waits for it.
class Blackbox {
 public:
  /// Allocates all it needs. To be made by a thread that has no real-time priority yet: its own inherits that.
  /// `requested` asks for a log and is taken back when it is being written; config and it outlive this.
  Blackbox(const Config& config, std::atomic<bool>& requested);
  ~Blackbox();  ///< first writes what has been asked for

  /// Keeps a cycle and the messages it used; for one thread, which neither waits nor allocates.
  void keep(const LatestInputs& post, const RecordedCycle& cycle);

  /// The last log could not be written.
  bool failed() const { return failed_; }

 private:
  template <typename Message>
  bool keep(RecordKind kind, const Received<Message>& mail);
  void attend();
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
