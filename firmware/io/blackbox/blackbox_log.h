#pragma once

#include <string>

#include "firmware/io/blackbox/record_ring.h"
#include "firmware/io/blackbox/step_arguments.h"
#include "firmware/io/config/config.h"
#include "firmware/io/lcm/encoder.h"

namespace sidestep {

/// Kinds of records in a blackbox's ring. Messages are stored as they came, each before the first cycle that uses it.
/// kObstacleValues follows an obstacle message whose set the cycles used with other values than the message holds: with
/// remembered obstacles, or merged from several senders (then the message itself is empty). It is the whole set.
/// kTarget is a target_t or a joint_target_t. kOtherJoints, kControl and kAttachments are for the readers of a log: the
/// values that the cycles used are among their arguments.
enum class RecordKind : uint8_t {
  kArmState,
  kTarget,
  kObstacles,
  kObstacleValues,
  kOtherJoints,
  kControl,
  kAttachments,
  kCycle
};
constexpr size_t kMessageKinds = 7;

/// One cycle with its result.
struct RecordedCycle {
  StepArguments arguments;
  bool commanded = false;  ///< the command was sent
  Command command;
  Report report;
  CycleRecord record;
};

/// Channels of a log besides the usual ones: a blackbox_t; obstacle values, each an Obstacle as it lies in memory; the
/// StepArgumentsImage of every cycle.
constexpr const char* kBlackboxChannel = "BLACKBOX";
constexpr const char* kObstacleValuesChannel = "BLACKBOX_OBSTACLES";
constexpr const char* kStepArgumentsChannel = "BLACKBOX_CYCLE";

/// Writes the last Config::blackbox.seconds of the records as an lcm-logger log and returns the number of cycles. The
/// log begins with the first cycle whose messages are all in the ring. Throws std::runtime_error, one line, when the
/// file cannot be written.
int64_t write_blackbox_log(const std::string& file, const Config& config, const std::string& reason,
                           RecordRing::Copy& records);

}  // namespace sidestep
