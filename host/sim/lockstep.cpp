
#include "host/sim/clock.h"
#include "host/sim/play.h"

namespace sidestep::sim {
namespace {

constexpr int64_t kFirstUtime = 1'000'000;  // zero often means "never"
constexpr int64_t kRepeatUs = 100'000;      // while no controller answers
// Several controllers begin together, whichever came first and whenever: what they heard before is too old for all.
constexpr int64_t kTogetherUtime = 1'000'000'000;

struct Reply {
  Command command;
  Status status;
};

// The arm's command with this utime and its first status behind it. Answers to earlier repetitions are passed over.
std::optional<Reply> reply_to(size_t arm, int64_t utime, int64_t patience_us, Bus& bus,
                              const std::atomic<bool>& interrupted) {
  std::optional<Command> command;
  const int64_t end_us = monotonic_us() + patience_us;
  for (int64_t left_us = patience_us; left_us > 0 && !interrupted; left_us = end_us - monotonic_us()) {
    const std::optional<Heard> heard = bus.next(left_us);
    if (!heard || heard->arm != arm) continue;
    if (const auto* status = std::get_if<Status>(&heard->answer)) {
      if (command) return Reply{*command, *status};
    } else if (std::get<Command>(heard->answer).utime == utime) {
      command = std::get<Command>(heard->answer);
    }
  }
  return {};
}

// One period of one arm. Returns whether its controller answered, or never has.
bool exchange(size_t arm, Run& run, int64_t utime, Bus& bus, const std::atomic<bool>& interrupted) {
  const bool answered = run.status().has_value();
  bus.publish(arm, run.world(), utime);
  bus.publish(arm, run.plant.q_rad(), run.plant.qd_radps(), utime);
  run.measure();
  const auto reply = reply_to(arm, utime, answered ? kLostAfterUs : kRepeatUs, bus, interrupted);
  if (!reply) return !answered;
  run.take(reply->command);
  run.take(reply->status);
  return true;
}

}  // namespace

End run_lockstep(Play& play, Bus& bus, double patience_s, const std::atomic<bool>& interrupted) {
  const int64_t period_us = play.scenario().period_us;
  const auto patience_us = static_cast<int64_t>(patience_s * 1e6);
  const int64_t give_up_us = monotonic_us() + patience_us;
  int64_t first_answered = 0;
  for (int64_t utime = kFirstUtime;; utime += period_us) {
    if (!play.tracked()) play.show_waiting();
    for (size_t arm = 0; arm < play.runs.size(); ++arm) {
      if (play.runs[arm].status() && !play.answered()) continue;  // it stands still until all are there
      const bool there = exchange(arm, play.runs[arm], utime, bus, interrupted);
      if (interrupted) return End::kInterrupted;
      if (!there) return End::kLost;
    }
    if (!play.answered()) {
      if (monotonic_us() > give_up_us) return End::kNeverTracked;
      continue;
    }
    if (first_answered == 0) {
      if (play.runs.size() > 1) utime = kTogetherUtime;
      first_answered = utime;
    }
    if (play.tracked() || play.tracking()) play.record();
    if (play.complete()) return End::kDone;
    if (!play.tracked() && utime - first_answered > patience_us) return End::kNeverTracked;
    for (Run& run : play.runs) run.plant.advance(period_us);
  }
}

}  // namespace sidestep::sim
