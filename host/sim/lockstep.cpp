#include <algorithm>

#include "host/sim/clock.h"
#include "host/sim/run.h"

namespace sidestep::sim {
namespace {

constexpr int64_t kFirstUtime = 1'000'000;  // zero often means "never"
constexpr int64_t kRepeatUs = 100'000;      // while no controller answers

struct Reply {
  Command command;
  Status status;
};

// The command with this utime and the first status behind it. Answers to earlier repetitions are passed over.
std::optional<Reply> reply_to(int64_t utime, int64_t patience_us, Bus& bus, const std::atomic<bool>& interrupted) {
  std::optional<Command> command;
  const int64_t end_us = monotonic_us() + patience_us;
  for (int64_t left_us = patience_us; left_us > 0 && !interrupted; left_us = end_us - monotonic_us()) {
    const std::optional<Answer> answer = bus.next(left_us);
    if (!answer) continue;
    if (const auto* status = std::get_if<Status>(&*answer)) {
      if (command) return Reply{*command, *status};
    } else if (std::get<Command>(*answer).utime == utime) {
      command = std::get<Command>(*answer);
    }
  }
  return {};
}

}  // namespace

End run_lockstep(Run& run, Bus& bus, double patience_s, const std::atomic<bool>& interrupted) {
  const int64_t period_us = run.scenario().period_us;
  const auto patience_us = static_cast<int64_t>(patience_s * 1e6);
  const int64_t give_up_us = monotonic_us() + patience_us;
  int64_t first_answered = 0;
  for (int64_t utime = kFirstUtime; !interrupted.load(); utime += period_us) {
    bus.publish(run.world(), utime);
    bus.publish(run.plant.q_rad(), run.plant.qd_radps(), utime);
    if (!run.tracked()) run.show_waiting();
    const bool answered = run.status().has_value();
    const auto reply = reply_to(utime, answered ? kLostAfterUs : kRepeatUs, bus, interrupted);
    if (!reply) {
      if (answered && !interrupted.load()) return End::kLost;
      if (!answered && monotonic_us() > give_up_us) return End::kNeverTracked;
      continue;
    }
    if (!answered) first_answered = utime;
    const JointVector q_rad = run.plant.q_rad(), qd_radps = run.plant.qd_radps();
    run.take(reply->command);
    run.take(reply->status);
    if (run.tracked() || reply->status.mode == Mode::kTrack) run.record(q_rad, qd_radps);
    if (run.complete()) return End::kDone;
    if (!run.tracked() && utime - first_answered > patience_us) return End::kNeverTracked;
    run.plant.advance(period_us);
  }
  return End::kInterrupted;
}

}  // namespace sidestep::sim
