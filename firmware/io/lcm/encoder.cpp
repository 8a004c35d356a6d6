#include "firmware/io/lcm/encoder.h"

#include <algorithm>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/loop_timing_t.hpp>
#include <type_traits>
#include <vector>

#include "firmware/io/lcm/arm_codec.h"
#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr size_t kLongestText = 200;
constexpr const char* kHeldObject = "held object";

void copy(const Vector3& from, double* to) {
  Eigen::Map<Vector3>(to, 3) = from;
}

/// The tool positions along the guide at even times, from now to its end; zeros without a guide.
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
  std::unique_ptr<ArmCodec> arm;
  std::vector<std::string> shape_links;
  controller_status_t status;
  loop_timing_t timing;
  PacketBuffer buffer;
};

Encoder::Encoder(const Arm& arm, const Dialect& dialect) : arm_(arm), messages_(std::make_unique<Messages>()) {
  messages_->arm = dialect.make_codec(arm.joints);
  for (const LinkShape& shape : arm.shapes) messages_->shape_links.push_back(shape.link.substr(0, kLongestText));
  messages_->status.nearest_link.reserve(kLongestText);
  for (std::string& link : messages_->status.self_links) link.reserve(kLongestText);
  messages_->status.message.reserve(2 * kLongestText);
}

Encoder::~Encoder() = default;

Packet Encoder::encode(const Command& command, int64_t utime, int64_t seq) {
  return messages_->arm->encode(command, utime, seq);
}

Packet Encoder::encode(const Report& report, const CycleRecord& record) {
  controller_status_t& message = messages_->status;
  const auto copy_link = [&](int shape, std::string& name) {
    const auto s = static_cast<size_t>(shape);
    if (shape < 0)
      name.clear();
    else if (s < messages_->shape_links.size())
      name = messages_->shape_links[s];
    else
      name = kHeldObject;
  };
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
  copy_link(report.nearest_shape, message.nearest_link);
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
  message.self_clearance = report.nearest_links.distance_m;
  copy_link(report.nearest_links.first, message.self_links[0]);
  copy_link(report.nearest_links.second, message.self_links[1]);
  message.speed_scale = report.speed_scale;
  if (*record.rejected_reason) message.message.append("; rejected: ").append(record.rejected_reason);
  return messages_->buffer.encode(message);
}

Packet Encoder::encode(const LoopTiming& timing, int64_t utime) {
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
  message.lost_datagrams = timing.reception.lost_datagrams;
  message.malformed_datagrams = timing.reception.malformed_datagrams;
  message.incomplete_messages = timing.reception.incomplete_messages;
  return messages_->buffer.encode(message);
}

}  // namespace sidestep
