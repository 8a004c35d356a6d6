#pragma once

#include <atomic>
#include <optional>

#include "host/sim/bus.h"
#include "host/sim/live.h"
#include "host/sim/record.h"
#include "host/sim/summary.h"

namespace sidestep::sim {

enum class End { kDone, kInterrupted, kNeverTracked, kLost };

/// Without an answer for this long the controller is lost.
constexpr int64_t kLostAfterUs = 5'000'000;

/// One play of a scenario: plant, world and what is kept of them. The world stands still until the controller tracks.
class Run {
 public:
  /// All but the scenario are used until the run is over; csv may be null.
  Run(const Scenario& scenario, Truth& truth, Live& live, CsvFile* csv)
      : plant(scenario.plant, scenario.start_rad),
        scenario_(scenario),
        truth_(truth),
        live_(live),
        csv_(csv),
        summary_(scenario.period_us) {}

  void take(const Command& command);
  void take(const Status& status) { status_ = status; }

  /// Since then t = 0 has passed.
  bool tracked() const { return summary_.rows() > 0; }
  bool complete() const { return summary_.rows() > scenario_.periods; }

  /// The coming control period: its index, and the world at its start. Both stay at zero until the first record().
  int period() const { return summary_.rows(); }
  World world() const { return later(scenario_.world, scenario_.time_s(period())); }

  /// Keeps the coming period, with what was measured at its start, and passes on to the next one.
  void record(const JointVector& q_rad, const JointVector& qd_radps);

  /// Says before t = 0 what is being waited for.
  void show_waiting();
  std::string waits_for() const;

  const Scenario& scenario() const { return scenario_; }
  const std::optional<Status>& status() const { return status_; }
  const Summary& summary() const { return summary_; }

  Plant plant;

 private:
  Scenario scenario_;
  Truth& truth_;
  Live& live_;
  CsvFile* csv_;
  Summary summary_;
  std::optional<Status> status_;  ///< the last one
};

/// Plays on the arm's clock: for each period sends TARGET, OBSTACLES and ARM_STATE and waits for the answer to exactly
/// these. The first period whose status says TRACK is t = 0. Gives up when that takes longer than patience_s, before
/// the first answer on the wall's clock, then on the arm's.
End run_lockstep(Run& run, Bus& bus, double patience_s, const std::atomic<bool>& interrupted);

/// Plays on the monotonic clock; t = 0 is the arrival of the first status that says TRACK.
End run_realtime(Run& run, Bus& bus, double patience_s, const std::atomic<bool>& interrupted);

}  // namespace sidestep::sim
