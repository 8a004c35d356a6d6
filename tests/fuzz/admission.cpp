// The gate for messages: bytes of any kind, as if they had come over LCM. The first byte of the input is the channel.
#include "firmware/io/admission.h"

#include <cstdlib>
#include <memory>

using namespace sidestep;

namespace {

constexpr int kJoints = 7;

struct Gate {
  Admission admission{kJoints, Settings{}}, iiwa{kJoints, Settings{}, false, Dialect::kIiwa};
  ArmState arm;
  Target target;
  std::unique_ptr<ObstacleSet> obstacles = std::make_unique<ObstacleSet>();
  double now_s = 0.0;
};

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static Gate gate;  // kept, so that messages follow each other as in life
  if (size == 0) return 0;
  gate.now_s += 0.01;
  const uint8_t channel = data[0] % 4;
  ++data, --size;
  if (channel == 0 && gate.admission.admit(data, size, gate.now_s, gate.arm)) require(plausible(gate.arm, kJoints));
  if (channel == 1 && gate.admission.admit(data, size, gate.now_s, gate.target)) require(plausible(gate.target));
  if (channel == 2 && gate.admission.admit(data, size, gate.now_s, *gate.obstacles)) {
    require(gate.obstacles->count >= 0 && gate.obstacles->count <= kMaxObstacles);
    for (int i = 0; i < gate.obstacles->count; ++i) require(plausible(gate.obstacles->obstacles[i]));
  }
  if (channel == 3 && gate.iiwa.admit(data, size, gate.now_s, gate.arm)) require(plausible(gate.arm, kJoints));
  return 0;
}
