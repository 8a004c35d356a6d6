#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "firmware/foresight/foresight.h"
#include "firmware/model/prediction.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"

namespace sidestep::test {

/// The LWA3 in a closed loop, with foresight within the cycle, as in lockstep.
struct ForesightLoop {
  ClosedLoop loop;
  std::unique_ptr<Foresight> foresight;
  std::unique_ptr<Snapshot> snapshot = std::make_unique<Snapshot>();
  const Guide* guide = nullptr;
  double least_m = 1.0;

  explicit ForesightLoop(const Target& target, const JointVector& start_rad = home_rad(),
                         const std::string& law = "sidestep", bool enabled = true)
      : loop(lwa3_model(law), start_rad) {
    bool& enables = loop.model.settings.foresight.enabled;
    enables = enables && enabled;
    loop.target = target;
    loop.sends_target = true;
    if (enables) foresight = std::make_unique<Foresight>(loop.model);
  }

  void cycle() {
    Inputs inputs = loop.receive();
    inputs.guide = guide;
    loop.follow(step(loop.model, loop.state, inputs, loop.now_s()));
    if (foresight) {
      take_snapshot(loop.model, inputs, loop.state, loop.now_s(), *snapshot);
      guide = &foresight->update(*snapshot);
    }
    least_m = std::min(least_m, clearance_m(loop.arm.position_rad));
  }
  void run(double duration_s) {
    for (int i = 0; i < std::lround(duration_s * 100); ++i) cycle();
  }
  double clearance_m(const JointVector& q_rad) const {
    const LinkPoses poses = forward_kinematics(loop.model.arm, q_rad);
    return clearance_after(loop.model.arm, poses, loop.obstacles->obstacles.data(), loop.obstacles->count, 0.0, 1.0);
  }
  double error_m() const {
    return (forward_kinematics(loop.model.arm, loop.arm.position_rad).tool_position - loop.target.position_m).norm();
  }
};

inline Target point_target(const Vector3& position_m) {
  Target target;
  target.position_m = position_m;
  return target;
}

}  // namespace sidestep::test
