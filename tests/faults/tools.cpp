// The scripts in host/tools.

#include "tests/support/check.h"
#include "tests/support/process.h"

using sidestep::test::Process;

namespace {

void holds(const char* what) {
  Process python({"build/venv/bin/python", "tests/support/tools_check.py", what});
  const int code = python.wait(60.0);
  check(code == 0, "%s: %s", what, python.output().c_str());
}

void what_is_sent_as_a_velocity_is_the_slope_of_the_position(void**) {
  holds("velocities");
}
void spheres_of_a_csv_file_run_from_row_to_row(void**) {
  holds("tracks");
}
void a_drawing_is_coloured_by_the_true_clearance(void**) {
  holds("clearances");
}
void what_an_arm_hears_is_drawn_in_the_frame_of_all_arms(void**) {
  holds("places");
}
void what_a_configuration_says_stands_there_is_drawn(void**) {
  holds("surroundings");
}
void a_rotation_survives_the_way_to_a_quaternion(void**) {
  holds("quaternions");
}
void a_log_becomes_one_page_that_needs_no_network(void**) {
  holds("log_becomes_page");
}
void a_log_replays_with_lcm_logplayer(void**) {
  holds("log_replays");
}
void coordinates_are_sent_as_they_were_typed(void**) {
  holds("coordinates");
}
void what_cannot_be_done_is_refused_in_one_line(void**) {
  holds("refusals");
}
void hostile_bytes_are_no_message(void**) {
  holds("hostile_bytes");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(what_is_sent_as_a_velocity_is_the_slope_of_the_position,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(spheres_of_a_csv_file_run_from_row_to_row, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_drawing_is_coloured_by_the_true_clearance, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(what_an_arm_hears_is_drawn_in_the_frame_of_all_arms, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(what_a_configuration_says_stands_there_is_drawn, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_rotation_survives_the_way_to_a_quaternion, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_log_becomes_one_page_that_needs_no_network, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_log_replays_with_lcm_logplayer, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(coordinates_are_sent_as_they_were_typed, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(what_cannot_be_done_is_refused_in_one_line, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(hostile_bytes_are_no_message, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
