#include <sidestep/joint_command_t.hpp>
#include <sidestep/joint_state_t.hpp>

#include "firmware/io/lcm/arm_codec.h"
#include "firmware/io/lcm/dialect.h"

namespace sidestep {
namespace {

class SidestepCodec : public ArmCodec {
 public:
  explicit SidestepCodec(int joints) : joints_(joints) {
    command_.num_joints = joints;
    command_.joint_position.reserve(static_cast<size_t>(joints));
    command_.joint_velocity.reserve(static_cast<size_t>(joints));
  }

  const char* decode(Packet packet, ArmState& arm) override {
    if (const char* wrong = decode_arm_state(packet, joints_, 2, state_)) return wrong;
    arm = {state_.utime, joints_of(state_.joint_position), joints_of(state_.joint_velocity), {}};
    return nullptr;
  }

  Packet encode(const Command& command, int64_t utime, int64_t seq) override {
    command_.utime = utime;
    command_.seq = seq;
    copy_joints(command.position_rad, command_.joint_position);
    copy_joints(command.velocity_radps, command_.joint_velocity);
    return buffer_.encode(command_);
  }

 private:
  int joints_;
  joint_state_t state_;
  joint_command_t command_;
  PacketBuffer buffer_;
};

std::unique_ptr<ArmCodec> make_codec(int joints) {
  return std::make_unique<SidestepCodec>(joints);
}

}  // namespace

const Dialect kSidestepDialect{"sidestep", "ARM_STATE", "ARM_COMMAND", 0, 0.0, nullptr, make_codec};

}  // namespace sidestep
