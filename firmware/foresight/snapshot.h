#pragma once

#include "firmware/control/cycle.h"

namespace sidestep {

constexpr int kMaxNearbyObstacles = 64;

/// Obstacles that may come near the arm soon, reported and static ones, at one instant.
struct NearbyObstacles {
  int count = 0;
  std::array<Obstacle, kMaxNearbyObstacles> obstacles;
};

/// The input of foresight: the state of one control cycle and the world as that cycle extrapolated it.
struct Snapshot {
  bool moves = false;       ///< the mode is HOLD or TRACK; if false, the other fields are not valid
  bool tracking = false;    ///< the mode is TRACK; in HOLD there is no target
  double now_s = 0.0;       ///< of the cycle, on its clock
  State state;              ///< after the cycle
  ArmState arm;             ///< of the cycle
  Target target;            ///< extrapolated to now_s
  OtherJoints others;       ///< of the cycle; foresight assumes that they rest
  Attachments attachments;  ///< of the cycle
  NearbyObstacles nearby;   ///< extrapolated to now_s and grown by their uncertainty
};

/// What hangs on the chain. The attachments must outlive the result.
OtherFrames place_others(const Arm& arm, const OtherJoints& joints, const Attachments& attachments);

/// Fills `snapshot` from the inputs of a cycle and the state after it. If there are more than kMaxNearbyObstacles
/// obstacles, the snapshot keeps those that come nearest to the moving links, as they are now, within
/// foresight.horizon_s. For this the obstacles are taken as their enclosing balls at constant velocity. Bounded; no
/// allocation.
void take_snapshot(const Model& model, const Inputs& inputs, const State& state, double now_s, Snapshot& snapshot);

}  // namespace sidestep
