#pragma once

#include <algorithm>
#include <memory>

#include "firmware/io/lcm/network_inputs.h"

namespace sidestep::test {

/// NetworkInputs for tests: hands out the values of accepted messages.
class TestInputs {
 public:
  TestInputs(int joints, const Settings& settings, const Dialect& dialect = kSidestepDialect,
             const Neighbours& neighbours = {})
      : inputs_(settings, joints, dialect, neighbours, false) {}

  /// Whether the message was accepted; then `value` is its value.
  bool receive(const void* bytes, size_t size, double now_s, ArmState& value) {
    return receive_value(bytes, size, now_s, arm_, value);
  }
  bool receive(const void* bytes, size_t size, double now_s, Target& value) {
    return receive_value(bytes, size, now_s, target_, value);
  }
  bool receive(const void* bytes, size_t size, double now_s, ObstacleSet& value) {
    return receive_part(0, bytes, size, now_s, value);
  }
  bool receive_part(size_t part, const void* bytes, size_t size, double now_s, ObstacleSet& value) {
    const Packet packet{static_cast<const uint8_t*>(bytes), size};
    if (!inputs_.receive_obstacles(part, packet, now_s, *obstacles_)) return false;
    const ObstacleSet& set = obstacles_->message;
    value.count = set.count;
    value.remembered = set.remembered;
    std::copy_n(set.obstacles.begin(), set.count, value.obstacles.begin());
    return true;
  }

  double obstacles_received_s() const { return obstacles_->received_s; }
  int64_t rejected() const { return inputs_.rejected(); }
  const char* last_reason() const { return inputs_.last_reason(); }

 private:
  template <typename Message>
  bool receive_value(const void* bytes, size_t size, double now_s, Received<Message>& received, Message& value) {
    if (!inputs_.receive(Packet{static_cast<const uint8_t*>(bytes), size}, now_s, received)) return false;
    value = received.message;
    return true;
  }

  NetworkInputs inputs_;
  Received<ArmState> arm_;
  Received<Target> target_;
  std::unique_ptr<Received<ObstacleSet>> obstacles_ = std::make_unique<Received<ObstacleSet>>();
};

}  // namespace sidestep::test
