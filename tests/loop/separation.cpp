// The separation from persons, in closed loop.

#include <algorithm>

#include "firmware/foresight/person_proximity.h"
#include "tests/support/check.h"
#include "tests/support/foresight_loop.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

constexpr double kAway_m = 0.35;  // of the obstacle from the tool at the start

/// The tool is at its target. A sphere rests beside it.
ClosedLoop beside(Kind kind, bool tracks = true) {
  ClosedLoop loop = test::at_home("sidestep");
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  loop.target.position_m = poses.tool_position;
  loop.sends_target = tracks;
  const Vector3 outward(poses.tool_position.x(), poses.tool_position.y(), 0.0);
  loop.add_sphere(poses.tool_position + kAway_m * outward.normalized(), Vector3::Zero()).kind = kind;
  return loop;
}

void the_arm_makes_room_for_a_person_and_not_for_a_thing(void**) {
  ClosedLoop thing = beside(Kind::kThing), person = beside(Kind::kPerson);
  thing.run(6.0);
  person.run(6.0);
  const double thing_m = thing.last.report.clearance_m, person_m = person.last.report.clearance_m;
  check(person_m > thing_m + 0.05, "%g m from a thing, %g m from a person", thing_m, person_m);
  check(thing.last.report.target_distance_m < 1e-3, "%g m", thing.last.report.target_distance_m);
  assert_string_equal(person.commands.violation().c_str(), "");
}

/// S = person_clearance + v / person_gain, v at most 1 m/s. Until then the shield does not correct the law.
void the_arm_gives_way_from_the_protective_distance_on(void**) {
  for (const double speed_mps : {0.2, 0.5, 1.0, 2.0}) {
    ClosedLoop loop = beside(Kind::kPerson);
    Obstacle& person = loop.obstacles->obstacles[0];
    const Vector3 outward = (person.capsule.start - loop.target.position_m).normalized();
    person.capsule.start = person.capsule.end = loop.target.position_m + 2.5 * outward;
    loop.run(3.0);
    person.velocity_mps = -speed_mps * outward;
    while (loop.now_s() < 30.0 && loop.last.report.shield_correction_radps < 0.005) loop.cycle();
    const ShieldSettings& shield = loop.model.settings.shield;
    const double protective_m = shield.person_clearance_m + std::min(speed_mps, 1.0) / shield.person_gain_per_s;
    const double period_m = speed_mps * loop.model.settings.period_s();
    check_near_because(loop.last.report.clearance_m, protective_m, 0.01 + 2.0 * period_m, "%g m/s", speed_mps);
  }
}

/// The joints change places in the null space of the task for a while, slowly.
void an_arm_beside_a_person_who_rests_comes_to_rest_without_trembling(void**) {
  ClosedLoop loop = beside(Kind::kPerson);
  loop.run(10.0);
  double largest_change_radps = 0.0;
  for (JointVector last_radps = loop.last.command.velocity_radps; loop.now_s() < 50.0;) {
    loop.cycle();
    const JointVector& now_radps = loop.last.command.velocity_radps;
    largest_change_radps = std::max(largest_change_radps, (now_radps - last_radps).cwiseAbs().maxCoeff());
    last_radps = now_radps;
  }
  check(largest_change_radps < 0.002, "the velocity changes by %g rad/s in a cycle", largest_change_radps);
  const double largest_radps = loop.last.command.velocity_radps.cwiseAbs().maxCoeff();
  check(largest_radps < 0.02, "%g rad/s", largest_radps);
}

void the_target_is_reached_when_the_person_has_left(void**) {
  ClosedLoop loop = beside(Kind::kPerson);
  loop.run(6.0);
  check(loop.last.report.target_distance_m > 0.02, "%g m", loop.last.report.target_distance_m);
  loop.obstacles->count = 0;
  loop.run(4.0);
  check(loop.last.report.target_distance_m < 1e-3, "%g m", loop.last.report.target_distance_m);
}

/// The tool is at its target, 0.3 m from a person on either side, who stand there.
test::ForesightLoop between_two_persons(bool foresight) {
  const Vector3 tool_m = forward_kinematics(test::lwa3(), test::home_rad()).tool_position;
  test::ForesightLoop world(test::point_target(tool_m), test::home_rad(), "sidestep", foresight);
  const Vector3 aside(-tool_m.y(), tool_m.x(), 0.0);
  for (const double side : {-1.0, 1.0}) {
    const Vector3 centre_m = tool_m + side * 0.45 * aside.normalized();
    Obstacle& person = world.loop.add_sphere(centre_m, Vector3::Zero(), 0.15);
    person = capsule_obstacle(Vector3(centre_m.x(), centre_m.y(), 0.3), Matrix3::Identity(), 0.15, 1.2);
    person.kind = Kind::kPerson;
  }
  return world;
}

double proximity(const test::ForesightLoop& world) {
  const LinkPoses poses = forward_kinematics(world.loop.model.arm, world.loop.arm.position_rad);
  return person_proximity(poses, world.loop.obstacles->obstacles.data(), world.loop.obstacles->count);
}

void between_two_persons_the_arm_retreats_farther_than_the_shield_alone(void**) {
  test::ForesightLoop world = between_two_persons(true), alone = between_two_persons(false);
  world.run(6.0);
  alone.run(6.0);
  check(proximity(world) < 0.6 * proximity(alone), "%g, %g without foresight", proximity(world), proximity(alone));
  test::check_stream(world.loop);
  world.run(14.0);
  double largest_radps = 0.0;
  for (int i = 0; i < 1000; ++i) {
    world.cycle();
    largest_radps = std::max(largest_radps, world.loop.last.command.velocity_radps.cwiseAbs().maxCoeff());
  }
  check(largest_radps < 0.02, "%g rad/s", largest_radps);
}

void from_a_retreat_the_arm_returns_when_the_persons_have_left(void**) {
  test::ForesightLoop world = between_two_persons(true);
  world.run(6.0);
  check(world.error_m() > 0.1, "%g m", world.error_m());
  world.loop.obstacles->count = 0;
  world.run(5.0);
  check(world.error_m() < 1e-3, "%g m", world.error_m());
  test::check_stream(world.loop);
}

/// The way of the arm, rad, along a guide that turns it past a person who stands 0.3 m outward of the tool's way.
double way_past_a_person_rad(ForesightStatus status) {
  constexpr double kTurn_rad = 1.2, kDuration_s = 1.5;
  test::ForesightLoop world(test::point_target(Vector3(0.4, 0.3, 0.8)), test::home_rad(), "sidestep", false);
  JointVector half_rad = test::home_rad(), end_rad = half_rad;
  half_rad[0] += 0.5 * kTurn_rad;
  end_rad[0] += kTurn_rad;
  const Vector3 passes_m = forward_kinematics(test::lwa3(), half_rad).tool_position;
  const Vector3 outward(passes_m.x(), passes_m.y(), 0.0);
  world.loop.add_sphere(passes_m + 0.4 * outward.normalized(), Vector3::Zero(), 0.1).kind = Kind::kPerson;
  world.run(0.5);
  Guide guide;
  guide.foresight_status = status;
  guide.add(world.loop.now_s(), world.loop.arm.position_rad);
  guide.add(world.loop.now_s() + kDuration_s, end_rad);
  world.guide = &guide;
  world.run(kDuration_s);
  test::check_stream(world.loop);
  check(world.least_m > 0.1, "%g m", world.least_m);
  return world.loop.arm.position_rad[0] - test::home_rad()[0];
}

void a_retreat_leads_past_a_person_of_whom_other_guides_keep_clear(void**) {
  const double retreat_rad = way_past_a_person_rad(ForesightStatus::kWaiting);
  const double other_rad = way_past_a_person_rad(ForesightStatus::kGuided);
  check(retreat_rad > 1.15, "%g rad", retreat_rad);
  check(retreat_rad > other_rad + 0.4, "a retreat turns by %g rad, another guide by %g rad", retreat_rad, other_rad);
}

void in_hold_a_person_does_not_drive_the_arm_away(void**) {
  ClosedLoop loop = beside(Kind::kPerson, false);
  const JointVector start_rad = loop.arm.position_rad;
  loop.run(6.0);
  assert_true(loop.last.report.mode == Mode::kHold);
  const double moved_rad = (loop.arm.position_rad - start_rad).cwiseAbs().maxCoeff();
  check(moved_rad < 0.01, "%g rad", moved_rad);
}

void without_its_weight_there_is_no_separation(void**) {
  ClosedLoop loop = beside(Kind::kPerson);
  loop.model.settings.shield.person_weight = 0.0;
  loop.run(6.0);
  check(loop.last.report.target_distance_m < 1e-3, "%g m", loop.last.report.target_distance_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_arm_makes_room_for_a_person_and_not_for_a_thing),
      cmocka_unit_test(the_arm_gives_way_from_the_protective_distance_on),
      cmocka_unit_test(an_arm_beside_a_person_who_rests_comes_to_rest_without_trembling),
      cmocka_unit_test(the_target_is_reached_when_the_person_has_left),
      cmocka_unit_test(between_two_persons_the_arm_retreats_farther_than_the_shield_alone),
      cmocka_unit_test(from_a_retreat_the_arm_returns_when_the_persons_have_left),
      cmocka_unit_test(a_retreat_leads_past_a_person_of_whom_other_guides_keep_clear),
      cmocka_unit_test(in_hold_a_person_does_not_drive_the_arm_away),
      cmocka_unit_test(without_its_weight_there_is_no_separation),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
