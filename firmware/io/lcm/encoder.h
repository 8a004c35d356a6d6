#pragma once

#include <cstdint>
#include <memory>

#include "firmware/control/cycle.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/io/loop/timing.h"

namespace sidestep {

/// What the shell of the controller knows about a cycle beyond its report.
struct CycleRecord {
  int64_t utime = 0;
  int64_t seq = 0;
  double cycle_time_s = 0.0;
  double wake_latency_s = 0.0;
  int64_t skipped_cycles = 0;
  int64_t rejected_messages = 0;
  const char* rejected_reason = "";  ///< shown behind the message while not empty
};

/// The bytes of a message.
struct Packet {
  const uint8_t* bytes = nullptr;
  size_t size = 0;
};

/// Values to wire formats, without allocating. A packet stays valid until the next one is made.
class Encoder {
 public:
  /// The arm has to live as long.
  explicit Encoder(const Arm& arm, Dialect dialect = Dialect::kSidestep);
  ~Encoder();

  Packet encode(const Command& command, int64_t utime, int64_t seq);
  Packet encode(const Report& report, const CycleRecord& record);
  Packet encode(const Timing& timing, int64_t utime);

 private:
  struct Messages;
  const Arm& arm_;
  std::unique_ptr<Messages> messages_;
};

}  // namespace sidestep
