#include "host/sim/record.h"

#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "host/sim/summary.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep::sim;
using sidestep::test::message_of;
using sidestep::test::one_line_with;

namespace {

Row row_at(double t_s, double clearance_m = 0.1, double target_distance_m = 0.5) {
  Row row;
  row.t_s = t_s;
  row.q_rad = row.qd_radps = row.command_radps = JointVector::Constant(7, 0.1);
  row.world.obstacles.resize(2);
  for (Obstacle& obstacle : row.world.obstacles) obstacle.solid.size_m.x() = 0.05;
  row.world.obstacles[1].id = 42;
  row.world.obstacles[1].motion.position_m = {1, 0, 1};
  row.nearest = {clearance_m, 1, "forearm"};
  row.axis_distance_m = clearance_m + 0.1;
  row.target_distance_m = target_distance_m;
  row.status.mode = Mode::kTrack;
  return row;
}

Command command(int64_t utime, int64_t seq, double radps) {
  return {utime, seq, Eigen::VectorXd::Constant(7, radps), Eigen::VectorXd::Zero(7)};
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

void a_csv_row_has_every_column_and_full_precision(void**) {
  const auto file = std::filesystem::temp_directory_path() / ("sim_record." + std::to_string(getpid()) + ".csv");
  Truth truth(Arm("urdf/lwa3.urdf", "base_link", "tool"));
  Row row = row_at(1.0 / 3.0);
  row.q_rad[1] = 0.1 + 1e-17;
  row.status.guide_tool_m.col(7) = Eigen::Vector3d(1, 2, 3);
  truth.place(row.q_rad);
  evaluate(row, truth);
  {
    CsvFile csv(file.string(), 7, 2);
    csv.write(row, truth);
    csv.close();
  }
  std::ifstream in(file);
  std::string header, values, rest;
  std::getline(in, header), std::getline(in, values);
  check(!std::getline(in, rest), "more than two lines");
  std::filesystem::remove(file);
  const auto names = split(header), cells = split(values);
  assert_int_equal(names.size(), 1 + 3 * 7 + 9 + 2 * 9 + 6 + 8 * 3 + 2);
  assert_string_equal(names.back().c_str(), "self_clearance_m");
  assert_int_equal(cells.size(), names.size());
  const auto value = [&](const std::string& name) {
    return std::stod(cells[static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin())]);
  };
  check_near(value("t_s"), row.t_s, 0);
  check_near(value("q2_rad"), row.q_rad[1], 0);
  check_near(value("tool_z_m"), row.tool_m.z(), 0);
  check_near(value("o2_x_m"), 1, 0);
  check_near(value("o2_qw"), row.world.obstacles[1].motion.orientation.w(), 0);
  check_near(value("o2_qz"), row.world.obstacles[1].motion.orientation.z(), 0);
  check_near(value("clearance_m"), std::min(value("o1_clearance_m"), value("o2_clearance_m")), 0);
  check_near(value("axis_distance_m"), std::min(value("o1_axis_distance_m"), value("o2_axis_distance_m")), 0);
  check_near(value("guide8_z_m"), 3, 0);
  check_near(value("mode"), 2, 0);
}

void surroundings_and_other_arms_count_in_the_clearance(void**) {
  Truth truth(Arm("urdf/lwa3.urdf", "base_link", "tool"));
  Row row = row_at(0);
  row.q_rad.setZero();
  truth.place(row.q_rad);
  row.world.obstacles.clear();
  Obstacle ball;
  ball.id = -2;
  ball.solid.size_m.x() = 0.05;
  ball.motion.position_m = truth.tool_m();
  row.world.surroundings = {ball};
  row.neighbour_m = 0.1;
  evaluate(row, truth);
  assert_true(row.nearest.clearance_m < 0.0);
  Summary summary(10'000);
  summary.add(row);
  check(summary.text({}).find("surroundings[0]") != std::string::npos, "%s", summary.text({}).c_str());
  row.world.surroundings[0].id = 3;
  row.world.surroundings[0].name = "can";
  Summary named(10'000);
  named.add(row);
  check(named.text({}).find("and can (obstacle 3) at") != std::string::npos, "%s", named.text({}).c_str());

  row.world.surroundings.clear();
  row.neighbour_m = -0.01;
  evaluate(row, truth);
  Summary with_neighbour(10'000);
  with_neighbour.add(row);
  Expectations expect;
  expect.clearance_min_m = 0;
  assert_int_equal(with_neighbour.broken(expect).size(), 1);
  for (const char* part : {"contact                   YES", "to arms     -0.0100 m"})
    check(with_neighbour.text({}).find(part) != std::string::npos, "no '%s'", part);
}

void links_that_touch_each_other_are_a_contact(void**) {
  Truth truth(Arm("urdf/lwa3.urdf", "base_link", "tool"));
  Row row = row_at(0.25);
  row.q_rad.setZero();
  row.q_rad[3] = row.q_rad[5] = 1.97;
  truth.place(row.q_rad);
  row.world.obstacles.clear();
  evaluate(row, truth);
  Summary summary(10'000);
  summary.add(row);
  const std::string text = summary.text({});
  for (const char* part : {"contact                   YES", "upper_arm_link and hand_link at 0.25 s"})
    check(text.find(part) != std::string::npos, "no '%s' in: %s", part, text.c_str());
  Expectations expect;
  assert_int_equal(summary.broken(expect).size(), 0);
  expect.clearance_min_m = 0;
  assert_int_equal(summary.broken(expect).size(), 1);
  check(summary.broken(expect)[0].find("upper_arm_link and hand_link") != std::string::npos, "%s",
        summary.broken(expect)[0].c_str());
}

/// Links may be nearer to each other than the expected clearance to obstacles.
void near_links_are_no_contact(void**) {
  Row row = row_at(0, 0.1);
  row.nearest_links = {0.01, "forearm", "base"};
  Summary summary(10'000);
  summary.add(row);
  Expectations expect;
  expect.clearance_min_m = 0.05;
  assert_int_equal(summary.broken(expect).size(), 0);
  for (const char* part : {"contact                   no", "min between links         0.0100 m   forearm and base"})
    check(summary.text({}).find(part) != std::string::npos, "no '%s' in: %s", part, summary.text({}).c_str());
}

void an_unwritable_csv_file_is_refused_with_one_line(void**) {
  assert_true(
      one_line_with(message_of([] { CsvFile("no/such/folder/a.csv", 7, 0); }), {"no/such/folder/a.csv: cannot"}));
  assert_true(one_line_with(message_of([] { CsvFile("/dev/full", 7, 0).close(); }), {"/dev/full: "}));
}

void expectations_are_checked_over_the_whole_run(void**) {
  Summary summary(10'000);
  summary.add(row_at(0, 0.1, 0.5));
  summary.add(row_at(0.01, -0.02, 0.4));
  summary.add(row_at(0.02, 0.3, 0.001));
  Expectations expect;
  expect.final_distance_max_m = 0.001;
  expect.clearance_min_m = -0.02;
  expect.axis_distance_min_m = 0.08;
  expect.joint_speed_max_radps = 0.1;
  assert_int_equal(summary.broken(expect).size(), 0);
  assert_int_equal(summary.broken({}).size(), 0);
  expect.final_distance_max_m = 0.0005;
  expect.clearance_min_m = 0;
  expect.joint_speed_max_radps = 0.05;
  const auto broken = summary.broken(expect);
  assert_int_equal(broken.size(), 3);
  assert_string_equal(broken[0].c_str(), "final_distance_max_m: wanted at most 0.0005, got 0.001");
  assert_string_equal(broken[1].c_str(), "clearance_min_m: wanted at least 0, got -0.02");
}

void a_result_that_is_not_a_number_breaks_an_expectation(void**) {
  Row row = row_at(0);
  row.nearest.clearance_m = row.target_distance_m = std::nan("");
  Summary summary(10'000);
  summary.add(row);
  Expectations expect;
  expect.final_distance_max_m = 1;
  assert_int_equal(summary.broken(expect).size(), 1);
}

double largest_acceleration_radps2(const std::vector<Command>& commands) {
  Summary summary(10'000);
  for (const Command& one : commands) summary.add(one);
  Expectations expect;
  expect.joint_acceleration_max_radps2 = -1;
  return std::stod(
      summary.broken(expect).at(0).substr(std::string("joint_acceleration_max_radps2: wanted at most -1, got").size()));
}

void acceleration_is_computed_over_the_cycles_between_two_commands(void**) {
  const auto after = [](int64_t since_us, int64_t cycles, double radps) {
    return largest_acceleration_radps2({command(1'000'000, 5, 0), command(1'000'000 + since_us, 5 + cycles, radps)});
  };
  check_near(after(10'000, 1, 0.1), 10, 1e-9);
  check_near(after(1'000, 1, 0.1), 10, 1e-9);   // a late cycle, then one on time
  check_near(after(31'000, 1, 0.1), 10, 1e-9);  // skipped cycles permit no larger step
  check_near(after(12'000, 2, 0.2), 10, 1e-9);  // a command was lost, and the one before it was late
  check_near(largest_acceleration_radps2({command(1'000'000, 5, 0.3), command(1'060'000, 11, 0.9)}), 10, 1e-9);
  check_near(after(0, 0, 0.1), 10, 1e-9);  // another controller
  check_near(after(10'000, 1000, 0.1), 10, 1e-9);
  check_near(after(10'000, -1000, 0.1), 10, 1e-9);
}

void a_command_stream_starts_between_the_last_command_and_rest(void**) {
  // A simulator that is started again receives the commands for an arm in motion.
  check_near(largest_acceleration_radps2({command(1'000'000, 5, 1.4), command(1'010'000, 6, 1.3)}), 10, 1e-9);
  const auto after_pause = [](double radps) {
    return largest_acceleration_radps2({command(1'000'000, 5, 0.4), command(1'200'000, 6, radps)});
  };
  check_near(after_pause(0), 0, 1e-9);
  check_near(after_pause(0.4), 0, 1e-9);
  check_near(after_pause(0.7), 30, 1e-9);
  check_near(after_pause(-0.3), 30, 1e-9);
  // From rest a stream may have ended: no cycle between the two counts.
  check_near(largest_acceleration_radps2({command(1'000'000, 5, 0), command(1'060'000, 11, 0.3)}), 30, 1e-9);
}

/// Commands of a controller with a period of 1 ms, whose time stamps jitter and of which some are lost. The position
/// catches up with the arm in some of its joints for a while.
void acceleration_of_a_faster_controller_is_computed_over_its_own_periods(void**) {
  const double period_s = 0.001, acceleration_radps2 = 10.0;
  sidestep::test::Random random(1);
  Summary summary(10'000);
  double q_rad = 1.0, qd_radps = 0.0;
  Eigen::VectorXd catching_up_rad = Eigen::VectorXd::Zero(7);
  for (int i = 0; i < 2000; ++i) {
    qd_radps += (i % 400 < 200 ? 1.0 : -1.0) * acceleration_radps2 * period_s;
    q_rad += qd_radps * period_s;
    if (i > 500 && i < 600) catching_up_rad.head(3).array() -= 0.7 * qd_radps * period_s;
    Command command{1'000'000 + 1000 * i + random.index(300), i, Eigen::VectorXd::Constant(7, qd_radps),
                    Eigen::VectorXd::Constant(7, q_rad) + catching_up_rad};
    if (i % 50 != 49) summary.add(command);
  }
  Expectations expect;
  expect.joint_acceleration_max_radps2 = acceleration_radps2 * (1.0 + 1e-9);
  assert_int_equal(summary.broken(expect).size(), 0);
  expect.joint_acceleration_max_radps2 = acceleration_radps2 * (1.0 - 1e-9);
  assert_int_equal(summary.broken(expect).size(), 1);
}

/// The position of a joint that catches up with the arm moves by less than its velocity says.
void a_single_joint_that_catches_up_does_not_count_as_acceleration(void**) {
  const auto at = [](int64_t cycle, double q_rad, double qd_radps) {
    Eigen::VectorXd position_rad = Eigen::VectorXd::Zero(7), velocity_radps = Eigen::VectorXd::Zero(7);
    position_rad[3] = q_rad;
    velocity_radps[3] = qd_radps;
    return Command{10'000 * cycle, cycle, velocity_radps, position_rad};
  };
  check_near(largest_acceleration_radps2({at(1, 0, 1.1), at(2, 0.01, 1.2), at(3, 0.021, 1.3)}), 10, 1e-9);
}

void the_summary_names_the_closest_pair(void**) {
  Summary summary(10'000);
  Scenario scenario;
  scenario.title = "a title";
  scenario.published.axis_distance_m = 0.2154;
  summary.add(row_at(0.5, -0.01));
  const std::string text = summary.text(scenario);
  check(Summary(10'000).text({}).find("inf") == std::string::npos, "%s", Summary(10'000).text({}).c_str());
  for (const char* part : {"a title", "YES", "-0.0100 m", "forearm and obstacle 42 at 0.50 s", "(paper: 0.2154 m)"}) {
    check(text.find(part) != std::string::npos, "no '%s' in: %s", part, text.c_str());
  }
  Row nearer = row_at(0.7, -0.02);
  nearer.world.obstacles[1].id = -3;
  summary.add(nearer);
  assert_true(summary.text(scenario).find("forearm and surroundings[1] at 0.70 s") != std::string::npos);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_csv_row_has_every_column_and_full_precision),
      cmocka_unit_test(surroundings_and_other_arms_count_in_the_clearance),
      cmocka_unit_test(links_that_touch_each_other_are_a_contact),
      cmocka_unit_test(near_links_are_no_contact),
      cmocka_unit_test(an_unwritable_csv_file_is_refused_with_one_line),
      cmocka_unit_test(expectations_are_checked_over_the_whole_run),
      cmocka_unit_test(a_result_that_is_not_a_number_breaks_an_expectation),
      cmocka_unit_test(acceleration_is_computed_over_the_cycles_between_two_commands),
      cmocka_unit_test(a_command_stream_starts_between_the_last_command_and_rest),
      cmocka_unit_test(acceleration_of_a_faster_controller_is_computed_over_its_own_periods),
      cmocka_unit_test(a_single_joint_that_catches_up_does_not_count_as_acceleration),
      cmocka_unit_test(the_summary_names_the_closest_pair),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
