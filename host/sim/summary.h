#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/sim/record.h"

namespace sidestep::sim {

/// The figures of one run.
class Summary {
 public:
  /// period_us: of the simulator.
  explicit Summary(int64_t period_us) : command_period_s_(1e-6 * static_cast<double>(period_us)) {}

  void add(const Row& row);

  /// Each command in the order of arrival. The first one is only compared with: a controller that runs already may be
  /// answering an arm that is gone.
  void add(const Command& command);

  /// One line per broken expectation: name, bound, value. Where a least clearance is expected, links that touch each
  /// other break it too. Only meaningful for a complete run.
  std::vector<std::string> broken(const Expectations& expect) const;

  /// Several lines for people, with the figures of the paper where the scenario has them.
  std::string text(const Scenario& scenario) const;

  int rows() const { return rows_; }

 private:
  void measure_period(const Command& command);
  bool touches() const;  ///< an obstacle, another arm or itself

  double command_period_s_;
  int rows_ = 0;
  double clearance_m_ = kNothingNear;
  std::string nearest_ = "no obstacle";
  double neighbour_m_ = kNothingNear;
  double self_m_ = kNothingNear;
  std::string nearest_links_;
  double axis_distance_m_ = kNothingNear;
  double final_distance_m_ = 0.0;
  double joint_speed_radps_ = 0.0;
  double joint_acceleration_radps2_ = 0.0;
  double cycle_time_total_s_ = 0.0, cycle_time_max_s_ = 0.0;
  int64_t skipped_before_ = 0;  ///< t = 0
  Status last_;
  std::optional<Command> previous_;
};

}  // namespace sidestep::sim
