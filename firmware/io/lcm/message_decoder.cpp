#include "firmware/io/lcm/message_decoder.h"

#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>

#include "firmware/control/validation.h"
#include "firmware/io/lcm/message_bytes.h"

namespace sidestep {
namespace {

static_assert(static_cast<int8_t>(Shape::kSphere) == obstacle_t::SPHERE);
static_assert(static_cast<int8_t>(Shape::kCapsule) == obstacle_t::CAPSULE);
static_assert(static_cast<int8_t>(Shape::kBox) == obstacle_t::BOX);

Vector3 vector(const double* xyz) {
  return Vector3(xyz[0], xyz[1], xyz[2]);
}
Quaternion quaternion(const double* wxyz) {
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
}

}  // namespace

/// Decoded messages; their vectors keep their capacity from one message to the next.
struct MessageDecoder::Scratch {
  std::unique_ptr<ArmCodec> arm;
  target_t target;
  obstacles_t obstacles;
};

MessageDecoder::MessageDecoder(const Dialect& dialect, int joints)
    : scratch_(new Scratch{dialect.make_codec(joints), {}, {}}) {
  scratch_->obstacles.obstacles.reserve(kMaxObstacles);
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
  return nullptr;
}

const char* MessageDecoder::decode(Packet packet, ObstacleSet& obstacles, int64_t& utime) {
  if (!has_fingerprint<obstacles_t>(packet)) return "obstacles of another type";
  const int64_t count = count_of(packet);
  if (count < 0 || count > kMaxObstacles) return "obstacles with an impossible count";
  obstacles_t& message = scratch_->obstacles;
  if (!decode_counted(packet, kObstacleBytes, message)) return "obstacles of wrong size";
  utime = message.utime;
  obstacles.count = static_cast<int>(count);
  obstacles.remembered = 0;
  for (int i = 0; i < obstacles.count; ++i) {
    const obstacle_t& from = message.obstacles[static_cast<size_t>(i)];
    Obstacle& to = obstacles.obstacles[static_cast<size_t>(i)];
    to = reported_obstacle(static_cast<Shape>(from.shape), vector(from.position), quaternion(from.quaternion),
                           vector(from.size));
    to.id = from.id;
    to.velocity_mps = vector(from.velocity);
    to.angular_velocity_radps = vector(from.angular_velocity);
  }
  return nullptr;
}

}  // namespace sidestep
