#include "firmware/io/config/config.h"
#include "host/campaign/pilot.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/trial.h"
#include "tests/support/check.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

Outcome play(const char* family_name, uint64_t seed, bool foresees) {
  const Family& family = family_named(family_name);
  const Limits limits = lwa3_arm().limits(family);
  Model model = model_for(load_config("firmware/config/lwa3.yaml", {}).model, limits);
  model.settings.foresight.enabled = foresees;
  const std::unique_ptr<Pilot> pilot = make_pilot(&model, lwa3_arm(), limits);
  return run_trial(make_scene(family, seed), *pilot);
}

/// Scenes in which earlier versions of the shield dithered between two sides until it was too late, and one (the last)
/// in which foresight took a guide for two cycles because the straight future grazed an obstacle in one cycle of three.
void nothing_is_hit_where_it_once_was(void**) {
  const struct {
    const char* family;
    uint64_t seed;
  } scenes[] = {{"dodge@0.5", 1000318}, {"dodge@0.5", 1000520}, {"dodge@0.5", 1000937}, {"dodge@1", 1000705},
                {"dodge@1", 1000711},   {"erratic", 1000196},   {"dodge@1", 1000447}};
  for (const auto& scene : scenes) {
    for (const bool foresees : {false, true}) {
      const Outcome outcome = play(scene.family, scene.seed, foresees);
      check(outcome.clearance_m > 0.0, "%s:%lu, foresight %d: %g m", scene.family, scene.seed, foresees,
            outcome.clearance_m);
    }
  }
}

/// Scenes in which the law alone gets stuck or is pushed off the target.
void foresight_arrives_where_the_law_does_not(void**) {
  const uint64_t seeds[] = {3000038, 3000069, 3000100};
  for (const uint64_t seed : seeds) {
    const Outcome without = play("clutter", seed, false), with = play("clutter", seed, true);
    check(without.final_error_m > kArrived_m, "clutter:%lu needs no foresight", seed);
    check(with.final_error_m < kArrived_m, "clutter:%lu: %g m", seed, with.final_error_m);
    check(with.clearance_m > 0.0, "clutter:%lu: %g m", seed, with.clearance_m);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(nothing_is_hit_where_it_once_was),
      cmocka_unit_test(foresight_arrives_where_the_law_does_not),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
