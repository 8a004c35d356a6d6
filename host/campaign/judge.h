#pragma once

#include "host/campaign/metrics.h"
#include "host/campaign/scene.h"
#include "host/campaign/smoothness.h"

namespace sidestep::campaign {

/// Where something is nearer than this at the end of a period, the judge also looks at instants within the period.
constexpr double kNear_m = 0.15;      // more than the arm and an obstacle can close in one period
constexpr double kSelfNear_m = 0.05;  // the same for two links

/// Number of these instants, the end of the period included: with 5 those that are 0, 1/5, ..., 4/5 of a period before
/// its end.
int contact_checks(const Scene& scene);

/// An instant at which the arm and an obstacle overlap.
struct Contact {
  int period;   ///< at whose end the instant is, or within which
  double back;  ///< how long before that end, in periods; less than 1
  double clearance_m;
};

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

  /// All instants with contact at which the judge looked, by periods.
  const std::vector<Contact>& contacts() const { return contacts_; }

 private:
  /// Least clearances to obstacles and between links at period k and, where one of them is small, at instants between
  /// the last period and this one.
  void measure_clearance(const ArmPose& arm, const Joints& q_rad, int k);
  void count_clearance(const Contact& instant);
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
  std::vector<Contact> contacts_;
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
