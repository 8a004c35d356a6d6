// The inbound side of a loop: arbitrary bytes as if received over LCM. The first byte of the input is the channel.
#include <memory>

#include "tests/fuzz/require.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using fuzz::require;

namespace {

constexpr int kJoints = 7;

struct FuzzedInputs {
  test::TestInputs sidestep{kJoints, Settings{}}, iiwa{kJoints, Settings{}, kIiwaDialect};
  ArmState arm;
  Target target;
  ObstacleSet obstacles;
  Control control;
  Attachments attachments;
  double now_s = 0.0;
};

void require_arm(const ArmState& arm) {
  require(plausible(arm, kJoints));
  require(arm.held_rad.size() == 0 || (arm.held_rad.size() == kJoints && arm.held_rad.allFinite()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto inputs = std::make_unique<FuzzedInputs>();  // kept, so that messages follow each other as in a run
  if (size == 0) return 0;
  inputs->now_s += 0.01;
  const uint8_t channel = data[0] % 7;
  ++data, --size;
  if (channel == 0 && inputs->sidestep.receive(data, size, inputs->now_s, inputs->arm)) require_arm(inputs->arm);
  if (channel == 1 && inputs->sidestep.receive(data, size, inputs->now_s, inputs->target))
    require(plausible(inputs->target));
  if (channel == 2 && inputs->sidestep.receive(data, size, inputs->now_s, inputs->obstacles))
    fuzz::require_plausible(inputs->obstacles);
  if (channel == 3 && inputs->iiwa.receive(data, size, inputs->now_s, inputs->arm)) require_arm(inputs->arm);
  if (channel == 4 && inputs->sidestep.receive(data, size, inputs->now_s, inputs->control))
    require(plausible(inputs->control));
  if (channel == 5 && inputs->sidestep.receive(data, size, inputs->now_s, inputs->attachments)) {
    for (const Obstacle& shape : inputs->attachments.shapes) require(plausible(shape));
    require(inputs->attachments.held.size() == inputs->attachments.shapes.size());
  }
  if (channel == 6 && inputs->sidestep.receive_joint_target(data, size, inputs->now_s, inputs->target))
    require(plausible(inputs->target) && inputs->target.posture_rad.size() == 7);
  return 0;
}
