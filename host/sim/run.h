#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/sim/record.h"
#include "host/sim/summary.h"

namespace sidestep::sim {

/// One arm that plays its scenario: plant, world and what is kept of them. The world stands still until the first
/// record().
class Run {
 public:
  /// csv_file: empty for none. Throws std::runtime_error, one line, when the scenario does not fit its URDF or the file
  /// cannot be written.
  Run(const Scenario& scenario, const std::string& csv_file);

  void take(const Answer& answer);

  /// Since then t = 0 has passed.
  bool tracked() const { return summary_.rows() > 0; }
  bool complete() const { return summary_.rows() > scenario_.periods; }

  /// The coming control period: its index, and the world at its start. Both stay at zero until the first record().
  int period() const { return summary_.rows(); }
  World world() const { return later(scenario_.world, scenario_.time_s(period())); }

  /// Notes where the arm is at the start of the coming period.
  void measure();

  /// Keeps the coming period as it was measured and passes on to the next one. `all`: the arms that share the world,
  /// each as it was measured; this is among them.
  void record(const std::vector<Run>& all);

  std::string waits_for() const;
  void close_csv();

  const Scenario& scenario() const { return scenario_; }
  const std::optional<Status>& status() const { return status_; }
  const Summary& summary() const { return summary_; }
  const Row& row() const { return row_; }  ///< the last one kept

  Plant plant;

 private:
  double neighbour_clearance_m(const std::vector<Run>& all) const;

  Scenario scenario_;
  Truth truth_;
  std::optional<CsvFile> csv_;
  Summary summary_;
  std::optional<Status> status_;  ///< the last one
  Row row_;
};

}  // namespace sidestep::sim
