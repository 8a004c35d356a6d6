// What joins neighbours' links and our own obstacles, and the gate behind it: bytes of any kind, as if they had come
// over LCM. The first byte of the input says from whom.
#include "firmware/io/lcm/obstacle_merger.h"

#include "firmware/io/lcm/admission.h"
#include "tests/fuzz/require.h"

using namespace sidestep;

namespace {

Config between_two() {
  Config config;
  config.model.arm.joints = 7;
  config.neighbours.listen = {"LEFT", "RIGHT"};
  config.neighbours.world_from_base = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vector3::UnitX());
  return config;
}

struct Listener {
  Config config = between_two();
  ObstacleMerger obstacle_merger{config};
  Admission gate{7, config.model.settings};
  ObstacleSet set;
  double now_s = 0.0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto listener = std::make_unique<Listener>();  // kept, so that messages follow each other as in life
  if (size == 0) return 0;
  listener->now_s += 1e-4;  // so that a whole set comes together before its parts are too old
  const auto whole = listener->obstacle_merger.join(data[0] % 3u, data + 1, size - 1, listener->now_s);
  if (!whole) return 0;
  fuzz::require(whole->age_s >= 0.0);
  const double since_s = listener->now_s - whole->age_s;
  if (listener->gate.admit(whole->packet.bytes, whole->packet.size, since_s, listener->set))
    fuzz::require_plausible(listener->set);
  return 0;
}
