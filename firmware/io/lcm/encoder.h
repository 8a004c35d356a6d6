#pragma once

#include <cstdint>
#include <memory>

#include "firmware/control/cycle.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/io/lcm/loop_timing.h"

namespace sidestep {

/// What the loop adds to the report of a cycle in controller_status_t.
struct CycleRecord {
  int64_t utime = 0;
  int64_t seq = 0;
  double cycle_time_s = 0.0;  ///< CPU time
  double wake_latency_s = 0.0;
  int64_t skipped_cycles = 0;  ///< since the start
  int64_t rejected_messages = 0;
  const char* rejected_reason = "";  ///< appended to the message while not empty
};

/// Values of the controller to the bytes of outbound messages, without allocating. A packet is valid until the next
/// call.
class Encoder {
 public:
  /// The arm outlives this.
  Encoder(const Arm& arm, const Dialect& dialect);
  ~Encoder();

  Packet encode(const Command& command, int64_t utime, int64_t seq);
  Packet encode(const Report& report, const CycleRecord& record);
  Packet encode(const LoopTiming& timing, int64_t utime);

 private:
  struct Messages;
  const Arm& arm_;
  std::unique_ptr<Messages> messages_;
};

}  // namespace sidestep
