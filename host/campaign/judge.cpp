#include "host/campaign/judge.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {
namespace {

constexpr double kFurnitureNear_m = 0.05, kFurnitureSelfNear_m = 0.02;  // kNear_m where most of the scene rests
constexpr int kPeopleChecks = 5;                                        // a hand may move 60 mm in a period

/// The time from which on the witness's tool stays within kArrived_m of its goal.
double witness_arrival_s(const Scene& scene) {
  const Vector3 goal_m = scene.arm->pose(scene.goal_rad).tool();
  for (int k = scene.periods; k >= 0; --k)
    if ((scene.arm->pose(witness_rad(scene, k * kPeriod_s)).tool() - goal_m).norm() >= kArrived_m)
      return (k + 1) * kPeriod_s;
  return 0.0;
}

}  // namespace

int contact_checks(const Scene& scene) {
  const int own = scene.arm->contact_checks_per_period();
  return scene.family->has_people() ? std::max(own, kPeopleChecks) : own;
}

Judge::Judge(const Scene& scene, const Joints& qd_radps)
    : scene_(scene),
      limits_(scene.arm->limits(*scene.family)),
      smoothness_(qd_radps),
      start_rotation_(scene.arm->pose(scene.start_rad).tool_rotation),
      last_rad_(scene.start_rad) {
  metrics_.obstacles =
      static_cast<double>(scene.spheres.size() + scene.boxes.size() + scene.capsules.size() + scene.furniture.size());
  metrics_.duration_s = scene.duration_s();
  if (scene.family->dodge || scene.family->has_people() || scene.family->boxes) return;
  metrics_.witness_arrival_s = witness_arrival_s(scene);
  metrics_.witness_path_rad =
      scene.witness_path.empty() ? (scene.goal_rad - scene.start_rad).norm() : scene.witness_path.length_rad();
  if (scene.family->has_furniture()) measure_goal_clearance();
}

void Judge::measure_goal_clearance() {
  const ArmPose goal = scene_.arm->pose(scene_.goal_rad);
  metrics_.goal_clearance_m = scene_.arm->solid_clearance(goal, scene_.furniture);
  metrics_.model_goal_clearance_m = scene_.arm->controller_solid_clearance(goal, scene_.furniture);
}

bool Judge::is_scored(double t_s, double error_m) {
  if (scene_.family->dodge) return t_s >= pass_begins_s(scene_) && t_s <= pass_ends_s(scene_);
  reached_ = reached_ || error_m < kArrived_m;
  return scene_.family->chase && reached_;
}

void Judge::record_state(int k, const Joints& q_rad) {
  const double t_s = k * kPeriod_s;
  const ArmPose arm = scene_.arm->pose(q_rad);
  measure_clearance(arm, q_rad, k);
  measure_joints(q_rad);
  measure_tool_error(arm, t_s);
  measure_arrival(q_rad, t_s);
}

bool Judge::is_decided() const {
  return scene_.family->boxes && at_goal_ && now_s_ - far_until_s_ > kDwell_s;
}

void Judge::measure_clearance(const ArmPose& arm, const Joints& q_rad, int k) {
  const double t_s = k * kPeriod_s;
  const double clearance_m = clearance_at(scene_, arm, t_s, std::max(kNear_m, metrics_.clearance_m));
  near_ = clearance_m < kNear_m;
  count_clearance({k, 0.0, clearance_m});
  measure_mover(arm, t_s);
  const double links_m = measure_self_clearance(arm);
  const bool rests = scene_.family->has_furniture();  // and is always near: only what is very near is looked at closely
  const bool look_between =
      rests ? clearance_m < kFurnitureNear_m || links_m < kFurnitureSelfNear_m : near_ || links_m < kSelfNear_m;
  const int checks = contact_checks(scene_);
  for (int i = 1; i < checks && look_between; ++i) {
    const double back = static_cast<double>(i) / checks;
    const ArmPose between = scene_.arm->pose(q_rad + back * (last_rad_ - q_rad));
    const double within_m = std::max(0.0, metrics_.clearance_m);
    count_clearance({k, back, clearance_at(scene_, between, t_s - back * kPeriod_s, within_m)});
    measure_mover(between, t_s - back * kPeriod_s);
    measure_self_clearance(between);
  }
}

void Judge::count_clearance(const Contact& instant) {
  metrics_.clearance_m = std::min(metrics_.clearance_m, instant.clearance_m);
  if (instant.clearance_m < 0.0) contacts_.push_back(instant);
}

void Judge::measure_mover(const ArmPose& arm, double t_s) {
  if (!scene_.family->mover) return;
  metrics_.mover_clearance_m = std::fmin(metrics_.mover_clearance_m, sphere_clearance_at(scene_, arm, t_s));
}

double Judge::measure_self_clearance(const ArmPose& arm) {
  const double clearance_m = scene_.arm->self_clearance(arm, kSelfNear_m);
  if (clearance_m < kSelfNear_m) metrics_.self_clearance_m = std::min(metrics_.self_clearance_m, clearance_m);
  return clearance_m;
}

void Judge::measure_joints(const Joints& q_rad) {
  metrics_.path_rad += (q_rad - last_rad_).norm();
  last_rad_ = q_rad;
  const Joints margin_rad = (q_rad - limits_.lower_rad).cwiseMin(limits_.upper_rad - q_rad);
  metrics_.limit_margin_rad = std::fmin(metrics_.limit_margin_rad, margin_rad.minCoeff());
}

void Judge::measure_tool_error(const ArmPose& arm, double t_s) {
  const double error_m = (target_at(scene_, t_s).position_m - arm.tool()).norm();
  metrics_.final_error_m = error_m;
  measure_turn(arm);
  if (!is_scored(t_s, error_m)) return;
  ++scored_;
  if (error_m < kArrived_m) ++on_target_;
  squares_m2_ += error_m * error_m;
  metrics_.error_max_m = std::fmax(metrics_.error_max_m, error_m);
  const Matrix3 reference =
      scene_.family->full_pose ? orientation_target_at(scene_, t_s)->orientation.toRotationMatrix() : start_rotation_;
  const double turn_rad = Eigen::AngleAxisd(arm.tool_rotation * reference.transpose()).angle();
  squares_rad2_ += turn_rad * turn_rad;
}

void Judge::measure_arrival(const Joints& q_rad, double t_s) {
  now_s_ = t_s;
  at_goal_ = metrics_.final_error_m < kArrived_m && turn_rad_ < kArrived_rad;
  if (scene_.family->posture) {
    metrics_.final_posture_rad = (q_rad - scene_.goal_rad).cwiseAbs().maxCoeff();
    at_goal_ = metrics_.final_posture_rad < kArrivedJoint_rad;
  }
  if (!at_goal_) far_until_s_ = t_s;
}

void Judge::measure_turn(const ArmPose& arm) {
  if (!scene_.goal_has_orientation) return;
  const Eigen::Quaterniond goal = orientation_target_at(scene_, 0.0)->orientation;
  metrics_.final_turn_rad = turn_rad_ = goal.angularDistance(Eigen::Quaterniond(arm.tool_rotation));
}

void Judge::record_command(const Joints& velocity_radps, double cpu_s) {
  smoothness_.add(velocity_radps, near_);
  cpu_s_ += cpu_s;
  ++cycles_;
  metrics_.cpu_worst_s = std::fmax(metrics_.cpu_worst_s, cpu_s);
}

TrialMetrics Judge::metrics() const {
  TrialMetrics metrics = metrics_;
  if (at_goal_) metrics.arrival_s = far_until_s_ < 0.0 ? 0.0 : far_until_s_ + kPeriod_s;
  if (scored_ > 0) metrics.error_rms_m = std::sqrt(squares_m2_ / scored_);
  if (scored_ > 0 && scene_.family->chase) metrics.on_target_share = static_cast<double>(on_target_) / scored_;
  if (scored_ > 0 && (scene_.family->dodge || scene_.family->full_pose))
    metrics.turn_rms_rad = std::sqrt(squares_rad2_ / scored_);
  metrics.speed_radps = smoothness_.speed_radps();
  metrics.acceleration_radps2 = smoothness_.acceleration_radps2();
  metrics.jerk_radps3 = smoothness_.jerk_radps3();
  metrics.chatter_per_s = smoothness_.chatter_per_s();
  if (cycles_ > 0) metrics.cpu_mean_s = cpu_s_ / cycles_;
  return metrics;
}

}  // namespace sidestep::campaign
