#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/sim/grasp.h"
#include "host/sim/record.h"
#include "host/sim/summary.h"

namespace sidestep::sim {

/// The simulation of one arm in its scenario: plant, world and results. Time is 0 until the first record().
class Run {
 public:
  /// csv_file: empty for none. Throws std::runtime_error, one line, when the scenario does not fit its URDF or the file
  /// cannot be written.
  Run(const Scenario& scenario, const std::string& csv_file);

  void receive(const ControllerMessage& message);

  /// t = 0 may come: the controller tracks, or holds where the scenario has no target.
  bool ready() const;
  /// True from t = 0 on.
  bool tracked() const { return summary_.rows() > 0; }
  bool complete() const { return !scenario_.endless() && summary_.rows() > scenario_.periods; }

  /// Index of the coming control period.
  int period() const { return summary_.rows(); }

  /// Stores the measured joints and the world at the start of the coming period.
  void measure();
  const World& world() const { return row_.world; }  ///< as of measure()

  /// Records the coming period with the measured joints, and advances to the next one. `all`: the runs of all arms in
  /// the world, each after measure(); contains this run.
  void record(const std::vector<Run>& all);

  /// For people: why t = 0 has not come yet.
  std::string waits_for() const;
  void close_csv();

  const Scenario& scenario() const { return scenario_; }
  const std::optional<Status>& status() const { return status_; }
  const Summary& summary() const { return summary_; }
  const Row& row() const { return row_; }  ///< of the last recorded period

  Plant plant;

 private:
  /// Gives a posture target the tool's position there, to which distances are measured.
  void place_target();
  double neighbour_clearance_m(const std::vector<Run>& all) const;

  Scenario scenario_;
  Truth truth_;
  Grasp grasp_;
  std::optional<CsvFile> csv_;
  Summary summary_;
  std::optional<Status> status_;  ///< the last one received
  Row row_;
};

}  // namespace sidestep::sim
