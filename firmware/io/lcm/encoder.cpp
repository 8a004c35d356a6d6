#include "firmware/io/lcm/encoder.h"

#include <algorithm>
#include <array>
#include <drake/lcmt_iiwa_command.hpp>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <sidestep/loop_timing_t.hpp>
#include <type_traits>
#include <vector>

#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr size_t kLargest_bytes = 1024;
constexpr size_t kLongestText = 200;

void copy(const Vector3& from, double* to) {
  Eigen::Map<Vector3>(to, 3) = from;
}

void copy(const JointVector& from, std::vector<double>& to) {
  to.assign(from.data(), from.data() + from.size());
}

/// Where the tool will be along the guide, at even times.
void encode_guide_path(const Arm& arm, const Report& report, controller_status_t& message) {
  constexpr int kPoints = std::extent_v<decltype(message.guide_tool)>;
  std::fill_n(&message.guide_tool[0][0], 3 * kPoints, 0.0);
  if (!report.guide) return;
  for (int i = 0; i < kPoints; ++i) {
    const double ahead_s = report.guide_horizon_s * i / (kPoints - 1);
    const double at_s = report.guide->end_s() - report.guide_horizon_s + ahead_s;
    copy(forward_kinematics(arm, point_of(*report.guide, at_s).position_rad).tool_position, message.guide_tool[i]);
  }
}

durations_t summary(const Histogram& histogram) {
  durations_t durations;
  durations.p50 = histogram.quantile_s(0.5);
  durations.p99 = histogram.quantile_s(0.99);
  durations.p999 = histogram.quantile_s(0.999);
  durations.worst = histogram.worst_s();
  return durations;
}

}  // namespace

struct Encoder::Messages {
  std::vector<std::string> shape_links;
  Dialect dialect;
  joint_command_t command;
  drake::lcmt_iiwa_command iiwa_command;
  controller_status_t status;
  loop_timing_t timing;
  std::array<uint8_t, kLargest_bytes> bytes;

  template <typename Message>
  Packet packet(const Message& message) {
    const int size = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    return {bytes.data(), size > 0 ? static_cast<size_t>(size) : 0};
  }
};

Encoder::Encoder(const Arm& arm, Dialect dialect) : arm_(arm), messages_(std::make_unique<Messages>()) {
  for (const LinkShape& shape : arm.shapes) messages_->shape_links.push_back(shape.link.substr(0, kLongestText));
  messages_->dialect = dialect;
  messages_->command.num_joints = messages_->iiwa_command.num_joints = arm.joints;
  for (auto* per_joint : {&messages_->command.joint_position, &messages_->command.joint_velocity,
                          &messages_->iiwa_command.joint_position})
    per_joint->resize(static_cast<size_t>(arm.joints));
  messages_->iiwa_command.num_torques = 0;  // it is moved by position alone
  messages_->status.nearest_link.reserve(kLongestText);
  messages_->status.message.reserve(2 * kLongestText);
}

Encoder::~Encoder() = default;

Packet Encoder::encode(const Command& command, int64_t utime, int64_t seq) {
  if (messages_->dialect == Dialect::kIiwa) {
    drake::lcmt_iiwa_command& message = messages_->iiwa_command;
    message.utime = utime;
    copy(command.position_rad, message.joint_position);
    return messages_->packet(message);
  }
  joint_command_t& message = messages_->command;
  message.utime = utime;
  message.seq = seq;
  copy(command.position_rad, message.joint_position);
  copy(command.velocity_radps, message.joint_velocity);
  return messages_->packet(message);
}

Packet Encoder::encode(const Report& report, const CycleRecord& record) {
  controller_status_t& message = messages_->status;
  message.utime = record.utime;
  message.seq = record.seq;
  message.mode = static_cast<int8_t>(report.mode);
  message.fault = static_cast<int32_t>(report.fault);
  message.limiting = report.limiting;
  copy(report.tool_position_m, message.tool_position);
  copy(report.tool_velocity_mps, message.tool_velocity);
  message.target_distance = report.target_distance_m;
  message.clearance = report.clearance_m;
  message.nearest_obstacle = report.nearest_obstacle;
  if (report.nearest_shape >= 0)
    message.nearest_link = messages_->shape_links[static_cast<size_t>(report.nearest_shape)];
  else
    message.nearest_link.clear();
  message.beta = report.beta;
  message.damping = report.damping;
  message.shield_correction = report.shield_correction_radps;
  message.cycle_time = record.cycle_time_s;
  message.wake_latency = record.wake_latency_s;
  message.skipped_cycles = record.skipped_cycles;
  message.rejected_messages = record.rejected_messages;
  message.message = report.message;
  message.foresight = static_cast<int8_t>(report.foresight_status);
  message.guide_horizon = report.guide_horizon_s;
  encode_guide_path(arm_, report, message);
  if (*record.rejected_reason) message.message.append("; rejected: ").append(record.rejected_reason);
  return messages_->packet(message);
}

Packet Encoder::encode(const Timing& timing, int64_t utime) {
  loop_timing_t& message = messages_->timing;
  message.utime = utime;
  message.period = timing.period_s;
  message.realtime = timing.realtime;
  message.cycles = timing.cycles;
  message.skipped_cycles = timing.skipped_cycles;
  message.wake_latency = summary(timing.wake_latency);
  message.cycle = summary(timing.cycle);
  message.monitor = summary(timing.stages[0]);
  message.clearance = summary(timing.stages[1]);
  message.law = summary(timing.stages[2]);
  message.shield = summary(timing.stages[3]);
  message.gate = summary(timing.stages[4]);
  return messages_->packet(message);
}

}  // namespace sidestep
