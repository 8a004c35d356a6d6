#include "host/campaign/people/way_out.h"

#include "host/campaign/people/people_judge.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/trial.h"
#include "host/people/body.h"
#include "tests/support/check.h"
#include "tests/support/constant_controller.h"

using namespace sidestep;
using namespace sidestep::campaign;
using sidestep::test::ConstantController;

namespace {

/// The LWA3 stretched upward, and one capsule along y that is at x_m(t) or, if wide, a wall of such capsules as high as
/// the arm reaches; t = 0 to 4 s.
template <typename Path>
Scene met_by(const Path& x_m, bool wide) {
  Scene scene{};
  scene.family = &family_named("walk-by");
  scene.arm = &lwa3_arm();
  scene.periods = 400;
  scene.start_rad = scene.goal_rad = Joints::Zero(7);
  for (double z_m = wide ? 0.6 : 0.9; z_m <= (wide ? 2.2 : 0.9); z_m += 0.1) {
    std::vector<CapsulePath::Ends> samples;
    for (int k = 0; k <= 400; ++k) {
      const double half_m = wide ? 3.0 : 0.2, x = x_m(k * kPeriod_s);
      samples.push_back({{x, -half_m, z_m}, {x, half_m, z_m}});
    }
    scene.capsules.emplace_back(0.05, kPeriod_s, samples);
  }
  return scene;
}

/// It comes from x = 1.5 m and stops at the arm's axis.
Scene approached(double arrival_s, bool wide) {
  return met_by([=](double t_s) { return 1.5 * std::max(0.0, 1.0 - t_s / arrival_s); }, wide);
}

/// It passes the arm's axis from positive x on in the middle of a period, at whose beginning and end it is 25 mm clear.
Scene passed(int period, bool wide) {
  return met_by([=](double t_s) { return 25.0 * ((period - 0.5) * kPeriod_s - t_s); }, wide);
}

/// A person all of whose parts are one capsule that moves on this path.
template <typename Path>
Scene person_on(const Path& x_m, const char* family) {
  Scene scene = met_by(x_m, false);
  scene.family = &family_named(family);
  scene.capsules.resize(kBodyParts, scene.capsules.front());
  return scene;
}

/// It rests at x = 1 m for 2 s, then comes to the arm's axis in this time.
Scene struck(double stroke_s, const char* family) {
  return person_on([=](double t_s) { return 1.0 - std::clamp((t_s - 2.0) / stroke_s, 0.0, 1.0); }, family);
}

ArmInstant at_rest(const Scene& scene, int period) {
  return {period, scene.start_rad, Joints::Zero(7)};
}

void an_arm_gets_out_of_the_way_of_a_slow_capsule(void**) {
  const Scene scene = approached(3.0, false);
  check(clearance_at_rest(scene) < -0.09, "%g m", clearance_at_rest(scene));
  assert_true(has_way_out(scene, at_rest(scene, 0)));
}

void no_arm_gets_out_of_the_way_of_what_is_faster(void**) {
  const Scene scene = approached(0.05, false);
  assert_false(has_way_out(scene, at_rest(scene, 0)));
}

void it_depends_on_when_the_arm_begins(void**) {
  const Scene scene = approached(3.0, false);
  assert_true(has_way_out(scene, at_rest(scene, 150)));
  assert_false(has_way_out(scene, at_rest(scene, 278)));
}

void it_depends_on_the_velocity_of_the_arm(void**) {
  const Scene scene = approached(3.0, false);
  ArmInstant toward = at_rest(scene, 220);
  toward.q_rad[1] = -0.2;  // leans toward the capsule, and moves on
  toward.qd_radps[1] = -2.0;
  ArmInstant away = at_rest(scene, 220);
  away.q_rad[1] = 0.4;
  away.qd_radps[1] = 2.0;
  assert_true(has_way_out(scene, away));
  assert_false(has_way_out(scene, {274, toward.q_rad, toward.qd_radps}));
}

void a_wall_that_stops_at_the_arm_can_be_fled_only_backward(void**) {
  assert_true(has_way_out(approached(3.0, true), at_rest(approached(3.0, true), 0)));
}

void an_arm_that_moves_into_a_person_is_judged_worse_than_one_at_rest(void**) {
  Scene scene = approached(3.0, false);
  scene.capsules = {CapsulePath(0.05, 5.0, {{{0.4, -0.2, 0.9}, {0.4, 0.2, 0.9}}, {{0.4, -0.2, 0.9}, {0.4, 0.2, 0.9}}})};
  ConstantController toward(-0.3 * Joints::Unit(7, 1)), idle(Joints::Zero(7));  // the second joint swings
  const TrialMetrics moved = run_trial(scene, toward), rested = run_trial(scene, idle);
  check_near(rested.clearance_m, 0.3, 1e-9);
  check_near(rested.rest_clearance_m, rested.clearance_m, 1e-9);
  check(std::isnan(rested.closing_mps) && std::isnan(rested.seen_way_out) && rested.way_out == 1.0, "no contact");
  check(moved.clearance_m < -0.05 && moved.rest_clearance_m > 0.29, "%g m", moved.clearance_m);
  check_near(moved.closing_mps, 0.3 * 0.7, 0.05);  // the lever of the second joint to the contact
  check(moved.way_out == 1.0 && moved.seen_way_out == 1.0, "the arm could have stopped");
}

void what_passes_between_two_periods_is_judged_when_it_passes(void**) {
  ConstantController idle(Joints::Zero(7)), toward(0.3 * Joints::Unit(7, 1));
  const TrialMetrics rested = run_trial(passed(40, true), idle);
  check(rested.clearance_m < -0.07, "%g m", rested.clearance_m);
  check(rested.closing_mps == 0.0, "%g m/s", rested.closing_mps);
  check(rested.seen_way_out == 0.0, "a way out after the wall has passed");
  const TrialMetrics moved = run_trial(passed(20, false), toward);
  check(moved.clearance_m < -0.07, "%g m", moved.clearance_m);
  check_near(moved.closing_mps, 0.3 * 0.6, 0.02);  // the lever of the second joint to the contact
}

void an_arm_at_rest_and_ways_out_are_judged_at_the_instants_of_a_trial(void**) {
  ConstantController idle(Joints::Zero(7));
  for (const Scene& scene : {passed(20, true), passed(20, false), approached(3.0, false)}) {
    const TrialMetrics rested = run_trial(scene, idle);
    check(rested.clearance_m < -0.07, "%g m", rested.clearance_m);
    check_near(clearance_at_rest(scene), rested.clearance_m, 0.0);
  }
  assert_false(has_way_out(passed(20, true), at_rest(passed(20, true), 0)));
}

/// The arm has time from the start, but a stroke is too fast when it is seen.
void a_way_out_when_seen_begins_with_the_approach(void**) {
  ConstantController idle(Joints::Zero(7));
  const auto judged = [&](const Scene& scene) {
    const TrialMetrics metrics = run_trial(scene, idle);
    check(metrics.clearance_m < -0.05 && metrics.way_out == 1.0, "%g m", metrics.clearance_m);
    return metrics.seen_way_out == 1.0;
  };
  for (const char* family : {"walk-by", "walk-by@camera"}) {
    assert_true(judged(struck(1.0, family)));
    assert_true(judged(person_on([](double t_s) { return std::max(0.0, 1.0 - 0.3 * t_s); }, family)));  // slowly
    assert_false(judged(struck(0.1, family)));
  }
  int seen_exactly = 0, seen_by_camera = 0;
  for (int i = 0; i < 20; ++i) {
    const double stroke_s = 0.1 + 0.02 * i;
    const bool exactly = judged(struck(stroke_s, "walk-by")), by_camera = judged(struck(stroke_s, "walk-by@camera"));
    check(exactly || !by_camera, "%g s", stroke_s);
    seen_exactly += exactly;
    seen_by_camera += by_camera;
  }
  check(seen_by_camera + 2 <= seen_exactly, "in time: %d by a camera, %d exactly", seen_by_camera, seen_exactly);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_arm_gets_out_of_the_way_of_a_slow_capsule),
      cmocka_unit_test(no_arm_gets_out_of_the_way_of_what_is_faster),
      cmocka_unit_test(it_depends_on_when_the_arm_begins),
      cmocka_unit_test(it_depends_on_the_velocity_of_the_arm),
      cmocka_unit_test(a_wall_that_stops_at_the_arm_can_be_fled_only_backward),
      cmocka_unit_test(an_arm_that_moves_into_a_person_is_judged_worse_than_one_at_rest),
      cmocka_unit_test(what_passes_between_two_periods_is_judged_when_it_passes),
      cmocka_unit_test(an_arm_at_rest_and_ways_out_are_judged_at_the_instants_of_a_trial),
      cmocka_unit_test(a_way_out_when_seen_begins_with_the_approach),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
