#pragma once

#include "firmware/control/cycle.h"

namespace sidestep {

constexpr int kMaxNearbyObstacles = 64;

/// The obstacles that may matter in the near future, as they are at one instant.
struct NearbyObstacles {
  int count = 0;
  std::array<Obstacle, kMaxNearbyObstacles> obstacles;
};

/// The world as one cycle saw it: what foresight thinks about.
struct Snapshot {
  bool tracking = false;  ///< the rest is valid
  double now_s = 0.0;
  State state;  ///< after the cycle
  ArmState arm;
  Target target;
  NearbyObstacles nearby;
};

/// What foresight needs of the inputs of a cycle and of the state it led to. Of more than kMaxMovers obstacles those
/// that come nearest to the base within horizon_s. Bounded, without allocation.
void take_snapshot(const Model& model, const Inputs& inputs, const State& state, double now_s, Snapshot& snapshot);

}  // namespace sidestep
