#include "firmware/control/extrapolation.h"

#include <algorithm>

namespace sidestep {
namespace {

/// A posture target within the position limits, with the tool's place in the posture.
Target within_limits(const Arm& arm, Target target) {
  target.posture_rad = target.posture_rad.cwiseMax(arm.limits.lower_rad).cwiseMin(arm.limits.upper_rad);
  target.position_m = forward_kinematics(arm, target.posture_rad).tool_position;
  return target;
}

}  // namespace

ObstacleView view_obstacles(const Model& model, const Latest<ObstacleSet>& obstacles, double now_s) {
  if (!obstacles.message) return {nullptr, 0.0, 0.0, &model.surroundings};
  const Settings& settings = model.settings;
  const ObstacleTrust& trust = settings.obstacle_trust;
  const double age_s = std::max(0.0, obstacles.age_s(now_s)) + trust.latency_s;  // the clock may have been set back
  const double by_speed_m = age_s * settings.obstacle_speed_bound_mps;
  const double by_acceleration_m = std::min(by_speed_m, 0.5 * trust.acceleration_bound_mps2 * age_s * age_s);
  const bool fresh = obstacles.fresh(now_s, settings.timeouts.obstacles_s);
  return {obstacles.message, age_s, trust.uncertainty_m + by_acceleration_m, &model.surroundings,
          fresh ? 0.0 : by_speed_m - by_acceleration_m};
}

OtherFrames present_others(const Model& model, const Inputs& inputs, double now_s) {
  const Latest<OtherJoints>& joints = inputs.other_joints;
  OtherFrames frames = joints.message ? place_other_joints(model.arm, *joints.message) : model.arm.other_frames;
  if (joints.message && !joints.fresh(now_s, model.settings.timeouts.obstacles_s))
    for (OtherFrame& frame : frames.joints) frame.velocity = 0.0;
  const Attachments* attachments = inputs.attachments.message;
  if (attachments && !attachments->is_empty()) frames.attachments = attachments;
  return frames;
}

Target extrapolated(const Target& target, double dt_s) {
  Target later = target;
  later.position_m += target.velocity_mps * dt_s;
  const Vector3 turn = target.angular_velocity_radps * dt_s;
  if (target.tracks_orientation && turn.squaredNorm() > 0.0)
    later.orientation = Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * target.orientation;
  return later;
}

Target bounded_speed(const Arm& arm, const TaskJacobian& tool_jacobian, const Target& target) {
  const auto followable_share = [&](const PointJacobian& rows, const Vector3& velocity) {
    const double along = (rows.transpose() * velocity).cwiseAbs().dot(arm.limits.velocity_radps);
    return along < velocity.squaredNorm() ? along / velocity.squaredNorm() : 1.0;
  };
  Target bounded = target;
  bounded.velocity_mps *= followable_share(tool_jacobian.topRows<3>(), target.velocity_mps);
  if (tool_jacobian.rows() == 6)
    bounded.angular_velocity_radps *= followable_share(tool_jacobian.bottomRows<3>(), target.angular_velocity_radps);
  return bounded;
}

Target present_target(const Model& model, const TaskJacobian& tool_jacobian, const Latest<Target>& latest,
                      double now_s) {
  const Target& target = *latest.message;
  if (target.is_posture()) return within_limits(model.arm, target);
  return extrapolated(model.settings.bounds_target_speed ? bounded_speed(model.arm, tool_jacobian, target) : target,
                      latest.age_s(now_s));
}

}  // namespace sidestep
