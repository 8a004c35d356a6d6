#include "host/sim/record.h"

#include <fmt/format.h>

#include <stdexcept>

namespace sidestep::sim {
namespace {

class Line {
 public:
  Line& add(double value) {
    text_ += fmt::format("{}{:.17g}", text_.empty() ? "" : ",", value);
    return *this;
  }

  Line& add(const Eigen::Ref<const Eigen::VectorXd>& values) {
    for (const double value : values) add(value);
    return *this;
  }

  std::string end() { return text_ + '\n'; }

 private:
  std::string text_;
};

/// NaN without a target.
Eigen::Vector3d target_m(const World& world) {
  if (world.target) return world.target->motion.position_m;
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

std::string per_joint(const std::string& pattern, int joints) {
  std::string names;
  for (int i = 1; i <= joints; ++i) names += fmt::format(fmt::runtime("," + pattern), i);
  return names;
}

std::string header(int joints, int obstacles) {
  std::string names = "t_s" + per_joint("q{}_rad", joints) + per_joint("qd{}_radps", joints) +
                      per_joint("command_qd{}_radps", joints) +
                      ",tool_x_m,tool_y_m,tool_z_m,target_x_m,target_y_m,target_z_m"
                      ",target_distance_m,clearance_m,axis_distance_m";
  for (int i = 1; i <= obstacles; ++i) {
    names += fmt::format(
        ",o{0}_x_m,o{0}_y_m,o{0}_z_m,o{0}_qw,o{0}_qx,o{0}_qy,o{0}_qz,o{0}_axis_distance_m,o{0}_clearance_m", i);
  }
  names += ",mode,cycle_time_s,beta,damping,foresight,guide_horizon_s";
  for (int i = 1; i <= Status{}.guide_tool_m.cols(); ++i)
    names += fmt::format(",guide{0}_x_m,guide{0}_y_m,guide{0}_z_m", i);
  return names + ",neighbour_clearance_m,self_clearance_m\n";
}

}  // namespace

void evaluate(Row& row, const Truth& truth) {
  row.tool_m = truth.tool_m();
  row.target_distance_m = (target_m(row.world) - row.tool_m).norm();
  row.nearest = truth.nearest_in(row.world);
  row.axis_distance_m = truth.axis_distance_m(row.world.obstacles);
  row.nearest_links = truth.nearest_links(kSelfRange_m);
}

CsvFile::CsvFile(const std::string& file, int joints, int obstacles) : file_(file), out_(file) {
  out_ << header(joints, obstacles) << std::flush;
  if (!out_) throw std::runtime_error(file_ + ": cannot be written");
}

void CsvFile::write(const Row& row, const Truth& truth) {
  Line line;
  line.add(row.t_s).add(row.q_rad).add(row.qd_radps).add(row.command_radps);
  line.add(row.tool_m).add(target_m(row.world));
  line.add(row.target_distance_m).add(row.nearest.clearance_m).add(row.axis_distance_m);
  for (const Obstacle& obstacle : row.world.obstacles) {
    const Eigen::Quaterniond& q = obstacle.motion.orientation;
    line.add(obstacle.motion.position_m).add(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
    line.add(truth.axis_distance_m(obstacle)).add(truth.clearance_m(obstacle));
  }
  line.add(static_cast<double>(row.status.mode)).add(row.status.cycle_time_s);
  line.add(row.status.beta).add(row.status.damping);
  line.add(row.status.foresight).add(row.status.guide_horizon_s);
  line.add(row.status.guide_tool_m.reshaped());
  line.add(row.neighbour_m).add(row.nearest_links.clearance_m);
  out_ << line.end();
}

void CsvFile::close() {
  out_.close();
  if (!out_) throw std::runtime_error(file_ + ": could not be written completely");
}

}  // namespace sidestep::sim
