#pragma once

#include <string>
#include <vector>

#include "host/sim/record.h"

namespace sidestep::sim {

/// The figures of one run.
class Summary {
 public:
  /// period_us: of the simulator.
  explicit Summary(int64_t period_us) : command_period_us_(static_cast<double>(period_us)) {}

  void add(const Row& row);

  /// Each command in the order of arrival.
  void add(const Command& command);

  /// One line per broken expectation: name, bound, value. Only meaningful for a complete run.
  std::vector<std::string> broken(const Expectations& expect) const;

  /// Several lines for people, with the figures of the paper where the scenario has them.
  std::string text(const Scenario& scenario) const;

  int rows() const { return rows_; }

 private:
  void measure_period(const Command& command, double since_us);

  double command_period_us_;
  int rows_ = 0;
  double clearance_m_ = kNothingNear;
  std::string nearest_ = "no obstacle";
  double neighbour_m_ = kNothingNear;
  double axis_distance_m_ = kNothingNear;
  double final_distance_m_ = 0.0;
  double joint_speed_radps_ = 0.0;
  double joint_acceleration_radps2_ = 0.0;
  double cycle_time_total_s_ = 0.0, cycle_time_max_s_ = 0.0;
  int64_t skipped_before_ = 0;  ///< t = 0
  Status last_;
  Command previous_;
};

}  // namespace sidestep::sim
