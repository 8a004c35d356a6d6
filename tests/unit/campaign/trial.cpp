#include "host/campaign/trial.h"

#include "host/campaign/scene_maker.h"
#include "host/campaign/smoothness.h"
#include "host/campaign/statistics.h"
#include "tests/support/check.h"

using namespace sidestep::campaign;

namespace {

constexpr uint64_t kScenes = 10;

/// Moves along the witness, from the cycle `delay` on, and remembers what it saw.
class WitnessPilot : public Pilot {
 public:
  WitnessPilot(const Scene& scene, int delay) : scene_(scene), delay_(delay) {}

  Steering cycle(const Seen& seen) override {
    const int k = cycles_++ - delay_;
    target_ = seen.target;
    if (!seen.obstacles.spheres.empty()) sphere_ = seen.obstacles.spheres[0];
    Steering steering;
    steering.tracking = k >= 0;
    steering.velocity_radps = Joints::Zero(seen.q_rad.size());
    steering.message = "not yet";
    if (k >= 0) steering.velocity_radps = (witness_rad(scene_, (k + 1) * kPeriod_s) - seen.q_rad) / kPeriod_s;
    return steering;
  }

  int cycles() const { return cycles_; }
  const Moving& target() const { return target_; }
  const Moving& sphere() const { return sphere_; }

 private:
  const Scene& scene_;
  int delay_;
  int cycles_ = 0;
  Moving target_, sphere_;
};

/// Lets the arm stand.
class IdlePilot : public Pilot {
 public:
  Steering cycle(const Seen&) override {
    Steering steering;
    steering.tracking = true;
    steering.velocity_radps = Joints::Zero(7);
    return steering;
  }
};

bool success(const Scene& scene, const Outcome& outcome) {
  return succeeded({scene.family, "", scene.seed, outcome});
}

void the_witness_solves_every_scene(void**) {
  for (const Family& family : families()) {
    for (uint64_t seed = 0; !family.dodge && !family.real && seed < kScenes; ++seed) {
      const Scene scene = make_scene(family, seed);
      WitnessPilot pilot(scene, 0);
      const Outcome outcome = run_trial(scene, pilot);
      check(success(scene, outcome), "%s:%d", family.name.c_str(), static_cast<int>(seed));
      check(outcome.clearance_m >= 0.05 - 1e-9, "%g m", outcome.clearance_m);
      check_near(outcome.path_rad, outcome.witness_path_rad, 1e-6);
      if (!family.chase) check_near(outcome.arrival_s, outcome.witness_arrival_s, 1e-9);
      if (family.full_pose) check(outcome.turn_rms_rad < 1e-7, "%g rad", outcome.turn_rms_rad);
      if (family.chase) check(outcome.error_max_m < 1e-9 && outcome.on_target_share == 1.0, "%g", outcome.error_max_m);
      check(outcome.speed_radps <= 1.2 && outcome.acceleration_radps2 <= 10.0, "the witness keeps the limits");
      check(outcome.limit_margin_rad > 0.0, "%g rad", outcome.limit_margin_rad);
    }
  }
}

void plain_tracking_solves_none(void**) {
  for (const Family& family : families()) {
    for (uint64_t seed = 0; !family.dodge && !family.real && seed < kScenes; ++seed) {
      const Scene scene = make_scene(family, seed);
      if (scene.spheres.empty()) continue;
      const Outcome outcome = run_trial(scene, *make_pilot(nullptr, lwa3_arm(), lwa3_arm().limits(family)));
      check(outcome.clearance_m < 0.0, "%s:%d", family.name.c_str(), static_cast<int>(seed));
    }
  }
}

void an_arm_that_stands_is_hit_by_every_dodge(void**) {
  for (const Family& family : families()) {
    for (uint64_t seed = 0; family.dodge && seed < kScenes; ++seed) {
      const Scene scene = make_scene(family, seed);
      IdlePilot pilot;
      const Outcome outcome = run_trial(scene, pilot);
      check(outcome.clearance_m < -0.08, "%s:%d: %g m", family.name.c_str(), static_cast<int>(seed),
            outcome.clearance_m);
      check_near(outcome.error_rms_m, 0.0, 1e-12);
      check_near(outcome.turn_rms_rad, 0.0, 1e-7);
    }
  }
}

void the_world_waits_until_the_pilot_tracks(void**) {
  const Scene scene = make_scene(family_named("chase"), 4);
  WitnessPilot prompt(scene, 0), slow(scene, 123);
  const Outcome a = run_trial(scene, prompt), b = run_trial(scene, slow);
  check(slow.cycles() == prompt.cycles() + 123, "%d cycles", slow.cycles());
  check(a.clearance_m == b.clearance_m && a.error_max_m == b.error_max_m, "the same but for the waiting");
  check_near(slow.sphere().position_m, scene.spheres[0].at(scene.duration_s() - kPeriod_s).position_m, 1e-9);
  check_near(slow.target().position_m, target_at(scene, scene.duration_s() - kPeriod_s).position_m, 1e-9);
}

void a_pilot_that_never_tracks_is_named(void**) {
  const Scene scene = make_scene(family_named("moving"), 4);
  WitnessPilot never(scene, 1'000'000);
  check(sidestep::test::one_line_with(sidestep::test::message_of([&] { run_trial(scene, never); }), {"not yet"}),
        "the pilot's own words are told");
}

void only_a_controller_that_knows_the_benchmarks_world_is_let_in(void**) {
  const auto refusal = [](const char* config) {
    return sidestep::test::message_of([&] { judge_arm_of(sidestep::load_config(config, {})); });
  };
  check(refusal("firmware/config/lwa3.yaml").empty(), "%s", refusal("firmware/config/lwa3.yaml").c_str());
  const std::string table = refusal("firmware/config/table.yaml");
  check(sidestep::test::one_line_with(table, {"surroundings: "}), "%s", table.c_str());
}

/// With a lag of 30 ms the arm is behind a pilot that does not look at it by the lag times the speed.
class SpinPilot : public Pilot {
 public:
  Steering cycle(const Seen& seen) override {
    q_rad = seen.q_rad;
    Steering steering;
    steering.tracking = true;
    steering.velocity_radps = Joints::Zero(7);
    steering.velocity_radps[6] = 0.5;
    return steering;
  }
  Joints q_rad;
};

void the_real_arm_lags(void**) {
  for (const char* family : {"moving", "real"}) {
    const Scene scene = make_scene(family_named(family), 5);
    SpinPilot pilot;
    run_trial(scene, pilot);
    const double ideal_rad = scene.start_rad[6] + 0.5 * (scene.duration_s() - kPeriod_s);
    check_near(pilot.q_rad[6], ideal_rad - (scene.family->real ? 0.5 * 0.030 : 0.0), 1e-9);
  }
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
      cmocka_unit_test(plain_tracking_solves_none),
      cmocka_unit_test(an_arm_that_stands_is_hit_by_every_dodge),
      cmocka_unit_test(the_world_waits_until_the_pilot_tracks),
      cmocka_unit_test(a_pilot_that_never_tracks_is_named),
      cmocka_unit_test(only_a_controller_that_knows_the_benchmarks_world_is_let_in),
      cmocka_unit_test(the_real_arm_lags),
      cmocka_unit_test(smoothness_of_a_known_stream),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
