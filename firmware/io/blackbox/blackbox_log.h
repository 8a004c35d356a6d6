#pragma once

#include <string>

#include "firmware/io/blackbox/record_ring.h"
#include "firmware/io/blackbox/step_arguments.h"
#include "firmware/io/config/config.h"
#include "firmware/io/lcm/encoder.h"

namespace sidestep {

/// What stands in a blackbox's ring: messages as they came, each before the first cycle that uses it, and cycles.
/// Behind a set of obstacles the old places that count with it, as they lie in memory: they tell of messages between
/// two cycles, and of a time before the ring.
enum class RecordKind : uint8_t { kArmState, kTarget, kObstacles, kRemembered, kCycle };
constexpr size_t kMessageKinds = 4;

struct RecordedCycle {
  StepArguments arguments;
  bool commanded = false;
  Command command;
  Report report;
  CycleRecord record;
};

/// Channels of a log beside the usual ones: a blackbox_t; old places, each an Obstacle as it lies in memory; the
/// MomentImage of every cycle.
constexpr const char* kBlackboxChannel = "BLACKBOX";
constexpr const char* kRememberedChannel = "BLACKBOX_OLD_PLACES";
constexpr const char* kStepArgumentsChannel = "BLACKBOX_CYCLE";

/// Writes the last Config::blackbox.seconds of the records as an lcm-logger log and returns the number of cycles. It
/// begins with the first cycle all of whose messages are there. Throws std::runtime_error, one line, when the file
/// cannot be written.
int64_t write_blackbox_log(const std::string& file, const Config& config, const std::string& reason,
                           RecordRing::Copy& records);

}  // namespace sidestep
