#include "tests/support/closed_loop.h"

#include <cmath>

#include "firmware/io/config/config.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"

namespace sidestep::test {

Model lwa3_model(const std::string& law) {
  return load_config("firmware/config/lwa3.yaml", {law, "", "", ""}).model;
}

ClosedLoop::ClosedLoop(const Model& the_model, const JointVector& start_rad)
    : model(the_model),
      commands(model.arm.limits, model.settings.period_s()),
      arm{0, start_rad, JointVector::Zero(start_rad.size())},
      obstacles(std::make_unique<ObstacleSet>()),
      others(model.arm.other_positions) {}

template <typename Message>
void ClosedLoop::Sent<Message>::send(const Message& now, double now_s) {
  if (!message) message = std::make_unique<Message>();
  *message = now;
  latest = {message.get(), now_s, latest.count + 1};
}

Inputs ClosedLoop::receive() {
  ++periods_;
  arm.utime = static_cast<int64_t>(std::llround(now_s() * 1e6)) + arm_clock_offset_us;
  if (sends_arm_state) sent_arm_.send(arm, now_s());
  if (sends_target) sent_target_.send(target, now_s());
  if (sends_obstacles) sent_obstacles_.send(*obstacles, now_s());
  if (sends_others) sent_others_.send(others, now_s());
  Inputs inputs{sent_arm_.latest, sent_target_.latest, sent_obstacles_.latest, skipped, stop};
  if (sends_control) sent_control_.send(control, now_s());
  inputs.control = sent_control_.latest;
  inputs.other_joints = sent_others_.latest;
  if (sends_attachments) sent_attachments_.send(attachments, now_s());
  inputs.attachments = sent_attachments_.latest;
  return inputs;
}

void ClosedLoop::follow(const Result& result) {
  const bool was_commanding = last.commanding;
  last = result;
  state = result.next;
  if (result.commanding) {
    if (!was_commanding) commands.begin(arm.position_rad, arm.velocity_radps);
    commands.feed(result.command.position_rad, result.command.velocity_radps);
    arm.velocity_radps = result.command.velocity_radps;
  } else {
    if (was_commanding) commands.end();
    arm.velocity_radps.setZero();
  }
  const double period_s = model.settings.period_s();
  arm.position_rad += arm.velocity_radps * period_s;
  target.position_m += target.velocity_mps * period_s;
  if (const Vector3 turn = target.angular_velocity_radps * period_s; turn.norm() > 0.0)
    target.orientation = Quaternion(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * target.orientation;
  for (int i = 0; i < obstacles->count; ++i) {
    Obstacle& obstacle = obstacles->obstacles[static_cast<size_t>(i)];
    obstacle = extrapolated(obstacle, period_s);
  }
}

void ClosedLoop::cycle() {
  const Inputs inputs = receive();
  follow(step(model, state, inputs, now_s()));
}

void ClosedLoop::run(double duration_s) {
  for (auto cycles = std::lround(duration_s / model.settings.period_s()); cycles > 0; --cycles) cycle();
}

bool ClosedLoop::run_until(Mode mode, double limit_s) {
  for (auto cycles = std::lround(limit_s / model.settings.period_s()); cycles > 0; --cycles) {
    cycle();
    if (last.report.mode == mode) return true;
  }
  return false;
}

void ClosedLoop::hold(const std::vector<Obstacle>& shapes_tool) {
  attachments.shapes.clear();
  for (const Obstacle& shape : shapes_tool) attachments.shapes.add(shape);
  place_held_shapes(model.arm, attachments);
  sends_attachments = true;
}

Obstacle& ClosedLoop::add_sphere(const Vector3& position_m, const Vector3& velocity_mps, double radius_m) {
  Obstacle& obstacle = obstacles->obstacles[static_cast<size_t>(obstacles->count)];
  obstacle = sphere_obstacle(position_m, radius_m);
  obstacle.id = obstacles->count++;
  obstacle.velocity_mps = velocity_mps;
  return obstacle;
}

ClosedLoop at_home(const std::string& law) {
  ClosedLoop loop(lwa3_model(law), home_rad());
  loop.target.position_m = Vector3(-0.328, 0.15, 0.8);
  return loop;
}

ClosedLoop tracking(const std::string& law) {
  ClosedLoop loop = at_home(law);
  loop.sends_target = true;
  check(loop.run_until(Mode::kTrack, 1.0), "%s", loop.last.report.message);
  loop.run(0.3);
  check(loop.mode() == Mode::kTrack && loop.speed_radps() > 0.05, "%s at %g rad/s", loop.last.report.message,
        loop.speed_radps());
  return loop;
}

void check_stream(const ClosedLoop& loop) {
  check(loop.commands.violation().empty(), "%s", loop.commands.violation().c_str());
}

}  // namespace sidestep::test
