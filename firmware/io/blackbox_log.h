#pragma once

#include <string>

#include "firmware/io/config.h"
#include "firmware/io/encoder.h"
#include "firmware/io/moment.h"
#include "firmware/io/record_ring.h"

namespace sidestep {

/// What stands in a blackbox's ring: messages as they came, each before the first cycle that uses it, and cycles.
/// Behind a set of obstacles the old places that count with it, as they lie in memory: they tell of messages between
/// two cycles, and of a time before the ring.
enum class Kept : uint8_t { kArmState, kTarget, kObstacles, kOldPlaces, kCycle };
constexpr size_t kMessageKinds = 4;

struct KeptCycle {
  Moment moment;
  bool commanded = false;
  Command command;
  Report report;
  CycleRecord record;
};

/// Channels of a log beside the usual ones: a blackbox_t; old places, each an Obstacle as it lies in memory; the
/// MomentImage of every cycle.
constexpr const char* kBlackboxChannel = "BLACKBOX";
constexpr const char* kOldPlacesChannel = "BLACKBOX_OLD_PLACES";
constexpr const char* kMomentChannel = "BLACKBOX_CYCLE";

/// Writes the last Config::blackbox.seconds of the records as an lcm-logger log and returns the number of cycles. It
/// begins with the first cycle all of whose messages are there. Throws std::runtime_error, one line, when the file
/// cannot be written.
int64_t write_blackbox_log(const std::string& file, const Config& config, const std::string& reason,
                           RecordRing::Copy& records);

}  // namespace sidestep
