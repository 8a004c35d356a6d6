#include "firmware/control/input_gate.h"

#include <algorithm>

#include "firmware/control/validation.h"

namespace sidestep {
namespace {

constexpr Verdict kAccepted{true, nullptr};

Verdict rejected(const char* reason) {
  return {false, reason};
}

}  // namespace

InputGate::InputGate(const Arm& arm, const Settings& settings, InputSource source)
    : arm_(arm),
      timeouts_(settings.timeouts),
      source_(source),
      estimates_motion_(settings.estimates_motion),
      memory_(settings.obstacle_speed_bound_mps, settings.timeouts.coast_s),
      other_joints_(arm, settings.timeouts.obstacles_s) {}

Verdict InputGate::accept(ArmState& arm, double now_s) {
  if (!plausible(arm, arm_.joints)) return rejected("arm state with impossible values");
  if (!is_ordered()) return kAccepted;
  const double received_s = source_ == InputSource::kLockstep ? static_cast<double>(arm.utime) * 1e-6 : now_s;
  return {arm_order_.accept(arm.utime, received_s, timeouts_.arm_state_lost_s), nullptr};
}

/// Postures have an order of their own, because their sender may have another clock.
Verdict InputGate::accept(Target& target, double now_s) {
  const bool fits = !target.is_posture() || target.posture_rad.size() == arm_.joints;
  if (!fits || !sanitize(target)) return rejected("target with impossible values");
  if (!is_ordered()) return kAccepted;
  MessageOrder& order = target.is_posture() ? joint_target_order_ : target_order_;
  return {order.accept(target.utime, now_s, timeouts_.target_s), nullptr};
}

/// After the timeout of targets a restarted operator is believed. A stop always counts: it must not depend on the clock
/// of another operator, who may go on sending.
Verdict InputGate::accept(Control& control, double now_s) {
  if (!plausible(control)) return rejected("control with impossible values");
  if (!is_ordered()) return kAccepted;
  const bool in_order = control_order_.accept(control.utime, now_s, timeouts_.target_s);
  return {in_order || control.command == ControlCommand::kStop, nullptr};
}

Verdict InputGate::accept(OtherJoints& joints, double now_s) {
  if (!plausible(joints)) return rejected("other joints with impossible values");
  if (is_ordered() && !other_joints_order_.accept(joints.utime, now_s, timeouts_.obstacles_s)) return {};
  other_joints_.complete(joints);
  return kAccepted;
}

Verdict InputGate::accept(Attachments& attachments, double now_s) {
  if (!sanitize(attachments)) return rejected("attachments with impossible values");
  if (is_ordered() && !attachments_order_.accept(attachments.utime, now_s, timeouts_.target_s)) return {};
  place_held_shapes(arm_, attachments);
  return kAccepted;
}

/// sending_interval_s: since the last set, without jitter. elapsed_s: the longest time that can have passed since then.
void InputGate::complete(ObstacleSet& obstacles, double sending_interval_s, double elapsed_s, double now_s) {
  if (estimates_motion_) estimator_.complete(obstacles, std::max(0.0, sending_interval_s - late_s_));
  late_s_ = 0.0;
  estimated_s_ = now_s;
  memory_.add_remembered(obstacles, elapsed_s, now_s);
}

/// Of a late set only the obstacles that the newest one lacks are news: those of another sender, whose clock is behind.
void InputGate::complete_late(ObstacleSet& late, double now_s) {
  if (!estimates_motion_) return;
  const double elapsed_s = std::max(0.0, now_s - estimated_s_);
  late_s_ += elapsed_s;
  estimated_s_ = now_s;
  const auto begin = late.obstacles.begin();
  const auto is_news = [this](const Obstacle& obstacle) { return !memory_.holds(obstacle.id); };
  const int count = late.count;
  late.count = static_cast<int>(std::partition(begin, begin + count, is_news) - begin);
  estimator_.complete(late, elapsed_s);
  late.count = count;
}

Verdict InputGate::accept(ObstacleSet& obstacles, int64_t utime, double now_s) {
  if (!sanitize(obstacles)) return rejected("obstacles with impossible values");
  if (source_ == InputSource::kRecording) return kAccepted;
  if (source_ == InputSource::kCalls) {
    const double elapsed_s = now_s - memory_.last_set_s(now_s);
    complete(obstacles, elapsed_s, elapsed_s, now_s);
    return kAccepted;
  }
  if (obstacles_order_.accept(utime, now_s, timeouts_.obstacles_s)) {
    complete(obstacles, obstacles_order_.sending_interval_s(), obstacles_order_.elapsed_s(), now_s);
    return kAccepted;
  }
  if (!obstacles_order_.is_late(utime)) return {};
  complete_late(obstacles, now_s);
  memory_.add_late_set(obstacles, timeouts_.obstacles_s, now_s);
  return {};
}

}  // namespace sidestep
