#include "host/sim/clock.h"
#include "host/sim/simulation.h"

namespace sidestep::sim {
namespace {

constexpr int64_t kFirstUtime_us = 1'000'000;  // not 0, which often means "never"
constexpr int64_t kRepeat_us = 100'000;        // interval of repetitions until the controller answers
// All controllers start together at this time, whenever each of them answered first and whatever their order. It is so
// much later than the messages before it that these are too old to count: a run does not depend on them.
constexpr int64_t kCommonStart_us = 1'000'000'000;

struct Reply {
  Command command;
  Status status;
};

/// The arm's command with this utime and the first status after it. Replies to earlier repetitions are skipped.
std::optional<Reply> reply_to(size_t arm, int64_t utime, int64_t patience_us, SimWire& wire,
                              const std::atomic<bool>& interrupted) {
  std::optional<Command> command;
  const int64_t end_us = monotonic_us() + patience_us;
  for (int64_t left_us = patience_us; left_us > 0 && !interrupted; left_us = end_us - monotonic_us()) {
    const std::optional<ReceivedMessage> received = wire.next(left_us);
    if (!received || received->arm != arm) continue;
    if (const auto* status = std::get_if<Status>(&received->message)) {
      if (command) return Reply{*command, *status};
    } else if (std::get<Command>(received->message).utime == utime) {
      command = std::get<Command>(received->message);
    }
  }
  return {};
}

/// One period of one arm. Returns false when the controller has answered before, but not in this period.
bool exchange(size_t arm, Run& run, int64_t utime, SimWire& wire, const std::atomic<bool>& interrupted) {
  const bool answered = run.status().has_value();
  run.measure();
  wire.publish(arm, run.world(), utime);
  wire.publish(arm, run.plant.q_rad(), run.plant.qd_radps(), utime);
  const auto reply = reply_to(arm, utime, answered ? kLostAfter_us : kRepeat_us, wire, interrupted);
  if (!reply) return !answered;
  run.receive(reply->command);
  run.receive(reply->status);
  return true;
}

}  // namespace

Outcome run_lockstep(Simulation& simulation, SimWire& wire, double patience_s, const std::atomic<bool>& interrupted) {
  const int64_t period_us = simulation.scenario().period_us;
  const auto patience_us = static_cast<int64_t>(patience_s * 1e6);
  const int64_t deadline_us = monotonic_us() + patience_us;
  int64_t first_answered_us = 0;
  for (int64_t utime = kFirstUtime_us;; utime += period_us) {
    if (!simulation.tracked()) simulation.show_waiting();
    for (size_t arm = 0; arm < simulation.runs.size(); ++arm) {
      // An arm whose controller has answered pauses until all controllers have.
      if (simulation.runs[arm].status() && !simulation.answered()) continue;
      const bool connected = exchange(arm, simulation.runs[arm], utime, wire, interrupted);
      if (interrupted) return Outcome::kInterrupted;
      if (!connected) return Outcome::kLost;
    }
    if (!simulation.answered()) {
      if (monotonic_us() > deadline_us) return Outcome::kNeverTracked;
      continue;
    }
    if (first_answered_us == 0) {
      first_answered_us = utime = kCommonStart_us;
    }
    if (simulation.tracked() || simulation.ready()) simulation.record();
    if (simulation.complete()) return Outcome::kDone;
    if (!simulation.tracked() && utime - first_answered_us > patience_us) return Outcome::kNeverTracked;
    for (Run& run : simulation.runs) run.plant.advance(period_us);
  }
}

}  // namespace sidestep::sim
