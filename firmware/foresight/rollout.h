#pragma once

#include "firmware/foresight/snapshot.h"
#include "firmware/model/kinematics.h"

namespace sidestep {

/// How a future turned out.
struct Forecast {
  bool arrives = false;   ///< is at the target in the end
  bool collides = false;  ///< comes so near to an obstacle that it may touch
  double cost_s = 0.0;    ///< time away from the target, and more for what must not be
};

/// Plays the future with the real step(), a coarser period and obstacles and target that go on as they move now. Large:
/// lives on the heap.
class Rollout {
 public:
  explicit Rollout(const Model& model);

  /// From a snapshot on, under a guide, for the settings' horizon. No allocation; bounded by the horizon.
  Forecast run(const Snapshot& from, const Guide& guide);

 private:
  Model coarse_;
  ObstacleSet obstacles_;
};

/// How far ahead a target is believed to keep its velocity.
constexpr double kTargetBelieved_s = 1.0;

/// The target after a while.
Target predicted_target(const Target& target, double after_s);

/// Whether the tool is where the target asks for it.
bool is_at(const LinkPoses& poses, const Target& target);

}  // namespace sidestep
