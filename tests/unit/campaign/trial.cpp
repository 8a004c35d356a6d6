#include "host/campaign/trial.h"

#include "host/campaign/scene_maker.h"
#include "host/campaign/smoothness.h"
#include "host/campaign/statistics.h"
#include "tests/support/check.h"
#include "tests/support/constant_controller.h"

using namespace sidestep::campaign;
using sidestep::test::ConstantController;

namespace {

constexpr uint64_t kScenes = 10;

/// Moves along the witness after `delay` cycles and stores its last inputs.
class WitnessController : public TrialController {
 public:
  WitnessController(const Scene& scene, int delay) : scene_(scene), delay_(delay) {}

  ControllerOutput cycle(const ControllerInput& input) override {
    const int k = cycles_++ - delay_;
    target_ = *input.target;
    if (!input.obstacles.obstacles.empty()) sphere_m_ = input.obstacles.obstacles[0].capsule.start;
    ControllerOutput output;
    output.ready = k >= 0;
    output.velocity_radps = Joints::Zero(input.q_rad.size());
    output.message = "waits for the delay";
    if (k >= 0) output.velocity_radps = (witness_rad(scene_, (k + 1) * kPeriod_s) - input.q_rad) / kPeriod_s;
    return output;
  }

  int cycles() const { return cycles_; }
  const PointMotion& target() const { return target_; }
  const sidestep::Vector3& sphere_m() const { return sphere_m_; }

 private:
  const Scene& scene_;
  int delay_;
  int cycles_ = 0;
  PointMotion target_;
  sidestep::Vector3 sphere_m_;
};

bool success(const Scene& scene, const TrialMetrics& metrics) {
  return succeeded({scene.family, "", scene.seed, metrics});
}

/// Whether the scenes have a witness (those among furniture: tests/unit/campaign/furniture) and exact obstacles.
bool has_exact_witness(const Family& family) {
  return !family.dodge && !family.real && !family.has_people() && !family.has_furniture() && !family.boxes;
}

void the_witness_solves_every_scene(void**) {
  for (const Family& family : families()) {
    for (uint64_t seed = 0; has_exact_witness(family) && seed < kScenes; ++seed) {
      const Scene scene = make_scene(family, seed);
      WitnessController controller(scene, 0);
      const TrialMetrics metrics = run_trial(scene, controller);
      check(success(scene, metrics), "%s:%d", family.name.c_str(), static_cast<int>(seed));
      check(metrics.clearance_m >= 0.05 - 1e-9, "%g m", metrics.clearance_m);
      check_near(metrics.path_rad, metrics.witness_path_rad, 1e-6);
      if (!family.chase) check_near(metrics.arrival_s, metrics.witness_arrival_s, 1e-9);
      if (family.full_pose) check(metrics.turn_rms_rad < 1e-7, "%g rad", metrics.turn_rms_rad);
      if (family.chase) check(metrics.error_max_m < 1e-9 && metrics.on_target_share == 1.0, "%g", metrics.error_max_m);
      check(metrics.speed_radps <= 1.2 && metrics.acceleration_radps2 <= 10.0, "the witness keeps the limits");
      check(metrics.limit_margin_rad > 0.0, "%g rad", metrics.limit_margin_rad);
    }
  }
}

void plain_tracking_touches_a_sphere_in_every_scene(void**) {
  for (const Family& family : families()) {
    for (uint64_t seed = 0; has_exact_witness(family) && seed < kScenes; ++seed) {
      const Scene scene = make_scene(family, seed);
      if (scene.spheres.empty()) continue;
      const TrialMetrics metrics = run_trial(scene, *make_controller(nullptr, lwa3_arm(), lwa3_arm().limits(family)));
      check(metrics.clearance_m < 0.0, "%s:%d", family.name.c_str(), static_cast<int>(seed));
    }
  }
}

void an_arm_at_rest_is_touched_in_every_dodge(void**) {
  for (const Family& family : families()) {
    for (uint64_t seed = 0; family.dodge && seed < kScenes; ++seed) {
      const Scene scene = make_scene(family, seed);
      ConstantController controller(Joints::Zero(7));
      const TrialMetrics metrics = run_trial(scene, controller);
      check(metrics.clearance_m < -0.08, "%s:%d: %g m", family.name.c_str(), static_cast<int>(seed),
            metrics.clearance_m);
      check_near(metrics.error_rms_m, 0.0, 1e-12);
      check_near(metrics.turn_rms_rad, 0.0, 1e-7);
    }
  }
}

void the_scene_is_frozen_until_the_controller_tracks(void**) {
  const Scene scene = make_scene(family_named("chase"), 4);
  WitnessController prompt(scene, 0), slow(scene, 123);
  const TrialMetrics a = run_trial(scene, prompt), b = run_trial(scene, slow);
  check(slow.cycles() == prompt.cycles() + 123, "%d cycles", slow.cycles());
  check(a.clearance_m == b.clearance_m && a.error_max_m == b.error_max_m, "the delay changed the result");
  check_near(slow.sphere_m(), scene.spheres[0].at(scene.duration_s() - kPeriod_s).position_m, 1e-9);
  check_near(slow.target().position_m, target_at(scene, scene.duration_s() - kPeriod_s).position_m, 1e-9);
}

void a_controller_that_never_tracks_is_an_error_with_its_message(void**) {
  const Scene scene = make_scene(family_named("moving"), 4);
  WitnessController never_tracking(scene, 1'000'000);
  check(sidestep::test::one_line_with(sidestep::test::message_of([&] { run_trial(scene, never_tracking); }),
                                      {"waits for the delay"}),
        "the message of the controller is missing");
}

void a_configuration_with_surroundings_is_rejected(void**) {
  const auto refusal = [](const char* config) {
    return sidestep::test::message_of([&] { judge_arm_of(sidestep::load_config(config, {})); });
  };
  check(refusal("firmware/config/lwa3.yaml").empty(), "%s", refusal("firmware/config/lwa3.yaml").c_str());
  const std::string table = refusal("firmware/config/table.yaml");
  check(sidestep::test::one_line_with(table, {"surroundings: "}), "%s", table.c_str());
}

/// Commands a constant velocity. An arm with a lag of 30 ms is then behind by the lag times the velocity.
class SpinController : public TrialController {
 public:
  ControllerOutput cycle(const ControllerInput& input) override {
    q_rad = input.q_rad;
    ControllerOutput output;
    output.ready = true;
    output.velocity_radps = Joints::Zero(7);
    output.velocity_radps[6] = 0.5;
    return output;
  }
  Joints q_rad;
};

void the_arm_of_the_family_real_lags(void**) {
  for (const char* family : {"moving", "real"}) {
    const Scene scene = make_scene(family_named(family), 5);
    SpinController controller;
    run_trial(scene, controller);
    const double ideal_rad = scene.start_rad[6] + 0.5 * (scene.duration_s() - kPeriod_s);
    check_near(controller.q_rad[6], ideal_rad - (scene.family->real ? 0.5 * 0.030 : 0.0), 1e-9);
  }
}

/// Folds the hand to the upper arm, in 2 s.
class FoldController : public TrialController {
 public:
  ControllerOutput cycle(const ControllerInput& input) override {
    Joints folded_rad = Joints::Zero(7);
    folded_rad[3] = folded_rad[5] = 1.97;
    ControllerOutput output;
    output.ready = true;
    output.velocity_radps = (folded_rad - input.q_rad).cwiseMax(-2.0).cwiseMin(2.0);
    return output;
  }
};

void an_arm_that_touches_itself_has_a_contact(void**) {
  Scene scene = make_scene(family_named("moving"), 5);
  scene.spheres.clear();
  FoldController fold;
  ConstantController idle(Joints::Zero(7));
  const TrialMetrics folded = run_trial(scene, fold), at_rest = run_trial(scene, idle);
  check(folded.self_clearance_m < 0.0, "%g m", folded.self_clearance_m);
  check(at_rest.self_clearance_m > 0.0, "%g m", at_rest.self_clearance_m);
  assert_true(touched({scene.family, "", scene.seed, folded}));
  assert_false(touched({scene.family, "", scene.seed, at_rest}));
}

void smoothness_of_a_known_stream(void**) {
  Smoothness smoothness(Joints::Zero(7));
  Joints velocity = Joints::Zero(7);
  for (int k = 0; k < 100; ++k) {
    velocity[2] = k % 2 == 0 ? 0.02 : 0.0;  // +2 and -2 rad/s2 in turn
    smoothness.add(velocity, k >= 50);
  }
  check_near(smoothness.speed_radps(), 0.02, 1e-15);
  check_near(smoothness.acceleration_radps2(), 2.0, 1e-12);
  check_near(smoothness.jerk_radps3(), 400.0, 1e-9);
  check_near(smoothness.chatter_per_s(), 100.0 / 7, 1e-9);  // one of seven joints, every period
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_witness_solves_every_scene),
      cmocka_unit_test(plain_tracking_touches_a_sphere_in_every_scene),
      cmocka_unit_test(an_arm_at_rest_is_touched_in_every_dodge),
      cmocka_unit_test(the_scene_is_frozen_until_the_controller_tracks),
      cmocka_unit_test(a_controller_that_never_tracks_is_an_error_with_its_message),
      cmocka_unit_test(a_configuration_with_surroundings_is_rejected),
      cmocka_unit_test(the_arm_of_the_family_real_lags),
      cmocka_unit_test(an_arm_that_touches_itself_has_a_contact),
      cmocka_unit_test(smoothness_of_a_known_stream),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
