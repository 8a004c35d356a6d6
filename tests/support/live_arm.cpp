#include "tests/support/live_arm.h"

#include <algorithm>

#include "firmware/base/realtime.h"
#include "firmware/control/command_stream.h"
#include "firmware/model/velocity_range.h"

namespace sidestep::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPeriod{10};
constexpr int kTicksToWait = 5;

JointVector to_joints(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

LiveArm::LiveArm(const JointLimits& limits, const JointVector& start_rad, double period_s)
    : commands(limits, period_s),
      limits_(limits),
      period_s_(period_s),
      position_rad_(start_rad),
      velocity_radps_(JointVector::Zero(start_rad.size())),
      next_(Clock::now()) {
  commands.begin(position_rad_, velocity_radps_);
}

/// Number of cycles between two commands in which the controller sent none on purpose.
int64_t LiveArm::silent_between(int64_t one, int64_t other) const {
  return std::count_if(peer.statuses.begin(), peer.statuses.end(), [&](const controller_status_t& status) {
    const bool silent = status.mode == controller_status_t::WAIT || status.mode == controller_status_t::FAULT;
    return silent && status.seq > one && status.seq < other;
  });
}

/// Brakes for one tick.
void LiveArm::stop_by_itself() {
  const double tick_s = std::chrono::duration<double>(kPeriod).count();
  velocity_radps_ = brake(limits_, velocity_radps_, tick_s);
  position_rad_ += velocity_radps_ * tick_s;
  stopped_by_itself_ = true;
}

/// Moves the arm to the last commanded position.
void LiveArm::follow() {
  if (followed_ < peer.commands.size()) ticks_without_command_ = 0;
  for (; followed_ < peer.commands.size(); ++followed_) {
    const joint_command_t& command = peer.commands[followed_];
    const int64_t before = followed_ > 0 ? peer.commands[followed_ - 1].seq : command.seq - 1;
    const int64_t lost = command.seq - before - 1 - silent_between(before, command.seq);
    const bool in_time =
        followed_ > 0 && command.seq == before + 1 &&
        command.utime - peer.commands[followed_ - 1].utime < kTicksToWait * kPeriod / std::chrono::microseconds(1);
    if (stopped_by_itself_ && !in_time) commands.begin(position_rad_, velocity_radps_);
    stopped_by_itself_ = false;
    position_rad_ = to_joints(command.joint_position);
    velocity_radps_ = to_joints(command.joint_velocity);
    lost_ += lost;
    if (lost > 0) commands.begin(position_rad_ - period_s_ * velocity_radps_, velocity_radps_);
    commands.feed(position_rad_, velocity_radps_);
  }
}

void LiveArm::tick() {
  const int64_t utime = static_cast<int64_t>(1e6 * monotonic_s()) + clock_offset_us;
  peer.drain();
  follow();
  if (ticks_without_command_++ >= kTicksToWait) stop_by_itself();
  if (sends_target) peer.send("TARGET", target_message(utime, target_m, Vector3::Zero()));
  if (sends_obstacles)
    peer.send("OBSTACLES", obstacles_message(utime, {sphere(5, Vector3(0.6, 0.6, 0.6), 0.05, Vector3::Zero())}));
  if (sends_arm_state) peer.send("ARM_STATE", arm_state_message(utime, position_rad_, velocity_radps_));
  next_ = std::max(next_ + kPeriod, Clock::now() - kPeriod);
  peer.listen(std::chrono::duration<double>(next_ - Clock::now()).count());
  follow();
}

void LiveArm::run(double duration_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(duration_s);
  while (Clock::now() < end) tick();
}

bool LiveArm::run_until(int8_t mode, double limit_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(limit_s);
  while (peer.statuses.empty() || status().mode != mode) {
    if (Clock::now() > end) return false;
    tick();
  }
  return true;
}

bool LiveArm::reports(const char* text) const {
  return status().message.find(text) != std::string::npos;
}

double LiveArm::speed_radps() const {
  return velocity_radps_.norm();
}

}  // namespace sidestep::test
