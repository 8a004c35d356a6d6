#pragma once

#include "firmware/foresight/snapshot.h"
#include "firmware/model/kinematics.h"

namespace sidestep {

/// The result of a rollout.
struct Forecast {
  bool arrives = false;   ///< the tool is at the target at the end
  bool collides = false;  ///< the clearance falls below 10 mm; a contact is then assumed possible
  double cost_s = 0.0;    ///< time away from the target, + 5 s if it does not arrive, + 20 s if it collides
};

/// Simulates the next foresight.horizon_s seconds with the controller's own step() and an ideal arm, which follows each
/// command exactly. The period is 30 ms, unless the controller's is longer. Obstacles keep their velocities; the target
/// moves as predicted_target(). About 600 kB: lives on the heap.
class Rollout {
 public:
  explicit Rollout(const Model& model);

  /// From a snapshot with tracking = true, under a guide (no knots: the law alone). No allocation.
  Forecast run(const Snapshot& from, const Guide& guide);

 private:
  Model coarse_;
  ObstacleSet obstacles_;
};

/// For how long a target is assumed to keep its velocity.
constexpr double kTargetCoast_s = 1.0;

/// The target after_s later: it keeps its velocity for kTargetCoast_s and then rests.
Target predicted_target(const Target& target, double after_s);

/// Whether the tool is within 10 mm of the target and, where the target tracks orientation, within 0.05 rad.
bool is_at(const LinkPoses& poses, const Target& target);

}  // namespace sidestep
