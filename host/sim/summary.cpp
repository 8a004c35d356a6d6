#include "host/sim/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sidestep::sim {
namespace {

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

}  // namespace

void Summary::add(const Row& row) {
  if (rows_++ == 0) skipped_before_ = row.status.skipped_cycles;
  if (row.nearest.clearance_m < clearance_m_) {
    clearance_m_ = row.nearest.clearance_m;
    nearest_ = fmt::format("{} and obstacle {} at {:.2f} s", row.nearest.link,
                           row.world.all()[static_cast<size_t>(row.nearest.obstacle)].id, row.t_s);
  }
  neighbour_m_ = std::min(neighbour_m_, row.neighbour_m);
  axis_distance_m_ = std::min(axis_distance_m_, row.axis_distance_m);
  final_distance_m_ = row.target_distance_m;
  joint_speed_radps_ = std::max(joint_speed_radps_, row.qd_radps.cwiseAbs().maxCoeff());
  cycle_time_total_s_ += row.status.cycle_time_s;
  cycle_time_max_s_ = std::max(cycle_time_max_s_, row.status.cycle_time_s);
  last_ = row.status;
}

/// A controller may have a shorter period than the simulator. Its commands tell the period: joint_velocity leads from
/// the last joint_position to the new one. Their time stamps do not, because its wake-ups jitter.
void Summary::measure_period(const Command& command, double since_us) {
  const double speed2 = command.qd_radps.squaredNorm(), slow_radps = 0.01;
  const bool has_positions = command.q_rad.size() == command.qd_radps.size();
  if (!has_positions || previous_.q_rad.size() != command.q_rad.size() || !(speed2 > slow_radps * slow_radps)) return;
  const double led_us = 1e6 * (command.q_rad - previous_.q_rad).dot(command.qd_radps) / speed2;
  // After lost commands it is longer; while the position closes a following error it may be anything.
  const bool is_period = led_us > 0.5 * since_us && led_us < 2.0 * since_us;
  if (is_period && led_us < 0.9 * command_period_us_) command_period_us_ = led_us;
}

void Summary::add(const Command& command) {
  const auto since_us = static_cast<double>(command.utime - previous_.utime);
  // After a pause longer than the watchdog time the plant has stopped.
  const bool from_rest =
      previous_.qd_radps.size() != command.qd_radps.size() || since_us > static_cast<double>(Plant::kWatchdog_us);
  if (from_rest) previous_.qd_radps = Eigen::VectorXd::Zero(command.qd_radps.size());
  if (!from_rest) measure_period(command, since_us);
  const double periods = from_rest ? 1.0 : std::max(1.0, std::round(since_us / command_period_us_));
  const double change_radps = (command.qd_radps - previous_.qd_radps).cwiseAbs().maxCoeff();
  joint_acceleration_radps2_ =
      std::max(joint_acceleration_radps2_, change_radps / (1e-6 * periods * command_period_us_));
  previous_ = command;
}

std::vector<std::string> Summary::broken(const Expectations& expect) const {
  std::vector<std::string> broken;
  at_most(broken, "final_distance_max_m", expect.final_distance_max_m, final_distance_m_);
  at_least(broken, "clearance_min_m", expect.clearance_min_m, std::min(clearance_m_, neighbour_m_));
  at_least(broken, "axis_distance_min_m", expect.axis_distance_min_m, axis_distance_m_);
  at_most(broken, "joint_speed_max_radps", expect.joint_speed_max_radps, joint_speed_radps_);
  at_most(broken, "joint_acceleration_max_radps2", expect.joint_acceleration_max_radps2, joint_acceleration_radps2_);
  return broken;
}

std::string Summary::text(const Scenario& scenario) const {
  const int64_t skipped = last_.skipped_cycles - skipped_before_;
  const double mean_us = rows_ > 0 ? cycle_time_total_s_ / rows_ * 1e6 : 0.0;
  std::string text = scenario.title + (scenario.arm.empty() ? "\n" : ": " + scenario.arm + '\n');
  text += fmt::format("  contact                   {}\n", std::min(clearance_m_, neighbour_m_) < 0.0 ? "YES" : "no");
  text += fmt::format("  min clearance             {:.4f} m   {}\n", clearance_m_, nearest_);
  if (neighbour_m_ < kNothingNear) text += fmt::format("  min clearance to arms     {:.4f} m\n", neighbour_m_);
  text += fmt::format("  min centre to axis        {:.4f} m{}\n", axis_distance_m_,
                      paper_figure(scenario.published.axis_distance_m));
  text += fmt::format("  final target distance     {:.6f} m{}\n", final_distance_m_,
                      paper_figure(scenario.published.final_distance_m));
  text += fmt::format("  max joint speed           {:.4f} rad/s\n", joint_speed_radps_);
  text += fmt::format("  max command acceleration  {:.3f} rad/s2\n", joint_acceleration_radps2_);
  text += fmt::format("  cycles                    {} of {}, {} skipped\n", rows_, scenario.periods + 1, skipped);
  text += fmt::format("  cycle CPU time            mean {:.1f} us, max {:.1f} us\n", mean_us, cycle_time_max_s_ * 1e6);
  if (last_.rejected_messages > 0) {
    text += fmt::format("  the controller rejected   {} messages\n", last_.rejected_messages);
  }
  return text;
}

}  // namespace sidestep::sim
