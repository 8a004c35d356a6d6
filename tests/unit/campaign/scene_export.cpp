#include "host/campaign/scene_export.h"

#include <cstring>

#include "firmware/io/config/config.h"
#include "host/sim/scenario.h"
#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep::campaign;
using sidestep::test::message_of;
using sidestep::test::one_line_with;

namespace {

void an_exported_scene_is_the_same_scene_in_the_simulator(void**) {
  for (const char* name : {"moving:11", "crowd:12", "clutter:13", "real:14", "dodge3@1:15", "dodge6d@0.5:16"}) {
    const Scene scene = scene_to_export(name);
    const auto scenario =
        sidestep::sim::load_scenario(sidestep::test::scratch_file("s.yaml", export_scene(scene))).front();
    check(scenario.periods == scene.periods && scenario.period_us == kPeriod_us, "%s", name);
    check_near(scenario.start_rad, scene.start_rad, 0.0);
    check(scenario.world.obstacles.size() == scene.spheres.size(), "%s", name);
    for (size_t i = 0; i < scene.spheres.size(); ++i) {
      const auto& motion = scenario.world.obstacles[i].motion;
      check_near(motion.position_m, scene.spheres[i].at(0.0).position_m, 0.0);
      check_near(motion.velocity_mps, scene.spheres[i].at(0.0).velocity_mps, 0.0);
    }
    const auto& target = *scenario.world.target;
    check_near(target.motion.position_m, target_at(scene, 0.0).position_m, 0.0);
    check(target.tracks_orientation == scene.family->hold_orientation, "%s", name);
    if (target.tracks_orientation)
      check_near(target.motion.orientation.toRotationMatrix(), lwa3_arm().pose(scene.start_rad).tool_rotation, 1e-9);
    check((scenario.plant.kind == sidestep::sim::PlantSpec::Kind::kServo) == scene.family->real, "%s", name);
  }
}

void an_exported_real_scene_has_the_velocity_limit_of_every_joint(void**) {
  class UnevenArm : public Lwa3Arm {
   public:
    Limits limits(const Family& family) const override {
      Limits limits = Lwa3Arm::limits(family);
      limits.velocity_radps[6] = 1.7;
      return limits;
    }
  };
  const UnevenArm arm;
  const std::string yaml = export_scene(scene_to_export("real:14", arm));
  const auto scenario = sidestep::sim::load_scenario(sidestep::test::scratch_file("s.yaml", yaml)).front();
  check_near(scenario.plant.velocity_limit_radps, arm.limits(family_named("real")).velocity_radps, 0.0);
}

/// benchmark.yaml is the controller's configuration for exported scenes of all families except dodge.
void the_configuration_of_exported_scenes_has_the_benchmarks_limits(void**) {
  const auto model = sidestep::load_config("host/campaign/benchmark.yaml", {}).model;
  const Limits limits = lwa3_arm().range();
  check_near(model.arm.limits.lower_rad, limits.lower_rad, 0.0);
  check_near(model.arm.limits.upper_rad, limits.upper_rad, 0.0);
  check_near(model.arm.limits.velocity_radps, limits.velocity_radps, 0.0);
  check_near(model.arm.limits.acceleration_radps2, limits.acceleration_radps2, 0.0);
}

void exported_dodges_have_the_limits_of_the_urdf(void**) {
  const auto model = sidestep::load_config("firmware/config/lwa3.yaml", {}).model;
  const Limits limits = lwa3_arm().limits(family_named("dodge@1"));
  check_near(model.arm.limits.lower_rad, limits.lower_rad, 0.0);
  check_near(model.arm.limits.upper_rad, limits.upper_rad, 0.0);
  check_near(model.arm.limits.velocity_radps, limits.velocity_radps, 0.0);
}

void names_of_no_scene_are_rejected(void**) {
  for (const char* name :
       {"", "moving", "moving:", "moving:x", "moving:1x", "moving:-1", "slow:1", ":1", "moving:99999999999999999999"}) {
    const std::string message = message_of([&] { scene_to_export(name); });
    check(one_line_with(message, {std::string(name, std::strcspn(name, ":"))}), "'%s': %s", name, message.c_str());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_exported_scene_is_the_same_scene_in_the_simulator),
      cmocka_unit_test(an_exported_real_scene_has_the_velocity_limit_of_every_joint),
      cmocka_unit_test(the_configuration_of_exported_scenes_has_the_benchmarks_limits),
      cmocka_unit_test(exported_dodges_have_the_limits_of_the_urdf),
      cmocka_unit_test(names_of_no_scene_are_rejected),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
