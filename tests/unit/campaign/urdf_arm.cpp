#include "host/campaign/urdf_arm.h"

#include <filesystem>

#include "host/campaign/judge.h"
#include "host/campaign/lwa3_arm.h"
#include "host/campaign/scene_export.h"
#include "host/campaign/scene_maker.h"
#include "host/sim/run.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

constexpr uint64_t kScenes = 3;

Config config_of(const char* urdf, const char* base, const char* tip) {
  Overrides overrides;
  overrides.urdf = urdf;
  overrides.base = base;
  overrides.tip = tip;
  return load_config("", overrides);
}

std::vector<Config> other_arms() {
  return {config_of("urdf/panda.urdf", "panda_link0", "panda_tool"), config_of("tests/data/arm6.urdf", "foot", "tip"),
          config_of("tests/data/arm10.urdf", "l0", "l10")};
}

Joints random_joints(test::Random& random, const Limits& range) {
  Joints q_rad(range.lower_rad.size());
  for (int i = 0; i < q_rad.size(); ++i) q_rad[i] = random.uniform(range.lower_rad[i], range.upper_rad[i]);
  return q_rad;
}

void poses_match_the_benchmarks_lwa3(void**) {
  const UrdfArm arm(load_config("firmware/config/lwa3.yaml", {}));
  test::Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Joints q_rad = random_joints(random, lwa3_arm().range());
    const ArmPose one = arm.pose(q_rad), other = lwa3_arm().pose(q_rad);
    check_near(one.tool(), other.tool(), 1e-9);
    check_near(one.tool_rotation, other.tool_rotation, 1e-9);
    check_near(tool_jacobian(one), tool_jacobian(other), 1e-9);
    const Joints qd_radps = random.joints(7, -1.0, 1.0);
    check_near(tool_angular_velocity(one, qd_radps), tool_angular_velocity(other, qd_radps), 1e-9);
  }
}

void self_clearance_matches_the_benchmarks_lwa3(void**) {
  const UrdfArm arm(load_config("firmware/config/lwa3.yaml", {}));
  test::Random random(2);
  int touching = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Joints q_rad = random_joints(random, lwa3_arm().range());
    if (trial % 2 == 0) q_rad[3] = random.uniform(1.7, 1.97), q_rad[4] *= 0.1, q_rad[5] = random.uniform(1.7, 1.97);
    const double one_m = arm.self_clearance(arm.pose(q_rad), 0.05);
    const double other_m = lwa3_arm().self_clearance(lwa3_arm().pose(q_rad), 0.05);
    touching += other_m <= 0.0;
    check((one_m <= 0.0) == (other_m <= 0.0), "trial %d: %g m and %g m", trial, one_m, other_m);
    if (other_m > 0.0) check_near_because(one_m, other_m, 1e-6, "trial %d", trial);
  }
  check(touching > 20, "only %d touch", touching);
}

void only_the_lwa3_gets_the_lwa3_model(void**) {
  const auto own = judge_arm_of(load_config("firmware/config/lwa3.yaml", {}));
  assert_non_null(dynamic_cast<const Lwa3Arm*>(own.get()));
  for (const Config& config : other_arms()) {
    const auto arm = judge_arm_of(config);
    check(dynamic_cast<const UrdfArm*>(arm.get()) != nullptr, "%s", config.robot.urdf.c_str());
  }
}

std::vector<std::string> configs_with_the_lwa3() {
  std::vector<std::string> files{"host/campaign/benchmark.yaml"};
  for (const char* name : {"lwa3", "left", "right"}) files.push_back(std::string("firmware/config/") + name + ".yaml");
  return files;
}

void an_lwa3_with_another_shape_or_limit_gets_the_urdf_model(void**) {
  for (const std::string& file : configs_with_the_lwa3()) {
    const Config config = load_config(file, {});
    const auto is_lwa3 = [](const Config& changed) {
      return dynamic_cast<const Lwa3Arm*>(judge_arm_of(changed).get()) != nullptr;
    };
    check(is_lwa3(config), "%s", file.c_str());
    Config gripper = config, thin = config, slow = config;
    gripper.model.arm.shapes.push_back(gripper.model.arm.shapes.back());
    thin.model.arm.shapes.back().capsule_body.radius_m = 0.04;
    slow.model.arm.limits.velocity_radps[3] = 0.5;
    check(!is_lwa3(gripper) && !is_lwa3(thin) && !is_lwa3(slow), "%s", file.c_str());
  }
}

/// The folder of the mesh is given only in the configuration.
void meshes_are_found_on_the_configured_package_path(void**) {
  std::filesystem::create_directories(test::scratch_folder() + "/elsewhere/hand");
  test::scratch_file("elsewhere/hand/palm.obj",
                     "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 2 3\nf 1 3 4\nf 1 4 2\n");
  const std::string palm = R"(<link name="palm"><collision><geometry><mesh filename="package://hand/palm.obj"/>
    </geometry></collision></link><joint name="wrist" type="fixed"><parent link="tool"/><child link="palm"/></joint>
    </robot>)";
  test::scratch_file("palm.urdf", test::replaced(test::text_of("urdf/lwa3.urdf"), "</robot>", palm));
  const std::string file =
      test::scratch_file("palm.yaml", "robot: {urdf: palm.urdf, base: base_link, tip: tool, package_path: [" +
                                          test::scratch_folder() + "/elsewhere]}\n");
  const auto arm = judge_arm_of(load_config(file, {}));
  const ArmPose pose = arm->pose(Joints::Zero(7));
  check(arm->clearance(pose, pose.tool() + Vector3(0, 0, 0.1), 0.01) < 0.0, "the palm is not there");

  Scene scene = make_scene(family_named("moving"), 1);
  scene.arm = arm.get();
  const auto scenario = sim::load_scenario(test::scratch_file("palm-scene.yaml", export_scene(scene))).front();
  const std::string message = test::message_of([&] { sim::Run(scenario, ""); });
  check(message.empty(), "%s", message.c_str());
}

/// The controller's capsules enclose the surface that the simulator measures.
void the_controllers_clearance_never_exceeds_the_true_one(void**) {
  for (const Config& config : other_arms()) {
    const UrdfArm arm(config);
    test::Random random(2);
    for (int trial = 0; trial < 500; ++trial) {
      const ArmPose pose = arm.pose(random_joints(random, arm.range()));
      const Vector3 center_m = random.inside(-0.6, 0.6) + Vector3(0, 0, 0.5);
      const double true_m = arm.clearance(pose, center_m, 0.05);
      check(true_m < 0.0 || arm.controller_clearance(pose, center_m, 0.05) <= true_m + 1e-6, "%s, trial %d: %g m",
            config.robot.urdf.c_str(), trial, true_m);
      check_near(arm.clearance(pose, center_m, 0.05, 0.2), std::min(0.2, true_m), 1e-12);
    }
  }
}

void the_witness_of_any_arm_keeps_clear_and_within_limits(void**) {
  for (const Config& config : other_arms()) {
    const UrdfArm arm(config);
    const Limits limits = config.model.arm.limits;
    for (uint64_t seed = 0; seed < kScenes; ++seed) {
      const Scene scene = make_scene(family_named("chase"), seed, arm);
      for (int k = 0; k <= scene.periods; ++k) {
        const double t_s = k * kPeriod_s;
        const Joints q_rad = witness_rad(scene, t_s);
        const ArmPose pose = arm.pose(q_rad);
        check(clearance_at(scene, pose, t_s) >= 0.05, "%s:%d", config.robot.urdf.c_str(), static_cast<int>(seed));
        check(arm.keeps_clear_of_itself(pose), "%s:%d", config.robot.urdf.c_str(), static_cast<int>(seed));
        check((q_rad - limits.lower_rad).minCoeff() > 0.0 && (limits.upper_rad - q_rad).minCoeff() > 0.0, "limits");
        check((limits.velocity_radps - witness_radps(scene, t_s).cwiseAbs()).minCoeff() >= 0.0, "speed");
      }
    }
  }
}

/// A fast sphere that touches the arm, at rest, only between two periods.
void contact_between_two_periods_is_detected(void**) {
  const UrdfArm arm(other_arms().front());
  Scene scene = make_scene(family_named("moving"), 1, arm);
  const Vector3 tool_m = arm.pose(scene.start_rad).tool();
  const Vector3 velocity_mps = 30.0 * tool_m.cross(Vector3::UnitZ()).normalized();
  scene.spheres = {SpherePath(tool_m - 0.015 * velocity_mps, velocity_mps)};
  Judge judge(scene, Joints::Zero(7));
  for (int k = 0; k <= 3; ++k) {
    check(clearance_at(scene, arm.pose(scene.start_rad), k * kPeriod_s) > 0.0, "apart at period %d", k);
    judge.record_state(k, scene.start_rad);
  }
  check(judge.metrics().clearance_m < 0.0, "%g m", judge.metrics().clearance_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(poses_match_the_benchmarks_lwa3),
      cmocka_unit_test(self_clearance_matches_the_benchmarks_lwa3),
      cmocka_unit_test(only_the_lwa3_gets_the_lwa3_model),
      cmocka_unit_test(an_lwa3_with_another_shape_or_limit_gets_the_urdf_model),
      cmocka_unit_test(meshes_are_found_on_the_configured_package_path),
      cmocka_unit_test(the_controllers_clearance_never_exceeds_the_true_one),
      cmocka_unit_test(the_witness_of_any_arm_keeps_clear_and_within_limits),
      cmocka_unit_test(contact_between_two_periods_is_detected),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
