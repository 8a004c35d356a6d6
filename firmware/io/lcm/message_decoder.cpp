#include "firmware/io/lcm/message_decoder.h"

#include <algorithm>
#include <cstring>
#include <sidestep/attachments_t.hpp>
#include <sidestep/control_t.hpp>
#include <sidestep/joint_target_t.hpp>
#include <sidestep/named_joints_t.hpp>
#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>

#include "firmware/control/validation.h"
#include "firmware/io/lcm/message_bytes.h"

namespace sidestep {
namespace {

static_assert(static_cast<int8_t>(Shape::kSphere) == obstacle_t::SPHERE);
static_assert(static_cast<int8_t>(Shape::kCapsule) == obstacle_t::CAPSULE);
static_assert(static_cast<int8_t>(Shape::kBox) == obstacle_t::BOX);
static_assert(static_cast<int8_t>(Shape::kCylinder) == obstacle_t::CYLINDER);
static_assert(static_cast<int8_t>(ControlCommand::kPause) == control_t::PAUSE);
static_assert(static_cast<int8_t>(ControlCommand::kResume) == control_t::RESUME);
static_assert(static_cast<int8_t>(ControlCommand::kStop) == control_t::STOP);
static_assert(static_cast<int8_t>(Kind::kThing) == obstacle_t::THING);
static_assert(static_cast<int8_t>(Kind::kPerson) == obstacle_t::PERSON);

Vector3 vector(const double* xyz) {
  return Vector3(xyz[0], xyz[1], xyz[2]);
}
/// Reads the names of a named_joints_t, one after the other: a count of bytes with the final zero, then the bytes.
class NameReader {
 public:
  NameReader(const uint8_t* begin, const uint8_t* end) : at_(begin), end_(end) {}

  /// The next name, valid as long as the bytes; null where the bytes do not hold one.
  const char* next() {
    if (end_ - at_ < 4) return nullptr;
    const auto length = static_cast<int32_t>(big_endian(at_, 4));
    at_ += 4;
    if (length < 1 || length > end_ - at_ || at_[length - 1] != 0) return nullptr;
    const auto* name = reinterpret_cast<const char*>(at_);
    at_ += length;
    return std::memchr(name, 0, static_cast<size_t>(length)) == at_ - 1 ? name : nullptr;
  }
  const uint8_t* at() const { return at_; }

 private:
  const uint8_t* at_;
  const uint8_t* end_;
};

/// Whether these are obstacles of version 0.1, whose obstacle_t had no field `kind`.
bool is_of_layout_0_1(Packet packet) {
  constexpr uint64_t kFingerprint_0_1 = 0x71eeab81304e513c;
  return packet.size >= kFingerprintBytes && big_endian(packet.bytes, kFingerprintBytes) == kFingerprint_0_1;
}

double double_at(const uint8_t* bytes) {
  const uint64_t bits = big_endian(bytes, 8);
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

Quaternion quaternion(const double* wxyz) {
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
}

Obstacle obstacle_of(const obstacle_t& from) {
  Obstacle to = reported_obstacle(static_cast<Shape>(from.shape), vector(from.position), quaternion(from.quaternion),
                                  vector(from.size));
  to.id = from.id;
  to.kind = static_cast<Kind>(from.kind);
  to.velocity_mps = vector(from.velocity);
  to.angular_velocity_radps = vector(from.angular_velocity);
  return to;
}

}  // namespace

bool is_joint_target(Packet packet) {
  return has_fingerprint<joint_target_t>(packet);
}

/// Decoded messages; their vectors keep their capacity from one message to the next.
struct MessageDecoder::Scratch {
  const Arm& model;
  std::unique_ptr<ArmCodec> arm;
  target_t target;
  joint_target_t joint_target;
  obstacles_t obstacles;
  attachments_t attachments;
};

MessageDecoder::MessageDecoder(const Dialect& dialect, const Arm& arm)
    : scratch_(new Scratch{arm, dialect.make_codec(arm.joints), {}, {}, {}, {}}) {
  scratch_->obstacles.obstacles.reserve(kMaxObstacles);
  scratch_->attachments.shapes.reserve(kMaxHeldShapes);
  scratch_->attachments.allowed.reserve(kMaxAllowed);
}

MessageDecoder::~MessageDecoder() = default;

const char* MessageDecoder::decode(Packet packet, ArmState& arm) {
  return scratch_->arm->decode(packet, arm);
}

const char* MessageDecoder::decode(Packet packet, Target& target) {
  if (!has_fingerprint<target_t>(packet)) return "target of another type";
  target_t& message = scratch_->target;
  if (packet.size != kFingerprintBytes + static_cast<size_t>(message._getEncodedSizeNoHash()))
    return "target of wrong size";
  if (message.decode(packet.bytes, 0, static_cast<int>(packet.size)) < 0) return "target that does not decode";
  target.utime = message.utime;
  target.position_m = vector(message.position);
  target.velocity_mps = vector(message.velocity);
  target.tracks_orientation = message.tracks_orientation != 0;
  target.orientation = quaternion(message.quaternion);
  target.angular_velocity_radps = vector(message.angular_velocity);
  target.posture_rad.resize(0);
  return nullptr;
}

const char* MessageDecoder::decode_joint_target(Packet packet, Target& target) {
  if (!is_joint_target(packet)) return "joint target of another type";
  if (count_of(packet) != scratch_->model.joints) return "joint target with another number of joints than the arm has";
  joint_target_t& message = scratch_->joint_target;
  if (!decode_counted(packet, sizeof(double), message)) return "joint target of wrong size";
  target = Target{};
  target.utime = message.utime;
  target.posture_rad = Eigen::Map<const JointVector>(message.joint_position.data(), message.num_joints);
  return nullptr;
}

const char* MessageDecoder::decode(Packet packet, Control& control) {
  if (!has_fingerprint<control_t>(packet)) return "control of another type";
  control_t message;
  if (packet.size != kFingerprintBytes + static_cast<size_t>(message._getEncodedSizeNoHash()))
    return "control of wrong size";
  if (message.decode(packet.bytes, 0, static_cast<int>(packet.size)) < 0) return "control that does not decode";
  control = {message.utime, static_cast<ControlCommand>(message.command), message.speed_scale};
  return nullptr;
}

/// LCM's decoder would allocate for every name, so the bytes are read here.
const char* MessageDecoder::decode(Packet packet, OtherJoints& joints) {
  if (!has_fingerprint<named_joints_t>(packet)) return "other joints of another type";
  const int64_t count = count_of(packet);
  if (count < 0 || count > kMaxNamedJoints) return "other joints with an impossible count";
  const uint8_t* const end = packet.bytes + packet.size;
  const uint8_t* const names = packet.bytes + kHeaderBytes + kCountBytes;
  NameReader skipping(names, end);
  for (int64_t i = 0; i < count; ++i)
    if (!skipping.next()) return "other joints with a damaged name";
  if (end - skipping.at() != 8 * count) return "other joints of wrong size";

  joints.utime = utime_of(packet);
  joints.named.fill(false);
  NameReader reader(names, end);
  const auto& known = scratch_->model.other_joints;
  bool any_named = false;
  for (int64_t i = 0; i < count; ++i) {
    const char* name = reader.next();
    const auto found = std::find_if(known.begin(), known.end(), [&](const OtherJoint& j) { return j.name == name; });
    if (found == known.end()) continue;
    const auto j = static_cast<size_t>(found - known.begin());
    joints.named[j] = any_named = true;
    joints.position[j] = double_at(skipping.at() + 8 * i);
  }
  return any_named ? nullptr : "other joints, none of which moves a link outside the chain";
}

const char* MessageDecoder::decode(Packet packet, ObstacleSet& obstacles, int64_t& utime) {
  if (!has_fingerprint<obstacles_t>(packet))
    return is_of_layout_0_1(packet) ? "obstacles of the layout of 0.1, without obstacle_t.kind"
                                    : "obstacles of another type";
  const int64_t count = count_of(packet);
  if (count < 0 || count > kMaxObstacles) return "obstacles with an impossible count";
  obstacles_t& message = scratch_->obstacles;
  if (!decode_counted(packet, kObstacleBytes, message)) return "obstacles of wrong size";
  utime = message.utime;
  obstacles.count = static_cast<int>(count);
  obstacles.remembered = 0;
  for (int i = 0; i < obstacles.count; ++i) {
    const auto k = static_cast<size_t>(i);
    obstacles.obstacles[k] = obstacle_of(message.obstacles[k]);
  }
  return nullptr;
}

const char* MessageDecoder::decode(Packet packet, Attachments& attachments) {
  if (!has_fingerprint<attachments_t>(packet)) return "attachments of another type";
  const int64_t shapes = count_of(packet);
  if (shapes < 0 || shapes > kMaxHeldShapes) return "attachments with an impossible count of shapes";
  const size_t before_allowed = kHeaderBytes + kCountBytes + static_cast<size_t>(shapes) * kObstacleBytes;
  if (packet.size < before_allowed + kCountBytes) return "attachments of wrong size";
  const auto allowed = static_cast<int32_t>(big_endian(packet.bytes + before_allowed, kCountBytes));
  if (allowed < 0 || allowed > kMaxAllowed) return "attachments with an impossible count of allowed obstacles";
  if (packet.size != before_allowed + kCountBytes + static_cast<size_t>(allowed) * sizeof(int32_t))
    return "attachments of wrong size";
  attachments_t& message = scratch_->attachments;
  if (message.decode(packet.bytes, 0, static_cast<int>(packet.size)) < 0) return "attachments that do not decode";
  attachments.utime = message.utime;
  attachments.shapes.clear();
  attachments.allowed.clear();
  attachments.held.clear();
  // The generated decoder leaves a list of no elements as it was.
  for (size_t i = 0; i < static_cast<size_t>(shapes); ++i) attachments.shapes.add(obstacle_of(message.shapes[i]));
  for (size_t i = 0; i < static_cast<size_t>(allowed); ++i) attachments.allowed.add(message.allowed[i]);
  return nullptr;
}

}  // namespace sidestep
