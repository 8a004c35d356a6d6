#pragma once

#include <string>

#include "firmware/io/config.h"
#include "firmware/io/encoder.h"
#include "firmware/io/moment.h"
#include "firmware/io/record_ring.h"

namespace sidestep {

/// What stands in a blackbox's ring: messages as they came, each before the first cycle that uses it, and cycles.
enum class Kept : uint8_t { kArmState, kTarget, kObstacles, kCycle };
constexpr size_t kMessageKinds = 3;

struct KeptCycle {
  Moment moment;
  bool commanded = false;
  Command command;
  Report report;
  CycleRecord record;
};

/// Channels of a log beside the usual ones: a blackbox_t; the MomentImage of every cycle.
constexpr const char* kBlackboxChannel = "BLACKBOX";
constexpr const char* kMomentChannel = "BLACKBOX_CYCLE";

/// Writes the last Config::blackbox.seconds of the records, and Ages::old_place_s before them to lead in, as an
/// lcm-logger log and returns the number of cycles. It begins with the first cycle all of whose messages are there.
/// Throws std::runtime_error, one line, when the file cannot be written.
int64_t write_blackbox_log(const std::string& file, const Config& config, const std::string& reason,
                           RecordRing::Copy& records);

}  // namespace sidestep
