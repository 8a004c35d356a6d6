#include <drake/lcmt_iiwa_command.hpp>
#include <drake/lcmt_iiwa_status.hpp>

#include "firmware/io/lcm/arm_codec.h"
#include "firmware/io/lcm/dialect.h"

namespace sidestep {
namespace {

constexpr int kJoints = 7;
constexpr double kStartGuard_s = 0.25;    // drake-iiwa-driver fails on a command within this time of its first status
constexpr double kLargestSag_rad = 0.05;  // the drives follow closer; a command farther away was never executed

class IiwaCodec : public ArmCodec {
 public:
  IiwaCodec() {
    command_.num_joints = kJoints;
    command_.joint_position.reserve(kJoints);
    command_.num_torques = 0;  // position control
  }

  /// Only the fields in use are read: drake-iiwa-driver sends NaN in the others.
  const char* decode(Packet packet, ArmState& arm) override {
    if (const char* wrong = decode_arm_state(packet, kJoints, 7, status_)) return wrong;
    arm = {status_.utime, joints_of(status_.joint_position_measured), joints_of(status_.joint_velocity_estimated), {}};
    const JointVector held_rad = joints_of(status_.joint_position_commanded);
    const bool is_held = held_rad.allFinite() && (held_rad - arm.position_rad).cwiseAbs().maxCoeff() <= kLargestSag_rad;
    if (is_held) arm.held_rad = held_rad;
    return nullptr;
  }

  Packet encode(const Command& command, int64_t utime, int64_t) override {
    command_.utime = utime;
    copy_joints(command.position_rad, command_.joint_position);
    return buffer_.encode(command_);
  }

 private:
  drake::lcmt_iiwa_status status_;
  drake::lcmt_iiwa_command command_;
  PacketBuffer buffer_;
};

std::unique_ptr<ArmCodec> make_codec(int) {
  return std::make_unique<IiwaCodec>();
}

}  // namespace

const Dialect kIiwaDialect{"iiwa",    "IIWA_STATUS", "IIWA_COMMAND",
                           kJoints,   kStartGuard_s, "dialect iiwa, whose driver may not be answered at once",
                           make_codec};

}  // namespace sidestep
