#include "host/campaign/search/search_trial.h"

#include "firmware/io/config/config.h"
#include "host/campaign/search/search_scene_maker.h"
#include "host/campaign/search/witness_path.h"
#include "tests/support/check.h"

using namespace sidestep::campaign;

namespace {

/// Follows a path after `delay` cycles and stores its last inputs.
class PathController : public TrialController {
 public:
  PathController(const WitnessPath& path, int delay) : path_(path), delay_(delay) {}

  ControllerOutput cycle(const ControllerInput& input) override {
    const int k = cycles++ - delay_;
    had_target = input.target != nullptr;
    obstacles = input.obstacles.obstacles;
    ControllerOutput output;
    output.ready = k >= 0;
    output.velocity_radps = Joints::Zero(7);
    output.message = "waits for the delay";
    if (k >= 0) output.velocity_radps = (path_.at((k + 1) * 0.01) - input.q_rad) / 0.01;
    return output;
  }

  int cycles = 0;
  bool had_target = false;
  std::vector<sidestep::Obstacle> obstacles;

 private:
  const WitnessPath& path_;
  int delay_;
};

SearchScene scene_of(SearchFamily family) {
  Random random("test", 3);
  return draw_search_scene(random,
                           {family, 3, 0.5, sidestep::load_config("firmware/config/lwa3.yaml", {}).model.arm.limits});
}

void the_judge_measures_the_path_that_the_controller_follows(void**) {
  const SearchScene scene = scene_of(SearchFamily::kRest);
  Joints knot_rad = scene.start_rad;
  knot_rad[0] += 1.0;
  for (const WitnessPath& path :
       {WitnessPath{scene.start_rad, {}}, WitnessPath{scene.start_rad, {{0.5, 1.5, knot_rad}}}}) {
    PathController controller(path, 0);
    const ClosestApproach closest = run_search_trial(scene, controller);
    check_near(closest.clearance_m, path_clearance_m(scene, path, 0.002), 1e-4);
    const ArmPose pose = lwa3_arm().pose(path.at(closest.t_s));
    check_near(clearance_m(scene, pose, closest.t_s), closest.clearance_m, 1e-4);
  }
}

void the_scene_is_frozen_until_the_controller_is_ready(void**) {
  const SearchScene scene = scene_of(SearchFamily::kRest);
  const WitnessPath rest{scene.start_rad, {}};
  PathController prompt(rest, 0), slow(rest, 40);
  const ClosestApproach a = run_search_trial(scene, prompt), b = run_search_trial(scene, slow);
  check(slow.cycles == prompt.cycles + 40 && prompt.cycles == scene.periods(), "%d cycles", slow.cycles);
  check(a.clearance_m == b.clearance_m && a.t_s == b.t_s, "the delay changed the result");
  PathController never(rest, 1'000'000);
  const std::string message = sidestep::test::message_of([&] { run_search_trial(scene, never); });
  check(sidestep::test::one_line_with(message, {"waits for the delay"}), "%s", message.c_str());
}

void the_controller_gets_the_exact_obstacles_and_only_in_track_a_target(void**) {
  for (const SearchFamily family : {SearchFamily::kRest, SearchFamily::kTrack}) {
    const SearchScene scene = scene_of(family);
    const WitnessPath rest{scene.start_rad, {}};
    PathController controller(rest, 0);
    run_search_trial(scene, controller);
    check(controller.had_target == (family == SearchFamily::kTrack), "target %d", controller.had_target);
    check(controller.obstacles.size() == 3, "%zu obstacles", controller.obstacles.size());
    for (size_t i = 0; i < 3; ++i) {
      const sidestep::Capsule truth = scene.obstacles[i].at(scene.duration_s() - 0.01);
      check_near(controller.obstacles[i].capsule.start, truth.start, 1e-9);
      check_near(controller.obstacles[i].capsule.end, truth.end, 1e-9);
      check_near(controller.obstacles[i].velocity_mps, scene.obstacles[i].velocity_mps, 0.0);
      check((controller.obstacles[i].shape == sidestep::Shape::kSphere) == truth.is_sphere(), "shape of %zu", i);
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_judge_measures_the_path_that_the_controller_follows),
      cmocka_unit_test(the_scene_is_frozen_until_the_controller_is_ready),
      cmocka_unit_test(the_controller_gets_the_exact_obstacles_and_only_in_track_a_target),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
