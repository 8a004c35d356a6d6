// An arm whose tool holds something, in closed loop.

#include <algorithm>

#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/fcl_distance.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

Eigen::Isometry3d tool_pose(const ClosedLoop& loop) {
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = poses.tool_rotation;
  pose.translation() = poses.tool_position;
  return pose;
}

/// FCL's least distance of what is held to the obstacles, m.
double held_clearance_m(const ClosedLoop& loop, const std::vector<Obstacle>& held) {
  double least_m = HUGE_VAL;
  for (const Obstacle& shape : held)
    for (int i = 0; i < loop.obstacles->count; ++i)
      least_m = std::min(least_m, test::fcl_distance_m(transformed(tool_pose(loop), shape),
                                                       loop.obstacles->obstacles[static_cast<size_t>(i)]));
  return least_m;
}

Obstacle rod() {
  return capsule_obstacle({0.15, 0, 0.05}, Eigen::AngleAxisd(M_PI / 2, Vector3::UnitY()).toRotationMatrix(), 0.03,
                          0.25);
}

/// Slow balls fly at the rod from random sides. Returns the least clearance of the rod.
double least_under_fire_m(bool is_reported, unsigned seed, std::string& violation) {
  ClosedLoop loop = test::at_home("sidestep");
  loop.sends_target = true;
  loop.target.position_m = tool_pose(loop).translation();
  loop.run(1.5);
  if (is_reported) loop.hold({rod()});
  Random random(seed);
  const Vector3 rod_m = tool_pose(loop) * rod().capsule.centre();
  const Vector3 side = random.direction();
  loop.add_sphere(rod_m + 0.8 * side, -0.3 * side);
  double least_m = HUGE_VAL;
  for (int i = 0; i < 500; ++i) {
    loop.cycle();
    least_m = std::min(least_m, held_clearance_m(loop, {rod()}));
  }
  violation = loop.commands.violation();
  return least_m;
}

void what_the_tool_holds_is_kept_clear_like_a_link(void**) {
  constexpr int kRuns = 40;
  int touched = 0, touched_unreported = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::string violation;
    touched += least_under_fire_m(true, static_cast<unsigned>(run), violation) < 0.0;
    check(violation.empty(), "run %d: %s", run, violation.c_str());
    touched_unreported += least_under_fire_m(false, static_cast<unsigned>(run), violation) < 0.0;
  }
  print_message("%d and, not reported, %d of %d rods touched\n", touched, touched_unreported, kRuns);
  assert_int_equal(touched, 0);
  check(touched_unreported > kRuns / 2, "%d", touched_unreported);
}

/// A ball at rest that the target lies in.
ClosedLoop with_ball_at_the_target() {
  ClosedLoop loop = test::at_home("sidestep");
  loop.add_sphere(loop.target.position_m, Vector3::Zero(), 0.04);
  loop.sends_target = true;
  return loop;
}

void the_tool_reaches_an_allowed_obstacle_and_no_other(void**) {
  ClosedLoop refused = with_ball_at_the_target(), allowed = with_ball_at_the_target();
  allowed.attachments.allowed.add(0);
  allowed.sends_attachments = true;
  refused.run(5.0);
  allowed.run(5.0);
  test::check_stream(refused);
  test::check_stream(allowed);
  check(refused.last.report.target_distance_m > 0.04, "%g m", refused.last.report.target_distance_m);
  check(allowed.last.report.target_distance_m < 1e-3, "%g m", allowed.last.report.target_distance_m);
}

/// Attachments come and go at random moments while balls fly; some appear right at an obstacle, or around a link.
void commands_are_continuous_whatever_is_attached_or_taken_off(void**) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    ClosedLoop loop = test::tracking("sidestep");
    for (int i = 0; i < 4; ++i)
      loop.add_sphere({random.uniform(-0.6, 0.2), random.uniform(-0.5, 0.5), random.uniform(0.5, 1.1)},
                      random.inside(-0.2, 0.2));
    for (int change = 0; change < 30; ++change) {
      std::vector<Obstacle> shapes;
      for (int i = random.index(4); i > 0; --i)
        shapes.push_back(box_obstacle(random.inside(-0.4, 0.4), Matrix3::Identity(), {0.1, 0.2, 0.05}));
      loop.hold(shapes);
      loop.attachments.allowed.clear();
      if (random.chance(0.5)) loop.attachments.allowed.add(random.index(4));
      loop.run(random.uniform(0.05, 0.5));
    }
    test::check_stream(loop);
  }
}

/// A pole that reaches back beside the forearm, and targets for which the wrist would bend it into the arm.
void what_the_tool_holds_does_not_touch_the_other_links(void**) {
  const Matrix3 along_forearm = Eigen::AngleAxisd(M_PI / 2, Vector3::UnitY()).toRotationMatrix();
  const Obstacle pole = capsule_obstacle({0.3, 0.12, 0}, along_forearm, 0.02, 0.8);
  int met = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    double least_m[2] = {HUGE_VAL, HUGE_VAL};
    for (const bool is_reported : {false, true}) {
      Random random(seed);
      ClosedLoop loop = test::at_home("sidestep");
      if (is_reported) loop.hold({pole});
      loop.sends_target = true;
      loop.target.position_m = {random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(0.3, 1.0)};
      for (int i = 0; i < 400; ++i) {
        loop.cycle();
        const Obstacle held = transformed(tool_pose(loop), pole);
        const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
        for (const LinkShape& shape : loop.model.arm.shapes)
          if (shape.body < 6)
            least_m[is_reported] =
                std::min(least_m[is_reported], test::fcl_distance_m(held, transformed(poses, shape)));
      }
      test::check_stream(loop);
    }
    met += least_m[0] < 0.0;
    check(least_m[1] > 0.0, "seed %u: %g m, not reported %g m", seed, least_m[1], least_m[0]);
  }
  print_message("not reported, %d of 20 poles touch a link\n", met);
  check(met >= 3, "%d", met);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(what_the_tool_holds_is_kept_clear_like_a_link),
      cmocka_unit_test(the_tool_reaches_an_allowed_obstacle_and_no_other),
      cmocka_unit_test(commands_are_continuous_whatever_is_attached_or_taken_off),
      cmocka_unit_test(what_the_tool_holds_does_not_touch_the_other_links),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
