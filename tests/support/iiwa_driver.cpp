#include "tests/support/iiwa_driver.h"

#include <algorithm>

#include "tests/support/check.h"

namespace sidestep::test {
namespace {

constexpr std::chrono::milliseconds kPeriod{5}, kGuard{250}, kEndOfStream{100};
constexpr int64_t kStatusesWithoutTime = 200;
constexpr double kCommandPeriod_s = 0.01;
constexpr double kSag_rad = 0.01;

std::vector<double> to_list(const JointVector& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

}  // namespace

drake::lcmt_iiwa_status iiwa_status(int64_t utime, const JointVector& measured_rad, const JointVector& velocity_radps,
                                    const JointVector& commanded_rad) {
  const auto joints = static_cast<size_t>(measured_rad.size());
  drake::lcmt_iiwa_status status;
  status.utime = utime;
  status.num_joints = static_cast<int32_t>(joints);
  status.joint_position_measured = to_list(measured_rad);
  status.joint_velocity_estimated = to_list(velocity_radps);
  status.joint_position_commanded = to_list(commanded_rad);
  status.joint_position_ipo.assign(joints, std::nan(""));
  status.joint_torque_measured = status.joint_torque_commanded = status.joint_torque_external =
      std::vector<double>(joints);
  return status;
}

IiwaDriver::IiwaDriver(const JointLimits& limits, const JointVector& start_rad, const Vector3& the_target_m)
    : target_m(the_target_m),
      commands(limits, kCommandPeriod_s),
      lcm_(private_lcm_url()),
      held_rad_(start_rad),
      velocity_radps_(JointVector::Zero(start_rad.size())),
      next_(Clock::now()),
      started_(next_) {
  lcm_.subscribe("IIWA_COMMAND", &IiwaDriver::on_command, this)->setQueueCapacity(1000);
}

void IiwaDriver::on_command(const lcm::ReceiveBuffer*, const std::string&, const drake::lcmt_iiwa_command* message) {
  if (off_ || !stop_reason.empty()) return;
  const Clock::time_point now = Clock::now();
  if (statuses_sent_ == 0 || now - started_ < kGuard) stop_reason = "a command within the guard time";
  if (message->num_joints != held_rad_.size()) stop_reason = "a command for another number of joints";
  if (message->num_torques != 0) stop_reason = "torques in position mode";
  if (!stop_reason.empty()) return;
  // A new stream starts at the held position, at rest.
  if (now - commanded_ > kEndOfStream) commands.begin(held_rad_, JointVector::Zero(held_rad_.size()));
  commanded_ = now;
  const JointVector last_rad = held_rad_;
  held_rad_ = Eigen::Map<const Eigen::VectorXd>(message->joint_position.data(), held_rad_.size());
  velocity_radps_ = (held_rad_ - last_rad) / kCommandPeriod_s;
  commands.feed(held_rad_, velocity_radps_);
}

void IiwaDriver::send_status() {
  const int64_t now = std::chrono::duration_cast<std::chrono::microseconds>(next_.time_since_epoch()).count();
  if (statuses_sent_ == 0) started_ = Clock::now();
  if (Clock::now() - commanded_ > kEndOfStream) velocity_radps_.setZero();
  const JointVector measured_rad = held_rad_ - JointVector::Constant(held_rad_.size(), kSag_rad);
  const int64_t utime = statuses_sent_++ < kStatusesWithoutTime ? -1 : now;
  peer.send("IIWA_STATUS", iiwa_status(utime, measured_rad, velocity_radps_, held_rad_));
}

void IiwaDriver::tick() {
  const int64_t utime = std::chrono::duration_cast<std::chrono::microseconds>(next_.time_since_epoch()).count();
  peer.send("TARGET", target_message(utime, target_m, Vector3::Zero()));
  peer.send("OBSTACLES", obstacles_message(utime, {sphere(5, Vector3(-0.6, 0.6, 0.6), 0.05, Vector3::Zero())}));
  if (!off_ && stop_reason.empty()) send_status();
  next_ = std::max(next_ + kPeriod, Clock::now() - kPeriod);
  peer.listen(std::chrono::duration<double>(next_ - Clock::now()).count());
  while (lcm_.handleTimeout(0) > 0) {
  }
}

void IiwaDriver::run(double duration_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(duration_s);
  while (Clock::now() < end) tick();
}

bool IiwaDriver::run_until(int8_t mode, double limit_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(limit_s);
  while (peer.statuses.empty() || peer.statuses.back().mode != mode) {
    if (Clock::now() > end) return false;
    tick();
  }
  return true;
}

void IiwaDriver::restart(double silence_s) {
  off_ = true;
  run(silence_s);
  off_ = false;
  statuses_sent_ = 0;
}

}  // namespace sidestep::test
