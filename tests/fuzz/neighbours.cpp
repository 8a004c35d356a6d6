// Obstacles of several senders: arbitrary bytes as if received over LCM. The first byte of the input is the sender.
#include <memory>

#include "tests/fuzz/require.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;

namespace {

Neighbours two_neighbours() {
  return {"", {"LEFT", "RIGHT"}, Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vector3::UnitX())};
}

struct Subscriber {
  test::TestInputs inputs{7, Settings{}, kSidestepDialect, two_neighbours()};
  ObstacleSet set;
  double now_s = 0.0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto subscriber =
      std::make_unique<Subscriber>();  // kept, so that messages follow each other as in a run
  if (size == 0) return 0;
  subscriber->now_s += 1e-4;  // small, so that all parts arrive before the oldest one times out
  if (subscriber->inputs.receive_part(data[0] % 3u, data + 1, size - 1, subscriber->now_s, subscriber->set)) {
    fuzz::require(subscriber->inputs.obstacles_received_s() <= subscriber->now_s);
    fuzz::require_plausible(subscriber->set);
  }
  return 0;
}
