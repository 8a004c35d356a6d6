// The scripts in host/tools.

#include "tests/support/python_check.h"

namespace {

void passes(const char* name) {
  sidestep::test::require_python_check("tools_check.py", name);
}

void sent_velocities_are_the_derivatives_of_sent_positions(void**) {
  passes("velocities");
}
void spheres_of_a_csv_file_run_from_row_to_row(void**) {
  passes("tracks");
}
void a_drawing_is_coloured_by_the_true_clearance(void**) {
  passes("clearances");
}
void a_line_leads_from_a_link_to_its_nearest_obstacle(void**) {
  passes("nearest_lines");
}
void no_link_is_coloured_as_safe_while_the_clearance_is_unknown(void**) {
  passes("unknown_clearance");
}
void the_tool_is_not_coloured_by_what_it_may_touch(void**) {
  passes("allowed_touch");
}
void the_panel_of_the_view_says_what_is_unknown(void**) {
  passes("panel_texts");
}
void obstacles_received_by_an_arm_are_drawn_in_the_world_frame(void**) {
  passes("places");
}
void a_posture_is_drawn_where_it_puts_the_tool(void**) {
  passes("goals");
}
void the_surroundings_of_a_configuration_are_drawn(void**) {
  passes("surroundings");
}
void visual_meshes_are_found_beside_the_urdf_and_in_packages(void**) {
  passes("visual_meshes");
}
void a_rotation_is_restored_from_its_quaternion(void**) {
  passes("quaternions");
}
void a_log_replays_with_lcm_logplayer(void**) {
  passes("log_replays");
}
void a_recording_closes_its_log_at_every_signal_that_ends_it(void**) {
  passes("closed_logs");
}
void a_script_goes_on_under_nohup_when_its_terminal_is_closed(void**) {
  passes("survivors_of_nohup");
}
void coordinates_are_sent_as_they_were_typed(void**) {
  passes("coordinates");
}
void impossible_requests_are_refused_in_one_line(void**) {
  passes("refusals");
}
void senders_say_what_they_send(void**) {
  passes("announcements");
}
void the_error_about_an_unknown_scenario_lists_the_scenarios(void**) {
  passes("unknown_scenario");
}
void a_taken_port_is_refused_before_anything_starts(void**) {
  passes("taken_port");
}
void a_view_that_ends_also_ends_a_scenario_without_end(void**) {
  passes("lost_view");
}
void the_commands_that_make_play_names_run(void**) {
  passes("play_commands");
}
void a_script_that_another_python_starts_finds_its_packages(void**) {
  passes("another_python");
}
void a_run_beside_another_controller_is_refused(void**) {
  passes("busy_network");
}
void a_second_signal_leaves_no_process_behind(void**) {
  passes("second_signal");
}
void messages_that_came_earlier_are_received_without_time_left(void**) {
  passes("late_receiver");
}
void a_silent_controller_is_shown_as_stale_and_no_value_as_a_word(void**) {
  passes("watched_texts");
}
void a_signal_within_poll_ends_the_run(void**) {
  passes("signal_within_poll");
}
void no_two_runs_share_a_network(void**) {
  passes("networks");
}
void the_camera_of_the_view_moves_aside_where_a_wall_would_hide_the_arm(void**) {
  passes("camera");
}
void hostile_bytes_are_not_decoded(void**) {
  passes("hostile_bytes");
}
void a_manual_page_lists_the_options_of_its_program(void**) {
  passes("manual_pages");
}
void an_installed_script_has_the_modules_that_it_imports(void**) {
  passes("installed_modules");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(sent_velocities_are_the_derivatives_of_sent_positions, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(spheres_of_a_csv_file_run_from_row_to_row, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_drawing_is_coloured_by_the_true_clearance, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_line_leads_from_a_link_to_its_nearest_obstacle, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(no_link_is_coloured_as_safe_while_the_clearance_is_unknown,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_tool_is_not_coloured_by_what_it_may_touch, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_panel_of_the_view_says_what_is_unknown, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(obstacles_received_by_an_arm_are_drawn_in_the_world_frame,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_surroundings_of_a_configuration_are_drawn, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_posture_is_drawn_where_it_puts_the_tool, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(visual_meshes_are_found_beside_the_urdf_and_in_packages,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_rotation_is_restored_from_its_quaternion, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_log_replays_with_lcm_logplayer, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_recording_closes_its_log_at_every_signal_that_ends_it,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_script_goes_on_under_nohup_when_its_terminal_is_closed,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(coordinates_are_sent_as_they_were_typed, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(impossible_requests_are_refused_in_one_line, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(senders_say_what_they_send, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_error_about_an_unknown_scenario_lists_the_scenarios,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_taken_port_is_refused_before_anything_starts, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_view_that_ends_also_ends_a_scenario_without_end, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_commands_that_make_play_names_run, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_script_that_another_python_starts_finds_its_packages, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_run_beside_another_controller_is_refused, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_second_signal_leaves_no_process_behind, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(messages_that_came_earlier_are_received_without_time_left,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_silent_controller_is_shown_as_stale_and_no_value_as_a_word,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_signal_within_poll_ends_the_run, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(no_two_runs_share_a_network, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(the_camera_of_the_view_moves_aside_where_a_wall_would_hide_the_arm,
                                sidestep::test::kill_processes),
      cmocka_unit_test_teardown(hostile_bytes_are_not_decoded, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(a_manual_page_lists_the_options_of_its_program, sidestep::test::kill_processes),
      cmocka_unit_test_teardown(an_installed_script_has_the_modules_that_it_imports, sidestep::test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
