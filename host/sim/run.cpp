#include "host/sim/run.h"

namespace sidestep::sim {

void Run::take(const Command& command) {
  if (plant.command(command.qd_radps)) summary_.add(command);
}

void Run::record(const JointVector& q_rad, const JointVector& qd_radps) {
  Row row;
  row.t_s = scenario_.time_s(period());
  row.q_rad = q_rad;
  row.qd_radps = qd_radps;
  row.command_radps = plant.last_command_radps();
  if (status_) row.status = *status_;
  row.world = world();
  judge(row, truth_);
  summary_.add(row);
  if (csv_) csv_->write(row, truth_);
  live_.running(row, scenario_.duration_s());
}

void Run::show_waiting() {
  live_.waiting(waits_for());
}

std::string Run::waits_for() const {
  if (!status_) return "a controller: nothing heard on ARM_COMMAND and CONTROLLER_STATUS yet";
  return "the controller to track; it says: " + (status_->message.empty() ? "(nothing)" : status_->message);
}

}  // namespace sidestep::sim
