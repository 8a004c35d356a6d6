#include "firmware/io/obstacle_encoder.h"

#include <algorithm>
#include <sidestep/obstacles_t.hpp>
#include <vector>

namespace sidestep {
namespace {

void copy(const Vector3& from, double* to) {
  Eigen::Map<Vector3>(to, 3) = from;
}

obstacle_t to_message(const Obstacle& obstacle) {
  const Capsule& capsule = obstacle.capsule;
  const Vector3 axis = capsule.end - capsule.start;
  const bool round = axis.isZero(0.0);
  const Quaternion turn = round ? Quaternion::Identity() : Quaternion::FromTwoVectors(Vector3::UnitZ(), axis);
  obstacle_t message;
  message.id = obstacle.id;
  message.shape = round ? obstacle_t::SPHERE : obstacle_t::CAPSULE;
  copy(0.5 * (capsule.start + capsule.end), message.position);
  const double wxyz[] = {turn.w(), turn.x(), turn.y(), turn.z()};
  std::copy(wxyz, wxyz + 4, message.quaternion);
  copy({capsule.radius_m, axis.norm(), 0.0}, message.size);
  copy(obstacle.velocity_mps, message.velocity);
  copy(obstacle.angular_velocity_radps, message.angular_velocity);
  return message;
}

}  // namespace

struct ObstacleEncoder::Messages {
  size_t most;
  obstacles_t all;
  std::vector<uint8_t> bytes;
};

ObstacleEncoder::ObstacleEncoder(int most_obstacles)
    : messages_(new Messages{static_cast<size_t>(most_obstacles), {}, {}}) {
  obstacles_t& all = messages_->all;
  all.obstacles.resize(messages_->most);
  all.num_obstacles = most_obstacles;
  messages_->bytes.resize(static_cast<size_t>(all.getEncodedSize()));
}

ObstacleEncoder::~ObstacleEncoder() = default;

void ObstacleEncoder::begin(int64_t utime) {
  messages_->all.utime = utime;
  messages_->all.num_obstacles = 0;
}

void ObstacleEncoder::add(const Obstacle& obstacle) {
  const auto next = static_cast<size_t>(messages_->all.num_obstacles++);
  if (next < messages_->most) messages_->all.obstacles[next] = to_message(obstacle);
}

Packet ObstacleEncoder::finish() {
  std::vector<uint8_t>& bytes = messages_->bytes;
  if (static_cast<size_t>(messages_->all.num_obstacles) > messages_->most) return {};
  const int size = messages_->all.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return {bytes.data(), static_cast<size_t>(size)};
}

}  // namespace sidestep
