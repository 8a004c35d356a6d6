#include "firmware/io/lcm/admission.h"

#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>

#include "firmware/control/reported.h"
#include "firmware/io/lcm/arm_reader.h"
#include "firmware/io/lcm/message_bytes.h"

namespace sidestep {
namespace {

constexpr size_t kObstacleBytes = 4 + 1 + 16 * 8;

Vector3 vector(const double* xyz) {
  return Vector3(xyz[0], xyz[1], xyz[2]);
}
Quaternion quaternion(const double* wxyz) {
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
}

}  // namespace

/// Decoded messages whose vectors keep their capacity from one message to the next.
struct Admission::Scratch {
  ArmReader arm;
  target_t target;
  obstacles_t obstacles;
  ObstacleMemory obstacle_memory;
};

Admission::Admission(int joints, const Settings& settings, bool arm_is_clock, Dialect dialect)
    : joints_(joints),
      timeouts_(settings.timeouts),
      arm_is_clock_(arm_is_clock),
      scratch_(new Scratch{{dialect, joints}, {}, {}, obstacle_memory_of(settings)}) {
  scratch_->obstacles.obstacles.reserve(kMaxObstacles);
}

Admission::~Admission() = default;

bool Admission::reject(const char* reason) {
  ++rejected_;
  reason_ = reason;
  return false;
}

bool Admission::admit(const void* bytes, size_t size, double now_s, ArmState& value) {
  if (const char* wrong = scratch_->arm.read(bytes, size, value)) return reject(wrong);
  if (!plausible(value, joints_)) return reject("arm state with impossible values");
  const double received_s = arm_is_clock_ ? static_cast<double>(value.utime) * 1e-6 : now_s;
  return arm_order_.accept(value.utime, received_s, timeouts_.arm_state_lost_s);
}

bool Admission::admit(const void* bytes, size_t size, double now_s, Target& value) {
  if (!has_fingerprint<target_t>(bytes, size)) return reject("target of another type");
  target_t& message = scratch_->target;
  if (size != 8 + static_cast<size_t>(message._getEncodedSizeNoHash())) return reject("target of wrong size");
  if (message.decode(bytes, 0, static_cast<int>(size)) < 0) return reject("target that does not decode");
  value.utime = message.utime;
  value.position_m = vector(message.position);
  value.velocity_mps = vector(message.velocity);
  value.tracks_orientation = message.tracks_orientation != 0;
  value.orientation = quaternion(message.quaternion);
  value.angular_velocity_radps = vector(message.angular_velocity);
  if (!complete(value)) return reject("target with impossible values");
  return target_order_.accept(value.utime, now_s, timeouts_.target_s);
}

bool Admission::admit(const void* bytes, size_t size, double now_s, ObstacleSet& value) {
  if (!has_fingerprint<obstacles_t>(bytes, size)) return reject("obstacles of another type");
  const int64_t count = count_of(bytes, size);
  if (count < 0 || count > kMaxObstacles) return reject("obstacles with an impossible count");
  if (size != kHeaderBytes + kCountBytes + kObstacleBytes * static_cast<size_t>(count))
    return reject("obstacles of wrong size");
  obstacles_t& message = scratch_->obstacles;
  if (message.decode(bytes, 0, static_cast<int>(size)) < 0) return reject("obstacles that do not decode");
  value.count = static_cast<int>(count);
  for (int i = 0; i < value.count; ++i) {
    const obstacle_t& from = message.obstacles[static_cast<size_t>(i)];
    Obstacle& to = value.obstacles[static_cast<size_t>(i)];
    const auto shape = static_cast<Shape>(from.shape);
    to = reported_obstacle(shape, vector(from.position), quaternion(from.quaternion), vector(from.size));
    to.id = from.id;
    to.velocity_mps = vector(from.velocity);
    to.angular_velocity_radps = vector(from.angular_velocity);
    if (!complete(shape, to)) return reject("obstacles with impossible values");
  }
  if (!obstacles_order_.accept(message.utime, now_s, timeouts_.obstacles_s)) {
    if (obstacles_order_.is_late(message.utime))
      scratch_->obstacle_memory.add_late_set(value, timeouts_.obstacles_s, now_s);
    return false;
  }
  scratch_->obstacle_memory.complete(value, obstacles_order_.elapsed_s(), now_s);
  return true;
}

}  // namespace sidestep
