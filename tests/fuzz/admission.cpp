// The gate for messages: bytes of any kind, as if they had come over LCM. The first byte of the input is the channel.
#include "firmware/io/lcm/admission.h"

#include <memory>

#include "tests/fuzz/require.h"

using namespace sidestep;
using fuzz::require;

namespace {

constexpr int kJoints = 7;

struct Gate {
  Admission admission{kJoints, Settings{}}, iiwa{kJoints, Settings{}, false, Dialect::kIiwa};
  ArmState arm;
  Target target;
  ObstacleSet obstacles;
  double now_s = 0.0;
};

void require_arm(const ArmState& arm) {
  require(plausible(arm, kJoints));
  require(arm.held_rad.size() == 0 || (arm.held_rad.size() == kJoints && arm.held_rad.allFinite()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto gate = std::make_unique<Gate>();  // kept, so that messages follow each other as in life
  if (size == 0) return 0;
  gate->now_s += 0.01;
  const uint8_t channel = data[0] % 4;
  ++data, --size;
  if (channel == 0 && gate->admission.admit(data, size, gate->now_s, gate->arm)) require_arm(gate->arm);
  if (channel == 1 && gate->admission.admit(data, size, gate->now_s, gate->target)) require(plausible(gate->target));
  if (channel == 2 && gate->admission.admit(data, size, gate->now_s, gate->obstacles))
    fuzz::require_plausible(gate->obstacles);
  if (channel == 3 && gate->iiwa.admit(data, size, gate->now_s, gate->arm)) require_arm(gate->arm);
  return 0;
}
