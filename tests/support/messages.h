#pragma once

#include <cstdint>
#include <cstring>
#include <sidestep/joint_state_t.hpp>
#include <sidestep/joint_target_t.hpp>
#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>
#include <vector>

#include "firmware/model/types.h"

namespace sidestep::test {

using Bytes = std::vector<uint8_t>;

/// The encoded bytes of a message.
template <typename Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

inline joint_state_t arm_state_message(int64_t utime, const JointVector& q_rad, const JointVector& qd_radps) {
  joint_state_t message;
  message.utime = utime;
  message.num_joints = static_cast<int32_t>(q_rad.size());
  message.joint_position.assign(q_rad.data(), q_rad.data() + q_rad.size());
  message.joint_velocity.assign(qd_radps.data(), qd_radps.data() + qd_radps.size());
  return message;
}

inline void copy(const Vector3& from, double* to) {
  std::memcpy(to, from.data(), 3 * sizeof(double));
}

/// A position-only target.
inline target_t target_message(int64_t utime, const Vector3& position_m, const Vector3& velocity_mps) {
  target_t message{};
  message.utime = utime;
  copy(position_m, message.position);
  copy(velocity_mps, message.velocity);
  message.quaternion[0] = 1.0;
  return message;
}

inline joint_target_t joint_target_message(int64_t utime, const JointVector& q_rad) {
  joint_target_t message;
  message.utime = utime;
  message.num_joints = static_cast<int32_t>(q_rad.size());
  message.joint_position.assign(q_rad.data(), q_rad.data() + q_rad.size());
  return message;
}

inline obstacle_t sphere(int32_t id, const Vector3& position_m, double radius_m, const Vector3& velocity_mps) {
  obstacle_t message{};
  message.id = id;
  message.shape = obstacle_t::SPHERE;
  copy(position_m, message.position);
  message.quaternion[0] = 1.0;
  message.size[0] = radius_m;
  copy(velocity_mps, message.velocity);
  return message;
}

inline obstacles_t obstacles_message(int64_t utime, const std::vector<obstacle_t>& obstacles) {
  obstacles_t message;
  message.utime = utime;
  message.num_obstacles = static_cast<int32_t>(obstacles.size());
  message.obstacles = obstacles;
  return message;
}

}  // namespace sidestep::test
