#include <algorithm>

#include "host/campaign/furniture/furniture_maker.h"
#include "host/campaign/plain_tracking.h"
#include "host/campaign/scene_export.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/statistics.h"
#include "host/campaign/trial.h"
#include "host/campaign/urdf_arm.h"
#include "host/campaign/witness_fit.h"
#include "host/sim/scenario.h"
#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

constexpr const char* kFamilies[] = {"shelf@mover", "box@mover", "cage@mover", "table@mover", "under-table@mover"};

const UrdfArm& panda() {
  static const UrdfArm arm(load_config("firmware/config/panda.yaml", {}));
  return arm;
}

/// One of every family with each arm.
const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all = [] {
    std::vector<Scene> made;
    for (const JudgeArm* arm : {&lwa3_arm(), static_cast<const JudgeArm*>(&panda())})
      for (const char* family : kFamilies) made.push_back(make_scene(family_named(family), 1, *arm));
    return made;
  }();
  return all;
}

std::string name(const Scene& scene) {
  return (scene.arm == &lwa3_arm() ? "LWA3 " : "Panda ") + scene.family->name;
}

/// FCL's distances with every solid by itself, without the bounds that the judge uses.
double furniture_clearance_m(const Scene& scene, const Joints& q_rad) {
  static const sim::Truth lwa3_truth(sim::Arm("urdf/lwa3.urdf", "base_link", "tool", {}));
  static const sim::Truth panda_truth(sim::Arm("urdf/panda.urdf", "panda_link0", "panda_tool", {}));
  sim::Truth truth = scene.arm == &lwa3_arm() ? lwa3_truth : panda_truth;
  truth.place(q_rad);
  double least_m = 1e9;
  for (const sim::Obstacle& solid : scene.furniture) {
    for (const sim::ArmPart& part : truth.arm().parts())
      least_m = std::min(
          least_m, sim::signed_distance_m(part.solid, part.base_from_part, solid.solid, solid.motion.base_from_body()));
  }
  return least_m;
}

void the_witness_keeps_clear_of_all_furniture_and_of_itself(void**) {
  for (const Scene& scene : scenes()) {
    for (double t_s = 0.0; t_s < scene.witness_s + 0.02; t_s += 0.017) {
      const Joints q_rad = witness_rad(scene, t_s);
      const double clearance_m = furniture_clearance_m(scene, q_rad);
      check(clearance_m >= 0.0095, "%s at %g s: %g m", name(scene).c_str(), t_s, clearance_m);
      const ArmPose pose = scene.arm->pose(q_rad);
      check(scene.arm->keeps_clear_of_itself(pose) && scene.arm->self_clearance(pose, 0.005) > 0.0045, "%s at %g s",
            name(scene).c_str(), t_s);
    }
  }
}

void the_witness_leads_from_start_to_goal_within_the_limits(void**) {
  for (const Scene& scene : scenes()) {
    const Limits limits = scene.arm->limits(*scene.family);
    check_near(witness_rad(scene, 0.0), scene.start_rad, 0.0);
    check_near(witness_rad(scene, scene.witness_s), scene.goal_rad, 0.0);
    check(scene.duration_s() >= scene.witness_s + 5.0 && scene.duration_s() < 15.02, "%s", name(scene).c_str());
    for (double t_s = 0.0; t_s < scene.witness_s; t_s += 0.01) {
      const Joints q_rad = witness_rad(scene, t_s);
      const Joints slope_radps = (witness_rad(scene, t_s + 1e-6) - witness_rad(scene, t_s - 1e-6)) / 2e-6;
      check((q_rad - limits.lower_rad).minCoeff() >= 0.0 && (limits.upper_rad - q_rad).minCoeff() >= 0.0, "%s",
            name(scene).c_str());
      check((limits.velocity_radps - slope_radps.cwiseAbs()).minCoeff() >= 0.0, "%s", name(scene).c_str());
    }
  }
}

void plain_tracking_touches_furniture_in_every_scene(void**) {
  for (Scene scene : scenes()) {
    scene.spheres.clear();
    check(plain_tracking_hits(scene), "%s", name(scene).c_str());
    check(scene.furniture.size() >= 5, "%s: %zu solids", name(scene).c_str(), scene.furniture.size());
  }
}

/// A mover that the witness would touch if it came up to 1.5 s earlier or later.
void the_mover_just_misses_the_witness(void**) {
  for (const Scene& scene : scenes()) {
    check(scene.spheres.size() == 1, "%s: %zu", name(scene).c_str(), scene.spheres.size());
    double least_m = 1e9, otherwise_m = 1e9;
    for (int k = 0; k <= scene.periods; ++k) {
      const double t_s = k * kPeriod_s;
      least_m = std::min(least_m, sphere_clearance_at(scene, scene.arm->pose(witness_rad(scene, t_s)), t_s));
      for (int other = -150; other <= 150; other += 10) {
        const ArmPose pose = scene.arm->pose(witness_rad(scene, t_s + other * kPeriod_s));
        if (k % 10 == 0) otherwise_m = std::min(otherwise_m, sphere_clearance_at(scene, pose, t_s));
      }
    }
    check(least_m >= kWitnessClearance_m, "%s: %g m", name(scene).c_str(), least_m);
    check(otherwise_m < 0.0, "%s: %g m", name(scene).c_str(), otherwise_m);
  }
}

void the_mover_touches_no_furniture(void**) {
  for (const Scene& scene : scenes()) {
    for (double t_s = 0.0; t_s < scene.duration_s(); t_s += 0.01) {
      Eigen::Isometry3d base_from_sphere(Eigen::Translation3d(scene.spheres[0].at(t_s).position_m));
      for (const sim::Obstacle& solid : scene.furniture) {
        const double gap_m = sim::signed_distance_m({sim::Shape::kSphere, {kSphereRadius_m, 0, 0}}, base_from_sphere,
                                                    solid.solid, solid.motion.base_from_body());
        check(gap_m > -0.002, "%s at %g s: %g m", name(scene).c_str(), t_s, gap_m);  // it looks every 25 mm
      }
    }
  }
}

/// Follows the witness exactly.
class WitnessController : public TrialController {
 public:
  explicit WitnessController(const Scene& scene) : scene_(scene) {}

  ControllerOutput cycle(const ControllerInput& input) override {
    ControllerOutput output;
    output.ready = true;
    output.velocity_radps = (witness_rad(scene_, ++cycles_ * kPeriod_s) - input.q_rad) / kPeriod_s;
    reported_ = input.obstacles.obstacles.size();
    return output;
  }
  size_t reported() const { return reported_; }

 private:
  const Scene& scene_;
  int cycles_ = 0;
  size_t reported_ = 0;
};

void the_judge_counts_the_witness_as_a_success_and_a_path_through_furniture_as_none(void**) {
  for (size_t i = 0; i < scenes().size(); i += 4) {
    const Scene& scene = scenes()[i];
    WitnessController witness(scene);
    const TrialMetrics metrics = run_trial(scene, witness);
    check(succeeded({scene.family, "", scene.seed, metrics}), "%s: %g m clear, %g m away", name(scene).c_str(),
          metrics.clearance_m, metrics.final_error_m);
    check(metrics.clearance_m >= 0.0095 && metrics.clearance_m <= metrics.goal_clearance_m, "%g m",
          metrics.clearance_m);
    check(metrics.model_goal_clearance_m <= metrics.goal_clearance_m + 1e-6, "%s", name(scene).c_str());
    check_near(metrics.arrival_s, metrics.witness_arrival_s, 0.011);
    check(std::isnan(metrics.final_turn_rad) == (scene.arm == &lwa3_arm()), "%s", name(scene).c_str());
    check(witness.reported() == scene.furniture.size() + 1, "%zu are reported", witness.reported());
    const TrialMetrics plain =
        run_trial(scene, *make_controller(nullptr, *scene.arm, scene.arm->limits(*scene.family)));
    check(plain.clearance_m < 0.0, "%s: %g m", name(scene).c_str(), plain.clearance_m);
  }
}

void the_same_seed_gives_the_same_scene(void**) {
  const Scene &first = scenes()[0], again = make_scene(*first.family, first.seed);
  const Scene alone = make_scene(family_named("shelf"), first.seed), other = make_scene(family_named("shelf"), 2);
  for (const Scene* same : {&again, &alone}) {
    check_near(same->start_rad, first.start_rad, 0.0);
    for (double t_s = 0.0; t_s < first.witness_s; t_s += 0.1)
      check_near(witness_rad(*same, t_s), witness_rad(first, t_s), 0.0);
    for (size_t i = 0; i < first.furniture.size(); ++i)
      check_near(same->furniture[i].motion.position_m, first.furniture[i].motion.position_m, 0.0);
  }
  check_near(again.spheres[0].at(1.7).position_m, first.spheres[0].at(1.7).position_m, 0.0);
  check(alone.spheres.empty(), "the family without mover has one");
  check((other.start_rad - first.start_rad).norm() > 1e-3, "another seed gives the same scene");
}

void an_exported_scene_has_the_furniture_and_the_goal(void**) {
  const Scene& scene = scenes().back();
  const auto scenario = sim::load_scenario(test::scratch_file("furniture.yaml", export_scene(scene))).front();
  check(scenario.world.obstacles.size() == scene.furniture.size() + 1, "%zu", scenario.world.obstacles.size());
  for (size_t i = 0; i < scene.furniture.size(); ++i) {
    const sim::Obstacle &a = scene.furniture[i], &b = scenario.world.obstacles[i + 1];
    check(a.solid.shape == b.solid.shape, "solid %zu", i);
    check_near(a.solid.size_m, b.solid.size_m, 0.0);
    check_near(a.motion.position_m, b.motion.position_m, 0.0);
    check_near(a.motion.base_from_body().linear(), b.motion.base_from_body().linear(), 1e-9);
  }
  const ArmPose goal = scene.arm->pose(scene.goal_rad);
  check(scenario.world.target->tracks_orientation, "the Panda's goal is a pose");
  check_near(scenario.world.target->motion.orientation.toRotationMatrix(), goal.tool_rotation, 1e-9);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_witness_keeps_clear_of_all_furniture_and_of_itself),
      cmocka_unit_test(the_witness_leads_from_start_to_goal_within_the_limits),
      cmocka_unit_test(plain_tracking_touches_furniture_in_every_scene),
      cmocka_unit_test(the_mover_just_misses_the_witness),
      cmocka_unit_test(the_mover_touches_no_furniture),
      cmocka_unit_test(the_judge_counts_the_witness_as_a_success_and_a_path_through_furniture_as_none),
      cmocka_unit_test(the_same_seed_gives_the_same_scene),
      cmocka_unit_test(an_exported_scene_has_the_furniture_and_the_goal),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
