#include <algorithm>
#include <memory>

#include "firmware/control/obstacle_memory.h"
#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::check_stream;
using test::ClosedLoop;
using test::Random;
using test::tracking;

namespace {

const char* const kLaws[] = {"paper", "sidestep"};

Vector3 tool_m(const ClosedLoop& loop) {
  return forward_kinematics(loop.model.arm, loop.arm.position_rad).tool_position;
}

/// Length of the joint path within one second beyond the net displacement, rad.
double oscillation_rad(ClosedLoop& loop) {
  double path_rad = 0.0;
  const JointVector before_rad = loop.arm.position_rad;
  for (int i = 0; i < 100; ++i) {
    loop.cycle();
    path_rad += loop.arm.velocity_radps.cwiseAbs().sum() * loop.model.settings.period_s();
  }
  return path_rad - (loop.arm.position_rad - before_rad).cwiseAbs().sum();
}

void an_unreachable_target_is_approached_as_far_as_the_arm_reaches(void**) {
  for (const char* law : kLaws) {
    for (const Vector3& target_m : {Vector3(3, 0, 0.5), Vector3(0, -900, 0.3), Vector3(0.7, 0.7, 3)}) {
      ClosedLoop loop = tracking(law);
      loop.target.position_m = target_m;
      loop.run(12.0);
      // The shoulder is 0.3 m above the base and the arm about 1 m long.
      const Vector3 shoulder_m(0, 0, 0.3);
      const double reached = (tool_m(loop) - shoulder_m).dot((target_m - shoulder_m).normalized());
      const double oscillating_rad = oscillation_rad(loop);
      print_message("%-8s (%g, %g, %g): %.3f m out, %.4f rad of oscillation in a second\n", law, target_m.x(),
                    target_m.y(), target_m.z(), reached, oscillating_rad);
      check_stream(loop);
      check(loop.mode() == Mode::kTrack, "%s", loop.last.report.message);
      if (loop.model.settings.law == Law::kPaper) continue;  // the paper does not treat targets out of reach
      check(reached > 0.7, "%g m", reached);
      check(oscillating_rad < 0.05, "%g rad", oscillating_rad);
    }
  }
}

void a_teleported_target_never_makes_the_commands_jump(void**) {
  for (const char* law : kLaws) {
    Random random(3);
    ClosedLoop loop = tracking(law);
    for (int i = 0; i < 200; ++i) {
      loop.target.position_m = random.inside(-1.5, 1.5);
      loop.target.velocity_mps = random.chance(0.5) ? random.inside(-3, 3) : Vector3(Vector3::Zero());
      loop.run(0.01 * (1 + random.index(30)));
    }
    check_stream(loop);
    loop.target.position_m = Vector3(-0.328, 0.15, 0.8);
    loop.target.velocity_mps.setZero();
    loop.run(15.0);
    check_stream(loop);
    check(loop.last.report.target_distance_m < 0.01, "%s: %g m left", law, loop.last.report.target_distance_m);
  }
}

/// A sphere overlaps a link at the start. Whatever the target, the distance grows as long as it is below the clearance
/// that obstacles at rest need, and above that shrinks by no more than hard_gain permits.
void in_contact_at_the_start_the_distance_only_grows(void**) {
  Random random(4);
  int scenes = 0;
  while (scenes < 20) {
    ClosedLoop loop = test::at_home("sidestep");
    const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
    const int s = random.index(static_cast<int>(loop.model.arm.shapes.size()));
    const LinkShape& shape = loop.model.arm.shapes[static_cast<size_t>(s)];
    if (shape.body < 3) continue;  // links near the base hardly move
    const Capsule link = transformed(poses, shape);
    const Vector3 aside = (link.radius_m + 0.03) * random.direction();
    loop.add_sphere(0.5 * (link.start + link.end) + aside, Vector3::Zero(), 0.05);
    loop.sends_target = true;
    assert_true(loop.run_until(Mode::kHold, 1.0));
    const double start_m = loop.last.report.clearance_m;
    if (start_m > 0.0) continue;
    ++scenes;
    double before_m = start_m, worst_m = 0.0;
    for (int i = 0; i < 300; ++i) {
      loop.cycle();
      const double clearance_m = loop.last.report.clearance_m;
      const ShieldSettings& shield = loop.model.settings.shield;
      const double room_m = std::max(0.0, before_m - shield.rest_clearance_m);
      const double permitted_m = shield.hard_gain_per_s * loop.model.settings.period_s() * room_m;
      worst_m = std::max(worst_m, before_m - clearance_m - permitted_m);
      before_m = clearance_m;
    }
    check_stream(loop);
    check(worst_m < 1e-4, "shape %d: the distance shrank by %g m too much in a cycle", s, worst_m);
    check(before_m > std::min(0.0, start_m), "shape %d: %g m at the start, %g m at the end", s, start_m, before_m);
  }
}

/// The position that the obstacle has left counts for timeouts.coast_s.
void an_obstacle_that_jumps_counts_at_both_positions(void**) {
  ClosedLoop loop = tracking("sidestep");
  const Timeouts timeouts;
  const auto obstacle_memory =
      std::make_unique<ObstacleMemory>(loop.model.settings.obstacle_speed_bound_mps, timeouts.coast_s);
  const auto send = [&](const Vector3& centre_m) {
    loop.obstacles->count = 0;
    loop.add_sphere(centre_m, Vector3::Zero(), 0.1);
    obstacle_memory->add_remembered(*loop.obstacles, loop.model.settings.period_s(), loop.now_s());
    loop.cycle();
    return loop.last.report.clearance_m;
  };
  const Vector3 near_m = tool_m(loop) + Vector3(-0.3, 0, 0), far_m(1.5, 1.5, 1.5);
  for (int i = 0; i < 5; ++i) send(near_m);
  assert_true(loop.last.report.clearance_m < 0.3);
  double counted_s = 0.0;
  while (send(far_m) < 0.4 && counted_s < 2.0) counted_s += loop.model.settings.period_s();
  check_near(counted_s, timeouts.coast_s, 0.011);
  assert_true(loop.last.report.clearance_m > 0.8);
  check_stream(loop);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_unreachable_target_is_approached_as_far_as_the_arm_reaches),
      cmocka_unit_test(a_teleported_target_never_makes_the_commands_jump),
      cmocka_unit_test(in_contact_at_the_start_the_distance_only_grows),
      cmocka_unit_test(an_obstacle_that_jumps_counts_at_both_positions),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
