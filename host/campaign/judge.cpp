#include "host/campaign/judge.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {
namespace {

constexpr double kNear_m = 0.15;  // farther than anything moves in a period

/// When the witness has arrived for good.
double witness_arrival_s(const Scene& scene) {
  const Vector3 goal_m = scene.arm->pose(scene.goal_rad).tool();
  for (int k = scene.periods; k >= 0; --k)
    if ((scene.arm->pose(witness_rad(scene, k * kPeriod_s)).tool() - goal_m).norm() >= kArrived_m)
      return (k + 1) * kPeriod_s;
  return 0.0;
}

}  // namespace

Judge::Judge(const Scene& scene, const Joints& qd_radps)
    : scene_(scene),
      limits_(scene.arm->limits(*scene.family)),
      smoothness_(qd_radps),
      start_rotation_(scene.arm->pose(scene.start_rad).tool_rotation),
      last_rad_(scene.start_rad) {
  outcome_.obstacles = static_cast<double>(scene.spheres.size());
  outcome_.duration_s = scene.duration_s();
  if (scene.family->dodge) return;
  outcome_.witness_arrival_s = witness_arrival_s(scene);
  outcome_.witness_path_rad = (scene.goal_rad - scene.start_rad).norm();
}

bool Judge::counts(double t_s, double error_m) {
  if (scene_.family->dodge) return t_s >= pass_begins_s(scene_) && t_s <= pass_ends_s(scene_);
  caught_ = caught_ || error_m < kArrived_m;
  return scene_.family->chase && caught_;
}

void Judge::see(int k, const Joints& q_rad) {
  const double t_s = k * kPeriod_s;
  const ArmPose arm = scene_.arm->pose(q_rad);
  see_clearance(arm, q_rad, t_s);
  see_joints(q_rad);
  see_tool(arm, t_s);
}

void Judge::see_clearance(const ArmPose& arm, const Joints& q_rad, double t_s) {
  const double clearance_m = clearance_at(scene_, arm, t_s, std::max(kNear_m, outcome_.clearance_m));
  near_ = clearance_m < kNear_m;
  outcome_.clearance_m = std::min(outcome_.clearance_m, clearance_m);
  const int looks = scene_.arm->looks_per_period();
  for (int i = 1; i < looks && near_; ++i) {
    const double back = static_cast<double>(i) / looks;
    const ArmPose between = scene_.arm->pose(q_rad + back * (last_rad_ - q_rad));
    outcome_.clearance_m = clearance_at(scene_, between, t_s - back * kPeriod_s, outcome_.clearance_m);
  }
}

void Judge::see_joints(const Joints& q_rad) {
  outcome_.path_rad += (q_rad - last_rad_).norm();
  last_rad_ = q_rad;
  const Joints margin_rad = (q_rad - limits_.lower_rad).cwiseMin(limits_.upper_rad - q_rad);
  outcome_.limit_margin_rad = std::fmin(outcome_.limit_margin_rad, margin_rad.minCoeff());
}

void Judge::see_tool(const ArmPose& arm, double t_s) {
  const double error_m = (target_at(scene_, t_s).position_m - arm.tool()).norm();
  outcome_.final_error_m = error_m;
  if (error_m >= kArrived_m) far_until_s_ = t_s;
  if (!counts(t_s, error_m)) return;
  ++counted_;
  if (error_m < kArrived_m) ++on_target_;
  squares_m2_ += error_m * error_m;
  outcome_.error_max_m = std::fmax(outcome_.error_max_m, error_m);
  const Matrix3 wanted =
      scene_.family->full_pose ? turning_at(scene_, t_s)->orientation.toRotationMatrix() : start_rotation_;
  const double turn_rad = Eigen::AngleAxisd(arm.tool_rotation * wanted.transpose()).angle();
  squares_rad2_ += turn_rad * turn_rad;
}

void Judge::hear(const Joints& velocity_radps, double cpu_s) {
  smoothness_.add(velocity_radps, near_);
  cpu_s_ += cpu_s;
  ++cycles_;
  outcome_.cpu_worst_s = std::fmax(outcome_.cpu_worst_s, cpu_s);
}

Outcome Judge::verdict() const {
  Outcome outcome = outcome_;
  if (outcome.final_error_m < kArrived_m) outcome.arrival_s = far_until_s_ < 0.0 ? 0.0 : far_until_s_ + kPeriod_s;
  if (counted_ > 0) outcome.error_rms_m = std::sqrt(squares_m2_ / counted_);
  if (counted_ > 0 && scene_.family->chase) outcome.on_target_share = static_cast<double>(on_target_) / counted_;
  if (counted_ > 0 && (scene_.family->dodge || scene_.family->full_pose))
    outcome.turn_rms_rad = std::sqrt(squares_rad2_ / counted_);
  outcome.speed_radps = smoothness_.speed_radps();
  outcome.acceleration_radps2 = smoothness_.acceleration_radps2();
  outcome.jerk_radps3 = smoothness_.jerk_radps3();
  outcome.chatter_per_s = smoothness_.chatter_per_s();
  if (cycles_ > 0) outcome.cpu_mean_s = cpu_s_ / cycles_;
  return outcome;
}

}  // namespace sidestep::campaign
