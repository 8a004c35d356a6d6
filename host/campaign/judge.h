#pragma once

#include "host/campaign/metrics.h"
#include "host/campaign/scene.h"
#include "host/campaign/smoothness.h"

namespace sidestep::campaign {

/// Measures one trial from the true motion of the arm and of the spheres.
class Judge {
 public:
  /// qd_radps: the last command before t = 0. It is not zero if the controller evaded before it tracked.
  Judge(const Scene& scene, const Joints& qd_radps);

  /// Configuration of the arm at period k; to be called for k = 0, 1, ...
  void record_state(int k, const Joints& q_rad);

  /// The command of the cycle that follows, and its CPU time.
  void record_command(const Joints& velocity_radps, double cpu_s);

  /// Whether the trial may end early: among boxes, which may cover the goal again, when the arm has arrived.
  bool is_decided() const;

  /// To be called after the last period.
  TrialMetrics metrics() const;

 private:
  /// Least clearances to obstacles and between links at this period and, where one of them is small, at instants
  /// between the last period and this one.
  void measure_clearance(const ArmPose& arm, const Joints& q_rad, double t_s);
  void measure_mover(const ArmPose& arm, double t_s);
  /// Least clearance between links, as far as links are near each other.
  double measure_self_clearance(const ArmPose& arm);
  void measure_joints(const Joints& q_rad);
  void measure_tool_error(const ArmPose& arm, double t_s);
  void measure_arrival(const Joints& q_rad, double t_s);
  /// Only among furniture, whose goal rests.
  void measure_turn(const ArmPose& arm);
  void measure_goal_clearance();
  /// Whether the tool error at t_s is part of its root mean square.
  bool is_scored(double t_s, double error_m);

  const Scene& scene_;
  Limits limits_;
  TrialMetrics metrics_;
  Smoothness smoothness_;
  Matrix3 start_rotation_;
  Joints last_rad_;
  double turn_rad_ = 0.0;  ///< orientation error of the tool, if the goal has an orientation
  bool near_ = false;
  bool reached_ = false;
  bool at_goal_ = false;
  double far_until_s_ = -1.0;  ///< the last time at which the arm was not at its goal
  double now_s_ = 0.0;
  double squares_m2_ = 0.0, squares_rad2_ = 0.0;
  int scored_ = 0, on_target_ = 0;
  double cpu_s_ = 0.0;
  int cycles_ = 0;
};

}  // namespace sidestep::campaign
