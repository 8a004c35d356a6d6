#include <sidestep/control_t.hpp>

#include "tests/support/check.h"
#include "tests/support/live_scene.h"

using namespace sidestep;
using test::LiveScene;
using Status = controller_status_t;

namespace {

void ask(LiveScene& scene, int command, double speed_scale = 1.0) {
  static int64_t utime = 0;
  control_t message{};
  message.utime = ++utime;
  message.command = static_cast<int8_t>(command);
  message.speed_scale = speed_scale;
  scene.arm.peer.send("CONTROL", message);
}

void an_operator_pauses_slows_and_resumes(void**) {
  LiveScene scene("sidestep");
  ask(scene, control_t::PAUSE);
  assert_true(scene.arm.run_until(Status::HOLD, 0.5));
  scene.arm.run(0.5);
  assert_true(scene.arm.reports("paused"));
  check_near(scene.arm.status().speed_scale, 0.0, 0.0);
  check_near(scene.arm.speed_radps(), 0.0, 0.01);
  ask(scene, control_t::RESUME, 0.3);
  assert_true(scene.arm.run_until(Status::TRACK, 0.5));
  scene.wander(0.5);
  check_near(scene.arm.status().speed_scale, 0.3, 0.0);
  test::check_stream(scene.arm);
}

void wrong_messages_change_nothing(void**) {
  LiveScene scene("sidestep");
  const int64_t rejected = scene.arm.status().rejected_messages;
  ask(scene, 3);
  ask(scene, control_t::PAUSE, 1.5);
  scene.wander(0.3);
  assert_true(scene.arm.run_until(Status::TRACK, 1.0));
  assert_int_equal(scene.arm.status().rejected_messages - rejected, 2);
}

void a_stop_brakes_and_ends_the_controller(void**) {
  LiveScene scene("sidestep");
  ask(scene, control_t::STOP);
  scene.arm.run(0.5);
  const int code = scene.controller.wait(1.5);
  check(code == 0, "code %d, %s", code, scene.controller.output().c_str());
  check_near(scene.arm.speed_radps(), 0.0, 0);
  scene.arm.commands.end();
  test::check_stream(scene.arm);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(an_operator_pauses_slows_and_resumes, test::kill_processes),
      cmocka_unit_test_teardown(wrong_messages_change_nothing, test::kill_processes),
      cmocka_unit_test_teardown(a_stop_brakes_and_ends_the_controller, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
