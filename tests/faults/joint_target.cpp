#include <sidestep/joint_target_t.hpp>

#include "tests/support/check.h"
#include "tests/support/live_scene.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"

using namespace sidestep;
using test::LiveScene;
using Status = controller_status_t;

namespace {

/// A posture 50 times a second, without targets of the tool.
void follow_posture(LiveScene& scene, const JointVector& goal_rad, double duration_s) {
  static int64_t utime = 0;
  scene.arm.sends_target = false;
  for (double t_s = 0.0; t_s < duration_s; t_s += 0.02) {
    utime += 20'000;
    scene.arm.peer.send("JOINT_TARGET", test::joint_target_message(utime, goal_rad));
    scene.arm.run(0.02);
  }
}

void an_arm_takes_a_posture_and_holds_without_further_messages(void**) {
  LiveScene scene("sidestep");
  const JointVector goal_rad = test::home_rad() + JointVector::Constant(7, 0.2);
  follow_posture(scene, goal_rad, 4.0);
  assert_true(scene.arm.status().mode == Status::TRACK);
  check_near(scene.arm.status().target_distance, 0.0, 1e-3);
  check_near(scene.arm.speed_radps(), 0.0, 1e-2);
  assert_true(scene.arm.run_until(Status::HOLD, 0.5));
  assert_true(scene.arm.reports("the target is too old"));
  scene.arm.sends_target = true;
  assert_true(scene.arm.run_until(Status::TRACK, 0.5));
  scene.wander(0.8);
  test::check_stream(scene.arm);
}

void the_simulators_arm_takes_the_posture_of_a_scenario(void**) {
  const std::string url = test::private_lcm_url();
  test::Process controller(
      {"build/controller", "--config", "firmware/config/panda.yaml", "--lockstep", "--lcm-url", url});
  test::Process sim({"build/sim", "--scenario", "host/scenarios/home-from-under-table.yaml", "--lockstep", "--quiet",
                     "--lcm-url", url});
  const int code = sim.wait(300.0);  // a build with sanitizers is slow
  check(code == 0, "code %d: %s", code, sim.output().c_str());
}

void wrong_messages_change_nothing(void**) {
  LiveScene scene("sidestep");
  const int64_t rejected = scene.arm.status().rejected_messages;
  scene.arm.peer.send("JOINT_TARGET", test::joint_target_message(1, JointVector::Zero(6)));
  scene.arm.peer.send("JOINT_TARGET", test::joint_target_message(2, JointVector::Constant(7, HUGE_VAL)));
  scene.wander(0.3);
  assert_true(scene.arm.status().mode == Status::TRACK);
  assert_int_equal(scene.arm.status().rejected_messages - rejected, 2);
  assert_true(scene.arm.reports("target with impossible values"));
  test::check_stream(scene.arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(an_arm_takes_a_posture_and_holds_without_further_messages, test::kill_processes),
      cmocka_unit_test_teardown(the_simulators_arm_takes_the_posture_of_a_scenario, test::kill_processes),
      cmocka_unit_test_teardown(wrong_messages_change_nothing, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
