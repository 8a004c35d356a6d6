#pragma once

#include <memory>
#include <string>
#include <vector>

#include "firmware/control/cycle.h"
#include "tests/support/command_check.h"

namespace sidestep::test {

/// The LWA3's configuration with this law.
Model lwa3_model(const std::string& law);

/// An in-process closed loop of step(), an ideal arm, a target and obstacles with a simulated clock. Public members may
/// be changed between two cycles. Target and obstacles move whether or not they are sent.
class ClosedLoop {
 public:
  ClosedLoop(const Model& model, const JointVector& start_rad);

  Model model;
  State state;
  Result last;
  CommandCheck commands;  ///< checks every command that a real-time loop would publish

  ArmState arm;  ///< present state; follows the commands, rests without them
  Target target;
  std::unique_ptr<ObstacleSet> obstacles;
  OtherJoints others;  ///< of the joints outside the chain; at first as configured
  bool sends_arm_state = true, sends_target = false, sends_obstacles = true,
       sends_others = false;  ///< which messages are sent
  Control control;            ///< of the operator
  bool sends_control = false;
  Attachments attachments;  ///< what the tool holds; its shapes are set through hold()
  bool sends_attachments = false;
  bool stop = false;
  int skipped = 0;
  int64_t arm_clock_offset_us = 0;

  void cycle();
  void run(double duration_s);
  /// Runs until the mode is reached, for at most limit_s. Returns whether it was.
  bool run_until(Mode mode, double limit_s);

  /// The parts of cycle() before and after step(), for tests that call step() themselves.
  Inputs receive();
  void follow(const Result& result);

  double now_s() const { return static_cast<double>(periods_) * model.settings.period_s(); }
  Mode mode() const { return last.report.mode; }
  /// Whether the report's message contains the text.
  bool reports(const std::string& text) const {
    return std::string(last.report.message).find(text) != std::string::npos;
  }
  double speed_radps() const { return arm.velocity_radps.norm(); }

  /// The tool holds these shapes, in its frame, from the next cycle on.
  void hold(const std::vector<Obstacle>& shapes_tool);

  /// Adds a sphere and returns it.
  Obstacle& add_sphere(const Vector3& position_m, const Vector3& velocity_mps, double radius_m = 0.05);

 private:
  template <typename Message>
  struct Sent {
    std::unique_ptr<Message> message;
    Latest<Message> latest;
    void send(const Message& now, double now_s);
  };

  int64_t periods_ = 0;
  Sent<ArmState> sent_arm_;
  Sent<Target> sent_target_;
  Sent<ObstacleSet> sent_obstacles_;
  Sent<OtherJoints> sent_others_;
  Sent<Control> sent_control_;
  Sent<Attachments> sent_attachments_;
};

/// The LWA3 at home without obstacles, with a target 20 cm away that is not sent yet.
ClosedLoop at_home(const std::string& law);

/// The same, moving towards the target.
ClosedLoop tracking(const std::string& law);

/// Fails the test if the arm could not have followed one of the commands.
void check_stream(const ClosedLoop& loop);

}  // namespace sidestep::test
