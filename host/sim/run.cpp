#include "host/sim/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace sidestep::sim {

Run::Run(const Scenario& scenario, const std::string& csv_file)
    : plant(scenario.plant, scenario.start_rad),
      scenario_(scenario),
      truth_(Arm(scenario.robot.urdf_file, scenario.robot.base, scenario.robot.tip, scenario.robot.package_path,
                 scenario.robot.joint_positions)),
      grasp_(scenario.grasp),
      summary_(scenario.period_us) {
  if (truth_.joints() != scenario.start_rad.size()) {
    throw std::runtime_error(fmt::format("{}: start_rad: has {} values, the arm has {} joints", scenario.file,
                                         scenario.start_rad.size(), truth_.joints()));
  }
  place_target();
  row_.arm = scenario.arm;
  if (!csv_file.empty()) csv_.emplace(csv_file, truth_.joints(), static_cast<int>(scenario.world.obstacles.size()));
}

void Run::place_target() {
  if (!scenario_.world.target || scenario_.world.target->joints_rad.size() == 0) return;
  Target& target = *scenario_.world.target;
  if (truth_.joints() != target.joints_rad.size()) {
    throw std::runtime_error(fmt::format("{}: target.joints_rad: has {} values, the arm has {} joints", scenario_.file,
                                         target.joints_rad.size(), truth_.joints()));
  }
  truth_.place(target.joints_rad);
  target.motion.position_m = truth_.tool_m();
}

void Run::receive(const ControllerMessage& message) {
  if (const auto* status = std::get_if<Status>(&message)) {
    status_ = *status;
    return;
  }
  const auto& command = std::get<Command>(message);
  if (plant.command(command.qd_radps)) summary_.add(command);
}

bool Run::ready() const {
  if (!status_) return false;
  return status_->mode == Mode::kTrack || (status_->mode == Mode::kHold && !scenario_.world.target);
}

void Run::measure() {
  row_.q_rad = plant.q_rad();
  row_.qd_radps = plant.qd_radps();
  truth_.place(row_.q_rad);
  const double t_s = scenario_.time_s(period());
  row_.world = advanced(scenario_.world, t_s);
  grasp_.apply(t_s, truth_.arm().base_from_tool(), row_.world);
}

void Run::record(const std::vector<Run>& all) {
  row_.t_s = scenario_.time_s(period());
  row_.command_radps = plant.last_command_radps();
  if (status_) row_.status = *status_;
  row_.neighbour_m = neighbour_clearance_m(all);
  evaluate(row_, truth_);
  summary_.add(row_);
  if (csv_) csv_->write(row_, truth_);
}

double Run::neighbour_clearance_m(const std::vector<Run>& all) const {
  double least_m = kNothingNear;
  for (const Run& other : all) {
    if (&other == this) continue;
    const Eigen::Isometry3d base_from_other = scenario_.world_from_base.inverse() * other.scenario_.world_from_base;
    least_m = std::min(least_m, truth_.nearest(other.truth_.links(base_from_other)).clearance_m);
  }
  return least_m;
}

std::string Run::waits_for() const {
  const std::string name = scenario_.arm.empty() ? "" : scenario_.arm + ": ";
  if (!status_)
    return fmt::format("{}a controller: no message on {} and {} yet", name, scenario_.channels.arm_command,
                       scenario_.channels.controller_status);
  const char* mode = scenario_.world.target ? "track" : "hold";
  return fmt::format("{}the controller to {}; its status: ", name, mode) +
         (status_->message.empty() ? "(empty)" : status_->message);
}

void Run::close_csv() {
  if (csv_) csv_->close();
}

}  // namespace sidestep::sim
