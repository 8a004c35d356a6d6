#pragma once

#include <algorithm>
#include <memory>

#include "firmware/io/lcm/network_inputs.h"
#include "firmware/model/arm.h"

namespace sidestep::test {

/// NetworkInputs for tests: hands out the values of accepted messages.
class TestInputs {
 public:
  TestInputs(int joints, const Settings& settings, const Dialect& dialect = kSidestepDialect,
             const Neighbours& neighbours = {})
      : TestInputs(arm_with(joints), settings, dialect, neighbours) {}
  TestInputs(const Arm& arm, const Settings& settings, const Dialect& dialect = kSidestepDialect,
             const Neighbours& neighbours = {})
      : arm_model_(arm), inputs_(settings, arm_model_, dialect, neighbours, false) {}

  /// Whether the message was accepted; then `value` is its value.
  bool receive(const void* bytes, size_t size, double now_s, ArmState& value) {
    return receive_value(bytes, size, now_s, arm_, value);
  }
  bool receive(const void* bytes, size_t size, double now_s, Target& value) {
    return receive_value(bytes, size, now_s, target_, value);
  }
  bool receive_joint_target(const void* bytes, size_t size, double now_s, Target& value) {
    if (!inputs_.receive_joint_target(Packet{static_cast<const uint8_t*>(bytes), size}, now_s, target_)) return false;
    value = target_.message;
    return true;
  }
  bool receive(const void* bytes, size_t size, double now_s, OtherJoints& value) {
    return receive_value(bytes, size, now_s, other_joints_, value);
  }
  bool receive(const void* bytes, size_t size, double now_s, Control& value) {
    return receive_value(bytes, size, now_s, control_, value);
  }
  bool receive(const void* bytes, size_t size, double now_s, Attachments& value) {
    return receive_value(bytes, size, now_s, attachments_, value);
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

  static Arm arm_with(int joints) {
    Arm arm;
    arm.joints = joints;
    return arm;
  }

  const Arm arm_model_;
  NetworkInputs inputs_;
  Received<ArmState> arm_;
  Received<Target> target_;
  Received<OtherJoints> other_joints_;
  Received<Control> control_;
  Received<Attachments> attachments_;
  std::unique_ptr<Received<ObstacleSet>> obstacles_ = std::make_unique<Received<ObstacleSet>>();
};

}  // namespace sidestep::test
