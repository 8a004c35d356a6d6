#include "firmware/io/lcm/arm_reader.h"

#include <drake/lcmt_iiwa_status.hpp>
#include <sidestep/joint_state_t.hpp>

#include "firmware/io/lcm/message_bytes.h"

namespace sidestep {
namespace {

// The drives follow closer than this; a commanded position farther away was never held by anything.
constexpr double kLargestSag_rad = 0.05;

JointVector joints_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Decodes a message that is `per_joint` numbers for each of its joints behind the header; null when it could.
template <typename Message>
const char* decode(const void* bytes, size_t size, int joints, size_t per_joint, Message& message) {
  if (!has_fingerprint<Message>(bytes, size)) return "arm state of another type";
  if (count_of(bytes, size) != joints) return "arm state with a wrong number of joints";
  if (size != kHeaderBytes + kCountBytes + 8 * per_joint * static_cast<size_t>(joints))
    return "arm state of wrong size";
  return message.decode(bytes, 0, static_cast<int>(size)) < 0 ? "arm state that does not decode" : nullptr;
}

void take(const joint_state_t& message, ArmState& value) {
  value = {message.utime, joints_of(message.joint_position), joints_of(message.joint_velocity), {}};
}

/// Only what is used is looked at: drake-iiwa-driver itself sends NaN in the others.
void take(const drake::lcmt_iiwa_status& message, ArmState& value) {
  value = {message.utime, joints_of(message.joint_position_measured), joints_of(message.joint_velocity_estimated), {}};
  const JointVector held_rad = joints_of(message.joint_position_commanded);
  const bool held = held_rad.allFinite() && (held_rad - value.position_rad).cwiseAbs().maxCoeff() <= kLargestSag_rad;
  if (held) value.held_rad = held_rad;
}

}  // namespace

/// Decoded messages whose vectors keep their capacity from one message to the next.
struct ArmReader::Scratch {
  joint_state_t state;
  drake::lcmt_iiwa_status status;
};

ArmReader::ArmReader(Dialect dialect, int joints)
    : dialect_(dialect), joints_(joints), scratch_(std::make_unique<Scratch>()) {}

ArmReader::~ArmReader() = default;

const char* ArmReader::read(const void* bytes, size_t size, ArmState& value) {
  const auto read_as = [&](auto& message, size_t per_joint) {
    const char* wrong = decode(bytes, size, joints_, per_joint, message);
    if (!wrong) take(message, value);
    return wrong;
  };
  return dialect_ == Dialect::kIiwa ? read_as(scratch_->status, 7) : read_as(scratch_->state, 2);
}

}  // namespace sidestep
