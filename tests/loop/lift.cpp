#include "firmware/foresight/foresight.h"
#include "firmware/foresight/inverse_kinematics.h"
#include "firmware/io/config/config.h"
#include "host/sim/truth.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

constexpr const char *kUrdf = "tests/data/lift_arm.urdf", *kBase = "mast", *kTip = "tool";

const Model& lift_model() {
  static const Model model = load_config("", {"sidestep", kUrdf, kBase, kTip}).model;
  return model;
}

JointVector start_rad() {
  JointVector q_rad(8);
  q_rad << 0.1, 0.3, 1.0, 0.2, -1.4, 0.0, -0.5, 0.0;
  return q_rad;
}

/// The loop with foresight, one update in each cycle.
class Loop : public ClosedLoop {
 public:
  Loop() : ClosedLoop(lift_model(), start_rad()), foresight_(std::make_unique<Foresight>(model)) {
    sends_target = true;
  }

  void run_with_foresight(double duration_s) {
    for (double t_s = 0.0; t_s < duration_s; t_s += model.settings.period_s()) {
      Inputs inputs = receive();
      inputs.guide = &guide_;
      follow(step(model, state, inputs, now_s()));
      take_snapshot(model, inputs, state, now_s(), *snapshot_);
      guide_ = foresight_->update(*snapshot_);
      measure();
    }
  }

  double least_m() const { return least_m_; }
  bool within_limits() const { return within_limits_; }

 private:
  void measure() {
    truth_.place(arm.position_rad);
    for (int i = 0; i < obstacles->count; ++i) {
      sim::Obstacle sphere;
      sphere.solid.size_m.x() = obstacles->obstacles[static_cast<size_t>(i)].capsule.radius_m;
      sphere.motion.position_m = obstacles->obstacles[static_cast<size_t>(i)].capsule.start;
      least_m_ = std::min(least_m_, truth_.clearance_m(sphere));
    }
    const JointLimits& limits = model.arm.limits;
    within_limits_ = within_limits_ && ((arm.position_rad - limits.lower_rad).array() >= -1e-9).all() &&
                     ((limits.upper_rad - arm.position_rad).array() >= -1e-9).all();
  }

  sim::Truth truth_{sim::Arm(kUrdf, kBase, kTip)};
  std::unique_ptr<Foresight> foresight_;
  std::unique_ptr<Snapshot> snapshot_ = std::make_unique<Snapshot>();
  Guide guide_;
  double least_m_ = HUGE_VAL;
  bool within_limits_ = true;
};

/// The target is 0.5 m above the start, so that the lift has to move; spheres cross the way.
void an_arm_on_a_lift_arrives_among_obstacles_without_contact(void**) {
  Loop loop;
  const Vector3 start_m = forward_kinematics(loop.model.arm, start_rad()).tool_position;
  loop.target.position_m = start_m + Vector3(0.05, 0.0, 0.5);
  loop.add_sphere(start_m + Vector3(0.02, 0.0, 0.3), Vector3::Zero(), 0.06);
  loop.add_sphere(start_m + Vector3(0.0, -1.2, 0.4), Vector3(0.0, 0.25, 0.0), 0.08);
  loop.add_sphere(start_m + Vector3(0.1, 1.5, 0.2), Vector3(0.0, -0.3, 0.0), 0.08);
  loop.run_with_foresight(12.0);
  print_message("lift: %.1f mm, target missed by %.1f mm, lift at %.3f m\n", loop.least_m() * 1e3,
                loop.last.report.target_distance_m * 1e3, loop.arm.position_rad[0]);
  test::check_stream(loop);
  check(loop.least_m() > 0.0, "contact: %g m", loop.least_m());
  assert_true(loop.within_limits());
  check(loop.last.report.target_distance_m < 0.01, "%g m from the target", loop.last.report.target_distance_m);
  check(loop.arm.position_rad[0] > start_rad()[0] + 0.05, "the lift stayed at %g m", loop.arm.position_rad[0]);
}

/// The tolerance of 0.5 rad is 0.125 m for the lift. The drive of the lift does not move.
void the_command_of_a_lift_that_is_held_stops_at_an_eighth_of_a_metre(void**) {
  ClosedLoop loop(lift_model(), start_rad());
  loop.commands.allow_position_correction();
  loop.sends_target = true;
  loop.target.position_m = forward_kinematics(loop.model.arm, start_rad()).tool_position + Vector3(0, 0, 1.0);
  double farthest_m = 0.0;
  for (int i = 0; i < 600; ++i) {
    loop.cycle();
    loop.arm.position_rad[0] = start_rad()[0];
    loop.arm.velocity_radps[0] = 0.0;
    if (loop.last.commanding)
      farthest_m = std::max(farthest_m, std::abs(loop.last.command.position_rad[0] - start_rad()[0]));
  }
  check(farthest_m > 0.02 && farthest_m < 0.125 + 1e-6, "%g m", farthest_m);
}

void inverse_kinematics_solves_with_a_lift(void**) {
  const Arm& arm = lift_model().arm;
  Random random(4);
  int solved = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const LinkPoses poses = forward_kinematics(arm, random.configuration(arm, 0.7));
    Target target;
    target.position_m = poses.tool_position;
    target.tracks_orientation = true;
    target.orientation = Quaternion(poses.tool_rotation);
    JointVector q_rad = random.configuration(arm, 0.7);
    if (!solve_ik(arm, target, q_rad)) continue;
    ++solved;
    check_near(forward_kinematics(arm, q_rad).tool_position, target.position_m, 1e-3);
    assert_true(((q_rad - arm.limits.lower_rad).array() >= 0.0).all());
    assert_true(((arm.limits.upper_rad - q_rad).array() >= 0.0).all());
  }
  print_message("%d of 100 poses solved from a random start\n", solved);
  check(solved > 30, "%d of 100", solved);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_arm_on_a_lift_arrives_among_obstacles_without_contact),
      cmocka_unit_test(the_command_of_a_lift_that_is_held_stops_at_an_eighth_of_a_metre),
      cmocka_unit_test(inverse_kinematics_solves_with_a_lift),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
