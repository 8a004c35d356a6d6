#include "host/sim/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sidestep::sim {
namespace {

std::string metres(double value_m) {
  return value_m < kNothingNear ? fmt::format("{:.4f} m", value_m) : "-";
}

std::string paper_figure(const std::optional<double>& published_m) {
  return published_m ? fmt::format("   (paper: {:.4f} m)", *published_m) : "";
}

void at_most(std::vector<std::string>& broken, const char* name, const std::optional<double>& bound, double value) {
  if (bound && !(value <= *bound))
    broken.push_back(fmt::format("{}: wanted at most {}, got {:.6g}", name, *bound, value));
}

void at_least(std::vector<std::string>& broken, const char* name, const std::optional<double>& bound, double value) {
  if (bound && !(value >= *bound))
    broken.push_back(fmt::format("{}: wanted at least {}, got {:.6g}", name, *bound, value));
}

/// Ids from -2 downwards are those of the surroundings of the controller's configuration.
std::string name_of(const Obstacle& obstacle) {
  if (obstacle.id <= -2) return fmt::format("surroundings[{}]", -2 - obstacle.id);
  const std::string number = fmt::format("obstacle {}", obstacle.id);
  return obstacle.name.empty() ? number : fmt::format("{} ({})", obstacle.name, number);
}

}  // namespace

void Summary::add(const Row& row) {
  if (rows_++ == 0) skipped_before_ = row.status.skipped_cycles;
  if (row.nearest.clearance_m < clearance_m_) {
    clearance_m_ = row.nearest.clearance_m;
    nearest_ = fmt::format("{} and {} at {:.2f} s", row.nearest.link,
                           name_of(row.world.all()[static_cast<size_t>(row.nearest.obstacle)]), row.t_s);
  }
  neighbour_m_ = std::min(neighbour_m_, row.neighbour_m);
  if (row.nearest_links.clearance_m < self_m_) {
    self_m_ = row.nearest_links.clearance_m;
    nearest_links_ = fmt::format("{} and {} at {:.2f} s", row.nearest_links.first, row.nearest_links.second, row.t_s);
  }
  axis_distance_m_ = std::min(axis_distance_m_, row.axis_distance_m);
  final_distance_m_ = row.target_distance_m;
  joint_speed_radps_ = std::max(joint_speed_radps_, row.qd_radps.cwiseAbs().maxCoeff());
  cycle_time_total_s_ += row.status.cycle_time_s;
  cycle_time_max_s_ = std::max(cycle_time_max_s_, row.status.cycle_time_s);
  last_ = row.status;
}

/// The period of the controller, which may differ from that of the simulator: joint_velocity leads from the last
/// joint_position to the new one, except while the position catches up with the arm: then the joints disagree about the
/// period, and a single joint in motion tells nothing. Time stamps do not tell the period, because wake-ups jitter and
/// cycles are skipped.
void Summary::measure_period(const Command& command) {
  const Eigen::VectorXd change_rad = command.q_rad - previous_->q_rad;
  const double slow_radps = 0.01, rounding_rad = 1e-12;
  if ((command.qd_radps.array().abs() > slow_radps).count() < 2) return;
  const double period_s = change_rad.dot(command.qd_radps) / command.qd_radps.squaredNorm();
  const bool leads = period_s > 0.0 && (change_rad - period_s * command.qd_radps).norm() < rounding_rad;
  if (leads) command_period_s_ = period_s;
}

/// The acceleration limit holds in each cycle, whatever time has passed since the last one. Lost commands leave a gap
/// in the numbers of the cycles; a larger gap than the time permits is that of another controller.
void Summary::add(const Command& command) {
  if (previous_) {
    const double since_s = 1e-6 * static_cast<double>(command.utime - previous_->utime);
    const auto cycles = static_cast<double>(command.seq - previous_->seq);
    // After a pause longer than the watchdog time a new command stream starts, from an arm state of before or after the
    // plant's stop: from a velocity between that of the last command and rest.
    const bool continues = since_s <= 1e-6 * static_cast<double>(Plant::kWatchdog_us);
    if (continues && cycles == 1.0) measure_period(command);
    // A stream does not end in motion while the cycles go on: its commands were lost.
    const bool moved = !previous_->qd_radps.isZero();
    const bool lost = (continues || moved) && cycles > 1.0 && (cycles - 2.0) * command_period_s_ < since_s;
    Eigen::VectorXd before_radps = previous_->qd_radps;
    if (!continues)
      before_radps = command.qd_radps.cwiseMax(before_radps.cwiseMin(0.0)).cwiseMin(before_radps.cwiseMax(0.0));
    const Eigen::VectorXd change_radps = command.qd_radps - before_radps;
    const double over_s = command_period_s_ * (lost ? cycles : 1.0);
    joint_acceleration_radps2_ = std::max(joint_acceleration_radps2_, change_radps.cwiseAbs().maxCoeff() / over_s);
  }
  previous_ = command;
}

bool Summary::touches() const {
  return std::min(clearance_m_, neighbour_m_) < 0.0 || self_m_ <= 0.0;
}

std::vector<std::string> Summary::broken(const Expectations& expect) const {
  std::vector<std::string> broken;
  at_most(broken, "final_distance_max_m", expect.final_distance_max_m, final_distance_m_);
  at_least(broken, "clearance_min_m", expect.clearance_min_m, std::min(clearance_m_, neighbour_m_));
  if (expect.clearance_min_m && !(self_m_ > std::min(*expect.clearance_min_m, 0.0)))
    broken.push_back(fmt::format("clearance_min_m: links touch each other, {:.6g}: {}", self_m_, nearest_links_));
  at_least(broken, "axis_distance_min_m", expect.axis_distance_min_m, axis_distance_m_);
  at_most(broken, "joint_speed_max_radps", expect.joint_speed_max_radps, joint_speed_radps_);
  at_most(broken, "joint_acceleration_max_radps2", expect.joint_acceleration_max_radps2, joint_acceleration_radps2_);
  return broken;
}

std::string Summary::text(const Scenario& scenario) const {
  const int64_t skipped = last_.skipped_cycles - skipped_before_;
  const double mean_us = rows_ > 0 ? cycle_time_total_s_ / rows_ * 1e6 : 0.0;
  std::string text = scenario.title + (scenario.arm.empty() ? "\n" : ": " + scenario.arm + '\n');
  const std::string without = scenario.world.obstacles_from_others ? ", obstacles of other processes not measured" : "";
  text += fmt::format("  contact                   {}{}\n", touches() ? "YES" : "no", without);
  text += fmt::format("  min clearance             {}   {}\n", metres(clearance_m_), nearest_);
  if (neighbour_m_ < kNothingNear) text += fmt::format("  min clearance to arms     {:.4f} m\n", neighbour_m_);
  const std::string links =
      self_m_ < kNothingNear ? metres(self_m_) + "   " + nearest_links_ : fmt::format("{:g} m or more", kSelfRange_m);
  text += fmt::format("  min between links         {}\n", links);
  if (scenario.published.axis_distance_m)
    text += fmt::format("  min centre to axis        {}{}\n", metres(axis_distance_m_),
                        paper_figure(scenario.published.axis_distance_m));
  if (scenario.world.target)
    text += fmt::format("  final target distance     {:.6f} m{}\n", final_distance_m_,
                        paper_figure(scenario.published.final_distance_m));
  text += fmt::format("  max joint speed           {:.4f} rad/s\n", joint_speed_radps_);
  text += fmt::format("  max command acceleration  {:.3f} rad/s2\n", joint_acceleration_radps2_);
  const std::string of = scenario.endless() ? "" : fmt::format(" of {}", scenario.periods + 1);
  text += fmt::format("  cycles                    {}{}, {} skipped\n", rows_, of, skipped);
  text += fmt::format("  CPU time, whole cycle     mean {:.1f} us, max {:.1f} us\n", mean_us, cycle_time_max_s_ * 1e6);
  if (last_.rejected_messages > 0) {
    text += fmt::format("  the controller rejected   {} messages\n", last_.rejected_messages);
  }
  return text;
}

}  // namespace sidestep::sim
