#pragma once

#include "host/campaign/outcome.h"
#include "host/campaign/scene.h"
#include "host/campaign/smoothness.h"

namespace sidestep::campaign {

/// Watches the true arm among the true spheres, at every period.
class Judge {
 public:
  /// qd_radps was commanded last: the controller may evade before it tracks.
  Judge(const Scene& scene, const Joints& qd_radps);

  /// The arm at period k; to be called for k = 0, 1, ...
  void see(int k, const Joints& q_rad);

  /// The command of the cycle that follows, and what it cost.
  void hear(const Joints& velocity_radps, double cpu_s);

  /// After the last period.
  Outcome verdict() const;

 private:
  /// At this period and, near an obstacle, between the last one and this.
  void see_clearance(const ArmPose& arm, const Joints& q_rad, double t_s);
  void see_joints(const Joints& q_rad);
  void see_tool(const ArmPose& arm, double t_s);
  /// Whether the tool error counts for its root mean square.
  bool counts(double t_s, double error_m);

  const Scene& scene_;
  Limits limits_;
  Outcome outcome_;
  Smoothness smoothness_;
  Matrix3 start_rotation_;
  Joints last_rad_;
  bool near_ = false;
  bool caught_ = false;
  double far_until_s_ = -1.0;  ///< the last time the tool was farther than an arrived one may be
  double squares_m2_ = 0.0, squares_rad2_ = 0.0;
  int counted_ = 0, on_target_ = 0;
  double cpu_s_ = 0.0;
  int cycles_ = 0;
};

}  // namespace sidestep::campaign
