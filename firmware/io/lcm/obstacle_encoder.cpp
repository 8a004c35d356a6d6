#include "firmware/io/lcm/obstacle_encoder.h"

#include <algorithm>
#include <sidestep/obstacles_t.hpp>
#include <vector>

#include "firmware/model/rotation.h"

namespace sidestep {
namespace {

void copy(const Vector3& from, double* to) {
  Eigen::Map<Vector3>(to, 3) = from;
}

void encode_shape(int8_t shape, const Quaternion& orientation, const Vector3& size_m, obstacle_t& message) {
  message.shape = shape;
  const double wxyz[] = {orientation.w(), orientation.x(), orientation.y(), orientation.z()};
  std::copy(wxyz, wxyz + 4, message.quaternion);
  copy(size_m, message.size);
}

void encode_shape(const Obstacle& obstacle, obstacle_t& message) {
  if (obstacle.shape == Shape::kBox) {
    const Box box = box_of(obstacle);
    return encode_shape(obstacle_t::BOX, Quaternion(box.axes), 2.0 * box.half_m, message);
  }
  const Capsule& capsule = obstacle.capsule;
  const Vector3 axis = capsule.end - capsule.start, size_m(capsule.radius_m, axis.norm(), 0.0);
  if (obstacle.shape == Shape::kCylinder)
    return encode_shape(obstacle_t::CYLINDER, rotation_from_z(axis), size_m, message);
  if (axis.isZero(0.0)) return encode_shape(obstacle_t::SPHERE, Quaternion::Identity(), size_m, message);
  encode_shape(obstacle_t::CAPSULE, rotation_from_z(axis), size_m, message);
}

obstacle_t to_message(const Obstacle& obstacle) {
  obstacle_t message;
  message.id = obstacle.id;
  message.kind = static_cast<int8_t>(obstacle.kind);
  encode_shape(obstacle, message);
  copy(obstacle.capsule.centre(), message.position);
  copy(obstacle.velocity_mps, message.velocity);
  copy(obstacle.angular_velocity_radps, message.angular_velocity);
  return message;
}

}  // namespace

struct ObstacleEncoder::Messages {
  size_t max;
  obstacles_t all;
  std::vector<uint8_t> bytes;
};

ObstacleEncoder::ObstacleEncoder(int max_obstacles)
    : messages_(new Messages{static_cast<size_t>(max_obstacles), {}, {}}) {
  obstacles_t& all = messages_->all;
  all.obstacles.resize(messages_->max);
  all.num_obstacles = max_obstacles;
  messages_->bytes.resize(static_cast<size_t>(all.getEncodedSize()));
}

ObstacleEncoder::~ObstacleEncoder() = default;

void ObstacleEncoder::begin(int64_t utime) {
  messages_->all.utime = utime;
  messages_->all.num_obstacles = 0;
}

void ObstacleEncoder::add(const Obstacle& obstacle) {
  const auto next = static_cast<size_t>(messages_->all.num_obstacles++);
  if (next < messages_->max) messages_->all.obstacles[next] = to_message(obstacle);
}

Packet ObstacleEncoder::finish() {
  std::vector<uint8_t>& bytes = messages_->bytes;
  if (static_cast<size_t>(messages_->all.num_obstacles) > messages_->max) return {};
  const int size = messages_->all.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return {bytes.data(), static_cast<size_t>(size)};
}

}  // namespace sidestep
