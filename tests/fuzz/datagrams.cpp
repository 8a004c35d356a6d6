// The receiving side from the socket on: arbitrary bytes, cut into datagrams, as if received by the UDP socket. Each
// datagram is a byte for its sender, two for its size and its content.
#include <array>
#include <memory>

#include "firmware/io/lcm/fragment_assembly.h"
#include "firmware/io/lcm/message_decoder.h"
#include "tests/fuzz/require.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using fuzz::require;

namespace {

constexpr int kJoints = 7;
constexpr size_t kPrefix = 3;

/// Kept, so that datagrams follow each other as in a run.
struct Receiver {
  FragmentAssembly assembly{kLargestMessageBytes};
  int arm_channel = assembly.subscribe("ARM_STATE");
  int target_channel = assembly.subscribe("TARGET");
  int obstacles_channel = assembly.subscribe("OBSTACLES");
  test::TestInputs inputs{kJoints, Settings{}};
  ArmState arm;
  Target target;
  ObstacleSet obstacles;
  double now_s = 0.0;

  void receive(const Sender& sender, Packet datagram) {
    // In memory of its own: the sanitizer sees each byte that is read behind its end.
    const std::unique_ptr<uint8_t[]> exact(new uint8_t[datagram.size]);
    std::copy_n(datagram.bytes, datagram.size, exact.get());
    const auto message = assembly.add(sender, {exact.get(), datagram.size});
    if (!message) return;
    require(message->packet.size <= kLargestMessageBytes);
    now_s += 0.01;
    const uint8_t* bytes = message->packet.bytes;
    const size_t size = message->packet.size;
    if (message->channel == arm_channel && inputs.receive(bytes, size, now_s, arm)) require(plausible(arm, kJoints));
    if (message->channel == target_channel && inputs.receive(bytes, size, now_s, target)) require(plausible(target));
    if (message->channel == obstacles_channel && inputs.receive(bytes, size, now_s, obstacles))
      fuzz::require_plausible(obstacles);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto receiver = std::make_unique<Receiver>();
  while (size >= kPrefix) {
    const Sender sender{0x7f000001, data[0]};
    const size_t content = std::min(size - kPrefix, static_cast<size_t>(data[1]) << 8 | data[2]);
    receiver->receive(sender, {data + kPrefix, content});
    data += kPrefix + content;
    size -= kPrefix + content;
  }
  return 0;
}
