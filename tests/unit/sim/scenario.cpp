#include "host/sim/scenario.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "host/people/body.h"

#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep::sim;
using Eigen::Vector3d;
using sidestep::test::message_of;
using sidestep::test::one_line_with;
using sidestep::test::text_of;

namespace {

const std::string kGood = R"(title: two obstacles and a servo
robot: {urdf: urdf/lwa3.urdf, base: base_link, tip: tool}
config: firmware/config/lwa3.yaml
duration_s: 1.5
rate_hz: 200
start_rad: [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
plant: {kind: servo, lag_s: 0.03, latency_s: 0.01, velocity_limit_radps: 2, acceleration_limit_radps2: [1, 2, 3, 4, 5, 6, 7]}
target: {position_m: [1, 2, 3], velocity_mps: [0, 0.1, 0], quaternion: [0, 1, 0, 0], angular_velocity_radps: [0, 0, 1]}
obstacles:
  - {id: 4, shape: box, edges_m: [0.1, 0.2, 0.3], position_m: [0, 0, 1], velocity_mps: [0, 0, 0], quaternion: [1, 0, 0, 0]}
  - {id: 9, shape: capsule, radius_m: 0.1, length_m: 0.5, position_m: [0, 1, 1], velocity_mps: [0, 0, -1]}
  - {id: 11, shape: cylinder, radius_m: 0.04, height_m: 0.2, position_m: [1, 1, 1], velocity_mps: [0, 0, 0], kind: person}
expect: {final_distance_max_m: 0.01, clearance_min_m: 0.02}
published: {axis_distance_m: 0.2}
)";

/// Loads the text as the scenario `name` from a folder of its own.
Scenario load(const std::string& text, const std::string& name = "a.yaml") {
  const auto folder = std::filesystem::temp_directory_path() / ("sim_scenario." + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << text;
  struct Cleanup {
    std::filesystem::path folder;
    ~Cleanup() { std::filesystem::remove_all(folder); }
  } const cleanup{folder};
  return load_scenario((folder / name).string()).front();
}

std::string changed(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const size_t at = text.find(from);
  return at == std::string::npos ? "(the change does not apply)" : text.replace(at, from.size(), to);
}

void every_value_of_a_scenario_is_read(void**) {
  const Scenario s = load(kGood);
  assert_string_equal(s.title.c_str(), "two obstacles and a servo");
  assert_string_equal(s.controller_config.c_str(), "firmware/config/lwa3.yaml");
  assert_int_equal(s.period_us, 5000);
  assert_int_equal(s.periods, 300);
  check_near(s.duration_s(), 1.5, 0);
  assert_int_equal(s.start_rad.size(), 7);
  check_near(s.start_rad[6], 0.6, 0);
  assert_true(s.plant.kind == PlantSpec::Kind::kServo);
  check_near(s.plant.lag_s, 0.03, 0);
  check_near(s.plant.latency_s, 0.01, 0);
  check_near(s.plant.velocity_limit_radps, JointVector::Constant(7, 2), 0);
  check_near(s.plant.acceleration_limit_radps2[6], 7, 0);
  assert_true(s.world.target->tracks_orientation);
  check_near(s.world.target->motion.position_m, Vector3d(1, 2, 3), 0);
  check_near(s.world.target->motion.orientation.x(), 1, 0);
  assert_int_equal(s.world.obstacles.size(), 3);
  const Obstacle &box = s.world.obstacles[0], &capsule = s.world.obstacles[1], &cylinder = s.world.obstacles[2];
  assert_int_equal(box.id, 4);
  check_near(box.solid.size_m, Vector3d(0.1, 0.2, 0.3), 0);
  assert_true(capsule.solid.shape == Shape::kCapsule);
  assert_true(cylinder.is_person && !capsule.is_person);
  check_near(capsule.solid.size_m, Vector3d(0.1, 0.5, 0), 0);
  check_near(capsule.motion.velocity_mps, Vector3d(0, 0, -1), 0);
  assert_true(cylinder.solid.shape == Shape::kCylinder);
  check_near(cylinder.solid.size_m, Vector3d(0.04, 0.2, 0), 0);
  check_near(*s.expect.clearance_min_m, 0.02, 0);
  assert_false(s.expect.axis_distance_min_m.has_value());
  check_near(*s.published.axis_distance_m, 0.2, 0);
}

/// The document's keys exist, and every section that a scenario can have is in it.
void the_documented_scenario_is_read(void**) {
  const std::string document = text_of("docs/scenarios.md"), opening = "```yaml\n";
  const size_t begin = document.find(opening) + opening.size();
  const Scenario s = load(document.substr(begin, document.find("```", begin) - begin));
  assert_int_equal(s.periods, 800);
  assert_true(s.plant.kind == PlantSpec::Kind::kServo && s.sensing.lost_share > 0.0 && s.grasp.size() == 2);
  assert_true(s.world.target->tracks_orientation && s.world.target->motion.path);
  assert_int_equal(s.world.obstacles.size(), 4 + sidestep::kBodyParts);
  const Expectations& e = s.expect;
  assert_true(e.final_distance_max_m && e.clearance_min_m && e.axis_distance_min_m && e.joint_speed_max_radps &&
              e.joint_acceleration_max_radps2 && s.published.final_distance_m && s.published.axis_distance_m);
}

void a_target_may_be_a_posture(void**) {
  const std::string target =
      "target: {position_m: [1, 2, 3], velocity_mps: [0, 0.1, 0], quaternion: [0, 1, 0, 0], "
      "angular_velocity_radps: [0, 0, 1]}";
  const Scenario s = load(changed(target, "target: {joints_rad: [0, 1, 2, 3, 4, 5, -6]}"));
  assert_int_equal(s.world.target->joints_rad.size(), 7);
  check_near(s.world.target->joints_rad[6], -6, 0);
  for (const std::string wrong :
       {"{joints_rad: []}", "{joints_rad: [.nan]}", "{joints_rad: [1], position_m: [1, 2, 3]}"}) {
    const std::string message = message_of([&] { load(changed(target, "target: " + wrong)); });
    check(one_line_with(message, {"a.yaml", "target"}), "%s: '%s'", wrong.c_str(), message.c_str());
  }
}

void waypoints_follow_the_position_and_velocity_at_the_start(void**) {
  const std::string two = ", waypoints: [[0.05, 1, 2, 3.5, 4, 5, 6], [0.2, 7, 8, 9, 0, 0, -1]]";
  const World curved_target = load(changed("velocity_mps: [0, 0.1, 0]", "velocity_mps: [0, 0.1, 0]" + two)).world;
  const World curved_bar = load(changed("velocity_mps: [0, 0, -1]", "velocity_mps: [0, 0, -1]" + two)).world;
  assert_null(curved_target.obstacles[1].motion.path.get());
  assert_null(curved_bar.target->motion.path.get());
  for (const Motion& motion : {curved_target.target->motion, curved_bar.obstacles[1].motion}) {
    assert_non_null(motion.path.get());
    const Path& path = *motion.path;
    assert_int_equal(path.size(), 3);
    check_near(path[0].t_s, 0, 0);
    check_near(path[0].position_m, motion.position_m, 0);
    check_near(path[0].velocity_mps, motion.velocity_mps, 0);
    check_near(path[1].t_s, 0.05, 0);
    check_near(path[1].position_m, Vector3d(1, 2, 3.5), 0);
    check_near(path[1].velocity_mps, Vector3d(4, 5, 6), 0);
    check_near(path[2].velocity_mps, Vector3d(0, 0, -1), 0);
  }
}

constexpr const char* kPerson = R"(people:
  - id: 20
    stature_m: 1.7
    postures:
      - {at_s: 0.5, position_m: [1, 2, -0.5], heading_rad: 3.14159265, right_hand_m: [0.4, -0.1, 1.0]}
      - {at_s: 1, lean_rad: 0.1}
      - {at_s: 1.4, hands: hanging, sitting: 1}
title: two)";

void the_parts_of_a_person_are_obstacles_that_move(void**) {
  const World start = load(changed("title: two", kPerson)).world, end = advanced(start, 2.0);
  assert_int_equal(start.obstacles.size(), 3 + sidestep::kBodyParts);
  for (int part = 0; part < sidestep::kBodyParts; ++part) {
    const Obstacle& obstacle = start.obstacles[static_cast<size_t>(3 + part)];
    assert_int_equal(obstacle.id, 20 + part);
    assert_true(obstacle.is_person && obstacle.solid.shape == Shape::kCapsule);
  }
  const auto part_of = [](const World& world, int part) -> const Motion& {
    return world.obstacles[static_cast<size_t>(3 + part)].motion;
  };
  // The person's x axis is -x, the hand 1 m above the floor.
  check_near(part_of(start, sidestep::kHandRight).position_m, Vector3d(0.6, 2.1, 0.5), 1e-3);
  const Motion& thigh = part_of(end, sidestep::kThighLeft);
  check_near(thigh.orientation * Vector3d::UnitZ(), Vector3d(-1, 0, 0), 1e-6);
  check(part_of(end, sidestep::kHandRight).position_m.z() < 0.0, "the hand does not hang");
}

struct Mistake {
  const char* from;
  const char* to;
  const char* key;        ///< that the error names
  const char* complaint;  ///< another part of the error
};

const Mistake kMistakes[] = {
    {"title: two", "titel: two", "title", "missing"},
    {"config: firmware", "seed: 3\nconfig: firmware", "seed", "unknown key"},
    {"config: firmware", "title: again\nconfig: firmware", "title", "given twice"},
    {"title: two obstacles and a servo", "title: [a, b]", "title", "text"},
    {"urdf: urdf/lwa3.urdf", "urdf: urdf/none.urdf", "robot.urdf", "no file 'urdf/none.urdf'"},
    {"tip: tool", "tip: tool, colour: red", "robot.colour", "unknown key"},
    {"duration_s: 1.5", "duration_s: .nan", "duration_s", "finite"},
    {"duration_s: 1.5", "duration_s: -1", "duration_s", "from 0"},
    {"duration_s: 1.5", "duration_s: 0", "duration_s", "whole number of periods"},
    {"duration_s: 1.5", "duration_s: 1.503", "duration_s", "whole number of periods"},
    {"duration_s: 1.5", "duration_s: 1e999", "duration_s", "finite"},
    {"duration_s: 1.5\n", "", "expect", "needs duration_s"},
    {"duration_s: 1.5", "duration_s: ~", "duration_s", "missing"},
    {"target: {position_m: [1, 2, 3], velocity_mps: [0, 0.1, 0], quaternion: [0, 1, 0, 0], angular_velocity_radps: [0, "
     "0, 1]}\n",
     "", "expect.final_distance_max_m", "needs a target"},
    {"rate_hz: 200", "rate_hz: 300", "rate_hz", "microseconds"},
    {"rate_hz: 200", "rate_hz: 12.5", "rate_hz", "whole number"},
    {"rate_hz: 200", "rate_hz: fast", "rate_hz", "finite number"},
    {"start_rad: [0, ", "start_rad: [.inf, ", "start_rad[0]", "finite"},
    {"start_rad: [0, ", "start_rad: [[0], ", "start_rad[0]", "finite number"},
    {"start_rad: [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]", "start_rad: []", "start_rad", "1 to 10"},
    {"start_rad: [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]", "start_rad: 3", "start_rad", "list"},
    {"start_rad: [0, ", "start_rad: [1, 2, 3, 4, 0, ", "start_rad", "1 to 10"},
    {"start_rad: [0, ", "start_rad: [", "plant.acceleration_limit_radps2", "list of 6 numbers"},
    {"kind: servo", "kind: magic", "plant.kind", "'magic'"},
    {"kind: servo", "kind: ideal", "plant.lag_s", "unknown key"},
    {"lag_s: 0.03, ", "", "plant.lag_s", "missing"},
    {"latency_s: 0.01", "latency_s: -0.01", "plant.latency_s", "from 0 to 1"},
    {"velocity_limit_radps: 2", "velocity_limit_radps: 0", "plant.velocity_limit_radps", "is 0"},
    {"velocity_limit_radps: 2", "velocity_limit_radps: [2, 2]", "plant.velocity_limit_radps", "list of 7 numbers"},
    {"plant: {", "plant: [], other: {", "", "line 7"},
    {"position_m: [1, 2, 3]", "position_m: [1, 2]", "target.position_m", "3 numbers"},
    {"position_m: [1, 2, 3]", "position_m: [1, 2, .nan]", "target.position_m[2]", "finite"},
    {"position_m: [1, 2, 3]", "position_m: [1, 2, 3e9]", "target.position_m[2]", "from -1000 to 1000"},
    {"velocity_mps: [0, 0.1, 0], ", "", "target.velocity_mps", "missing"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [], ", "target.waypoints", "at least one"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: 3, ", "target.waypoints", "list of lists"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: {a: 1}, ", "target.waypoints",
     "list of lists"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [1, 2, 3, 4, 5, 6, 7], ",
     "target.waypoints[0]", "list of 7 numbers"},
    {"velocity_mps: [0, 0.1, 0], ",
     "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, 0], [2, 1, 2, 3, 0, 0]], ", "target.waypoints[1]",
     "list of 7 numbers"},
    {"velocity_mps: [0, 0.1, 0], ",
     "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, 0], [2, 1, 2, 3, 0, 0, 0, 0]], ", "target.waypoints[1]",
     "list of 7 numbers"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, .nan, 0, 0, 0]], ",
     "target.waypoints[0][3]", "finite"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[.inf, 1, 2, 3, 0, 0, 0]], ",
     "target.waypoints[0][0]", "finite"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, fast, 0]], ",
     "target.waypoints[0][5]", "finite number"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, [0]]], ",
     "target.waypoints[0][6]", "finite number"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3e9, 0, 0, 0]], ",
     "target.waypoints[0][3]", "from -1000 to 1000"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, 101]], ",
     "target.waypoints[0][6]", "from -100 to 100"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[-1, 1, 2, 3, 0, 0, 0]], ",
     "target.waypoints[0][0]", "from 0"},
    {"velocity_mps: [0, 0.1, 0], ", "velocity_mps: [0, 0.1, 0], waypoints: [[0, 1, 2, 3, 0, 0, 0]], ",
     "target.waypoints[0][0]", "must increase"},
    {"velocity_mps: [0, 0.1, 0], ",
     "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, 0], [1, 1, 2, 3, 0, 0, 0]], ", "target.waypoints[1][0]",
     "must increase"},
    {"velocity_mps: [0, 0.1, 0], ",
     "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, 0], [0.5, 1, 2, 3, 0, 0, 0]], ",
     "target.waypoints[1][0]", "must increase"},
    {"velocity_mps: [0, 0.1, 0], ",
     "velocity_mps: [0, 0.1, 0], waypoints: [[1, 1, 2, 3, 0, 0, 0], [1.0000000001, 1, 2, 3, 0, 0, 0]], ",
     "target.waypoints[1][0]", "must increase"},
    {"velocity_mps: [0, 0.1, 0]", "waypoints: [[1, 1, 2, 3, 0, 0, 0]]", "target.velocity_mps", "missing"},
    {"position_m: [1, 2, 3]", "waypoints: [[1, 1, 2, 3, 0, 0, 0]]", "target.position_m", "missing"},
    {"velocity_mps: [0, 0, -1]", "velocity_mps: [0, 0, -1], waypoints: [[1, 1, 2, 3, 0, 0, 0], [2]]",
     "obstacles[1].waypoints[1]", "list of 7 numbers"},
    {"quaternion: [0, 1, 0, 0], ", "", "target.angular_velocity_radps", "needs a quaternion"},
    {"quaternion: [0, 1, 0, 0]", "quaternion: [0, 0, 0, 0]", "target.quaternion", "length 1"},
    {"quaternion: [0, 1, 0, 0]", "quaternion: [0, 1, 0]", "target.quaternion", "4 numbers"},
    {"id: 9", "id: 4", "obstacles[1].id", "twice"},
    {"id: 9", "id: -1", "obstacles[1].id", "from 0"},
    {"id: 9, ", "", "obstacles[1].id", "missing"},
    {"shape: box", "shape: cone", "obstacles[0].shape", "'cone'"},
    {"shape: box", "shape: sphere", "obstacles[0].radius_m", "missing"},
    {"radius_m: 0.1", "radius_m: 0", "obstacles[1].radius_m", "from 0.0001"},
    {"height_m: 0.2", "length_m: 0.2", "obstacles[2].height_m", "missing"},
    {"length_m: 0.5", "length_m: 0.5, edges_m: [1, 1, 1]", "obstacles[1].edges_m", "unknown key"},
    {"edges_m: [0.1, 0.2, 0.3]", "edges_m: [0.1, -0.2, 0.3]", "obstacles[0].edges_m[1]", "is -0.2"},
    {"  - {id: 4", "  - 7\n  - {id: 4", "obstacles[0]", "mapping"},
    {"obstacles:\n", "other: 1\nobstacles: ~\nthings:\n", "obstacles", "missing"},
    {"plant: {kind: servo", "sensing: ~\nplant: {kind: servo", "sensing.joint_noise_rad", "missing"},
    {"quaternion: [0, 1, 0, 0]", "quaternion: ~", "target.quaternion", "missing"},
    {"title: two", "grasp: [{held: [4]}]\ntitle: two", "grasp[0].at_s", "missing"},
    {"title: two", "grasp: [{at_s: 1, held: [5]}]\ntitle: two", "grasp[0].held", "there is no obstacle 5"},
    {"title: two", "grasp: [{at_s: 1, held: 4}]\ntitle: two", "grasp[0].held", "list"},
    {"title: two", "grasp: [{at_s: 1, allowed: [1.5]}]\ntitle: two", "grasp[0].allowed", "whole numbers"},
    {"title: two", "grasp: [{at_s: 2}, {at_s: 1}]\ntitle: two", "grasp[1].at_s", "must not decrease"},
    {"title: two", "people: [{id: 1, stature_m: 1.7}]\ntitle: two", "people[0].postures", "at least one"},
    {"title: two", "people: [{id: 1, postures: []}]\ntitle: two", "people[0].stature_m", "missing"},
    {"title: two", "people: [{id: 1, stature_m: 17}]\ntitle: two", "people[0].stature_m", "from 1 to 2.2"},
    {"title: two", "people: [{id: 1, stature_m: 1.7, postures: [{at_s: 0, position_m: [0, 0, 0]}]}]\ntitle: two",
     "people[0].postures[0].heading_rad", "missing"},
    {"title: two",
     "people: [{id: 1, stature_m: 1.7, postures: [{at_s: 1, position_m: [0, 0, 0], heading_rad: 0}, {at_s: 1}]}]\n"
     "title: two",
     "people[0].postures[1].at_s", "must increase"},
    {"title: two",
     "people: [{id: 1, stature_m: 1.7, postures: [{at_s: 1, position_m: [0, 0, 0], heading_rad: 0, hands: up}]}]\n"
     "title: two",
     "people[0].postures[0].hands", "'up'"},
    {"title: two",
     "people: [{id: 8, stature_m: 1.7, postures: [{at_s: 1, position_m: [0, 0, 0], heading_rad: 0}]}]\ntitle: two",
     "people[0].id", "9 is used twice"},
    {"clearance_min_m", "clearance", "expect.clearance", "unknown key"},
    {"axis_distance_m: 0.2", "axis_distance_m: far", "published.axis_distance_m", "finite number"},
    {"title: two", "? [a]\n: b\ntitle: two", "(not a text)", "unknown key"},
    {"title: two", "\"a\\nb\": 1\ntitle: two", "a?b", "unknown key"},
    {"config: firmware", "config: [x", "", "line"},
};

void every_mistake_is_refused_with_one_line_that_names_file_and_key(void**) {
  for (const Mistake& mistake : kMistakes) {
    const std::string text = changed(mistake.from, mistake.to);
    const std::string message = message_of([&] { load(text); });
    const std::string key = *mistake.key ? std::string(mistake.key) + ": " : "";
    check(one_line_with(message, {"a.yaml: " + key, mistake.complaint}), "'%s' -> '%s': %s", mistake.from, mistake.to,
          message.c_str());
  }
}

void files_that_are_no_scenario_are_refused_with_one_line(void**) {
  const std::string texts[] = {"",
                               "\n",
                               "just a text",
                               "[1, 2]",
                               "{",
                               "a: b: c",
                               "\t",
                               std::string(100'000, '['),
                               std::string("a\0b", 3),
                               "\xff\xfe",
                               "*alias",
                               "&a [*a]",
                               "rate_hz: 100\n---\nrate_hz: 200\n"};
  for (const std::string& text : texts) {
    const std::string message = message_of([&] { load(text); });
    check(one_line_with(message, {"a.yaml: "}), "%.20s: %s", text.c_str(), message.c_str());
  }
  assert_true(one_line_with(message_of([] { load_scenario("no/such.yaml"); }), {"no/such.yaml: cannot be read"}));
  assert_true(one_line_with(message_of([] { load_scenario("host"); }), {"host: "}));
}

/// In the scenario the base of the left arm is at x = -0.5 m, rotated by pi; the base of the right arm is at 0.5 m.
void each_of_several_arms_has_the_world_in_its_base_frame(void**) {
  const std::vector<Scenario> arms = load_scenario("host/scenarios/two-arms.yaml");
  assert_int_equal(arms.size(), 2);
  const Scenario &left = arms[0], &right = arms[1];
  assert_string_equal(left.arm.c_str(), "left");
  assert_string_equal(left.channels.arm_state.c_str(), "LEFT_ARM_STATE");
  assert_string_equal(right.channels.controller_status.c_str(), "RIGHT_CONTROLLER_STATUS");
  check_near(left.world.target->motion.position_m, Vector3d(-0.55, -0.35, 0.75), 1e-15);
  check_near(right.world.target->motion.position_m, Vector3d(-0.55, -0.35, 0.75), 1e-15);
  check_near(advanced(left.world, 3).target->motion.position_m, Vector3d(-0.55, 0.35, 0.75), 1e-15);
  check_near(left.world.obstacles[0].motion.velocity_mps, Vector3d(0, -0.2, 0), 1e-15);
  check_near(right.world.obstacles[0].motion.velocity_mps, Vector3d(0, 0.2, 0), 1e-15);
  const Vector3d axis = left.world.obstacles[1].motion.orientation * Vector3d::UnitZ();
  check_near(axis, Vector3d(-1, 0, 0), 1e-6);
}

void the_surroundings_of_the_configuration_are_part_of_the_world(void**) {
  const World world = load_scenario("host/scenarios/table.yaml").front().world;
  assert_int_equal(world.obstacles.size(), 2);
  assert_int_equal(world.surroundings.size(), 2);
  const Obstacle& wall = world.surroundings[1];
  assert_int_equal(wall.id, -3);
  assert_true(wall.solid.shape == Shape::kBox);
  check_near(wall.solid.size_m, Vector3d(0.05, 2.5, 2.0), 0);
  check_near(wall.motion.position_m, Vector3d(0.6, 0, 1.0), 0);
  assert_int_equal(world.all()[3].id, -3);
}

void what_a_scenario_lacks_comes_from_other_processes(void**) {
  const Scenario play = load_scenario("host/scenarios/play.yaml").front();
  assert_true(play.endless());
  check_near(play.duration_s(), 0, 0);
  assert_false(play.world.target.has_value());
  assert_true(play.world.obstacles_from_others && play.world.obstacles.empty());
  const Scenario whole = load(kGood);
  assert_false(whole.endless() || whole.world.obstacles_from_others);
  const Scenario empty = load_scenario("host/scenarios/paper-a.yaml").front();  // obstacles: []
  assert_false(empty.world.obstacles_from_others);
}

void the_default_rate_is_100_hz(void**) {
  assert_int_equal(load(changed("rate_hz: 200\n", "")).period_us, 10'000);
}

void the_urdf_is_searched_in_the_folders_above_the_scenario(void**) {
  const Scenario s = load_scenario("host/scenarios/paper-a.yaml").front();
  assert_true(std::filesystem::equivalent(s.robot.urdf_file, "urdf/lwa3.urdf"));
}

void the_scenarios_of_the_paper_have_its_values(void**) {
  const Scenario a = load_scenario("host/scenarios/paper-a.yaml").front(),
                 b = load_scenario("host/scenarios/paper-b.yaml").front(),
                 c = load_scenario("host/scenarios/paper-c.yaml").front();
  check_near(a.duration_s(), 2.3, 0);
  check_near(b.duration_s(), 8, 0);
  check_near(c.duration_s(), 2.8, 0);
  assert_int_equal(a.world.obstacles.size(), 0);
  check_near(a.world.target->motion.position_m, Vector3d(0, 0.15, 1), 0);
  check_near(a.world.target->motion.velocity_mps, Vector3d(0, 0.2, 0), 0);
  check_near(b.world.target->motion.position_m, Vector3d(0.4, 0.4, 0.8), 0);
  check_near(c.world.target->motion.velocity_mps, Vector3d(0.2, 0, 0), 0);
  for (const Scenario* s : {&b, &c}) {
    assert_int_equal(s->world.obstacles.size(), 3);
    check_near(s->world.obstacles[2].motion.position_m, Vector3d(-0.1, 0.1, 0.8), 0);
    check_near(s->world.obstacles[1].motion.velocity_mps, Vector3d(0, 0.2, 0), 0);
    check_near(s->world.obstacles[0].solid.size_m.x(), 0.05, 0);
  }
  for (const Scenario* s : {&a, &b, &c}) {
    assert_true(s->plant.kind == PlantSpec::Kind::kIdeal);
    check_near(s->start_rad[1], M_PI / 2, 0);
    check_near(s->start_rad[3], -M_PI / 2, 0);
    check_near(*s->expect.clearance_min_m, 0, 0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_value_of_a_scenario_is_read),
      cmocka_unit_test(the_documented_scenario_is_read),
      cmocka_unit_test(a_target_may_be_a_posture),
      cmocka_unit_test(waypoints_follow_the_position_and_velocity_at_the_start),
      cmocka_unit_test(the_parts_of_a_person_are_obstacles_that_move),
      cmocka_unit_test(every_mistake_is_refused_with_one_line_that_names_file_and_key),
      cmocka_unit_test(files_that_are_no_scenario_are_refused_with_one_line),
      cmocka_unit_test(each_of_several_arms_has_the_world_in_its_base_frame),
      cmocka_unit_test(the_surroundings_of_the_configuration_are_part_of_the_world),
      cmocka_unit_test(what_a_scenario_lacks_comes_from_other_processes),
      cmocka_unit_test(the_default_rate_is_100_hz),
      cmocka_unit_test(the_urdf_is_searched_in_the_folders_above_the_scenario),
      cmocka_unit_test(the_scenarios_of_the_paper_have_its_values),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
