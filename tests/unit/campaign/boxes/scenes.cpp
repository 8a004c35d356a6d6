#include <algorithm>

#include "host/campaign/boxes/boxes_maker.h"
#include "host/campaign/scene_export.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/statistics.h"
#include "host/campaign/trial.h"
#include "host/campaign/urdf_arm.h"
#include "host/sim/scenario.h"
#include "tests/support/check.h"
#include "tests/support/constant_controller.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

constexpr uint64_t kScenes = 4;  // of each arm

Config config_of(const char* urdf) {
  Overrides overrides;
  overrides.urdf = urdf;
  overrides.base = "base";
  overrides.tip = "tool";
  return load_config("", overrides);
}

const Config& spatial_config() {
  static const Config config = config_of("tests/data/ten_joints.urdf");
  return config;
}

const UrdfArm& spatial_arm() {
  static const UrdfArm arm(spatial_config());
  return arm;
}

const UrdfArm& planar_arm() {
  static const UrdfArm arm(config_of("tests/data/ten_joints_planar.urdf"));
  return arm;
}

/// Height of the base column and length of the whole arm, from the URDF or docs/paper.md, m.
struct TestArm {
  const char* name;
  const JudgeArm* arm;
  double column_m, length_m;
};

const std::vector<TestArm>& arms() {
  static const std::vector<TestArm> all{{"LWA3", &lwa3_arm(), 0.3, 0.3 + 0.328 + 0.2765 + 0.3372},
                                        {"ten joints", &spatial_arm(), 0.1, 0.1 + 10 * 0.13},
                                        {"planar", &planar_arm(), 0.2, 0.2 + 10 * 0.13}};
  return all;
}

template <typename Function>
void for_each_scene(Function&& function) {
  static std::vector<std::vector<Scene>> scenes;
  for (size_t i = 0; i < arms().size(); ++i) {
    if (scenes.size() <= i) {
      scenes.emplace_back();
      for (uint64_t seed = 0; seed < kScenes; ++seed)
        scenes[i].push_back(make_scene(family_named("boxes"), seed, *arms()[i].arm));
    }
    for (const Scene& scene : scenes[i]) function(scene, arms()[i]);
  }
}

void five_boxes_move_at_constant_speed_and_stay_in_the_workspace(void**) {
  for_each_scene([](const Scene& scene, const TestArm& arm) {
    check(scene.boxes.size() == 5, "%s: %zu boxes", arm.name, scene.boxes.size());
    for (const BoxPath& box : scene.boxes) {
      const double speed_mps = box.at(0.0).velocity_mps.norm();
      check(speed_mps <= 0.3, "%s: %g m/s", arm.name, speed_mps);
      for (double t_s = 0.0; t_s < scene.duration_s(); t_s += 0.02) {
        const PointMotion centre = box.at(t_s);
        const Vector3 column_m(0.0, 0.0, std::clamp(centre.position_m.z(), 0.0, arm.column_m));
        check_near(centre.velocity_mps.norm(), speed_mps, 1e-12);
        check(centre.position_m.z() >= 0.15 - 1e-9, "%s: sinks to %g m", arm.name, centre.position_m.z());
        check((centre.position_m - column_m).norm() >= 0.55 - 1e-9, "%s: at the base at %g s", arm.name, t_s);
        check(centre.position_m.norm() <= arm.length_m + 0.3 + 1e-6, "%s: outside at %g s", arm.name, t_s);
      }
    }
  });
}

/// FCL's distances with every solid by itself, or those of the LWA3's judge.
double clearance_m(const Scene& scene, const Joints& q_rad, const std::vector<sim::Obstacle>& solids) {
  double least_m = 1e9;
  for (const sim::Obstacle& solid : solids)
    least_m = std::min(least_m, scene.arm->solid_clearance(scene.arm->pose(q_rad), {solid}));
  return least_m;
}

void start_and_goal_are_free_and_apart(void**) {
  for_each_scene([](const Scene& scene, const TestArm& arm) {
    check(clearance_m(scene, scene.start_rad, boxes_at(scene, 0.0)) >= 0.15, "%s", arm.name);
    for (const Joints& q_rad : {scene.start_rad, scene.goal_rad}) {
      const ArmPose pose = scene.arm->pose(q_rad);
      check(clearance_m(scene, q_rad, scene.furniture) >= 0.05, "%s", arm.name);
      check(scene.arm->self_clearance(pose) >= 0.005 && scene.arm->keeps_clear_of_itself(pose), "%s", arm.name);
    }
    const Vector3 way_m = scene.arm->pose(scene.goal_rad).tool() - scene.arm->pose(scene.start_rad).tool();
    check(way_m.norm() >= 0.5, "%s: %g m", arm.name, way_m.norm());
  });
}

void the_ground_has_its_top_below_the_arm_and_a_hole_for_the_base(void**) {
  for_each_scene([](const Scene& scene, const TestArm& arm) {
    for (const sim::Obstacle& slab : scene.furniture) {
      const Vector3 half_m = 0.5 * slab.solid.size_m, centre_m = slab.motion.position_m;
      check_near(centre_m.z() + half_m.z(), 0.0, 1e-12);
      const bool beside = ((centre_m.cwiseAbs() - half_m).head<2>().array() >= 0.25 - 1e-9).any();
      check(beside, "%s: a slab covers the base", arm.name);
    }
    sim::Obstacle probe;  // a ball that touches the ground 0.5 m from the base, in any direction
    probe.solid.size_m.x() = 0.01;
    for (double angle_rad = 0.0; angle_rad < 6.3; angle_rad += 0.1) {
      probe.motion.position_m = Vector3(0.5 * std::cos(angle_rad), 0.5 * std::sin(angle_rad), 0.0);
      const bool touches = std::any_of(scene.furniture.begin(), scene.furniture.end(), [&](const sim::Obstacle& slab) {
        return sim::signed_distance_m(probe.solid, probe.motion.base_from_body(), slab.solid,
                                      slab.motion.base_from_body()) < 0.0;
      });
      check(touches, "%s: a gap at %g rad", arm.name, angle_rad);
    }
  });
}

void the_boxes_of_a_planar_arm_move_in_its_plane(void**) {
  for_each_scene([](const Scene& scene, const TestArm& arm) {
    double highest_m = 0.0, lowest_m = 1e9;
    for (const BoxPath& box : scene.boxes)
      for (double t_s = 0.0; t_s < scene.duration_s(); t_s += 1.0) {
        highest_m = std::max(highest_m, box.at(t_s).position_m.z());
        lowest_m = std::min(lowest_m, box.at(t_s).position_m.z());
      }
    const bool in_plane = highest_m - lowest_m < 1e-9;
    check(in_plane == (arm.arm == &planar_arm()), "%s: from %g to %g m", arm.name, lowest_m, highest_m);
    if (in_plane) check_near(lowest_m, 0.2, 1e-9);
  });
}

void both_kinds_of_goal_have_the_same_scenes(void**) {
  const Scene a = make_scene(family_named("boxes"), 2), b = make_scene(family_named("boxes@posture"), 2),
              other = make_scene(family_named("boxes"), 3);
  check_near(a.start_rad, b.start_rad, 0.0);
  check_near(a.goal_rad, b.goal_rad, 0.0);
  for (size_t i = 0; i < a.boxes.size(); ++i)
    check_near(a.boxes[i].at(9.0).position_m, b.boxes[i].at(9.0).position_m, 0.0);
  check((a.start_rad - other.start_rad).norm() > 1e-3, "another seed gives the same scene");
}

/// Moves all joints to the goal posture, stays there for stay_s, and moves away again.
class VisitController : public TrialController {
 public:
  VisitController(const Scene& scene, double stay_s) : scene_(scene), stay_s_(stay_s) {}

  ControllerOutput cycle(const ControllerInput& input) override {
    posture_ = input.posture_rad != nullptr;
    reported_ = input.obstacles.obstacles;
    ++cycles_;
    const bool there = (input.q_rad - scene_.goal_rad).cwiseAbs().maxCoeff() < 0.009;
    if (there) stayed_s_ += kPeriod_s;
    const Joints& to_rad = stayed_s_ > stay_s_ ? scene_.start_rad : scene_.goal_rad;
    ControllerOutput output;
    output.ready = true;
    output.velocity_radps = (10.0 * (to_rad - input.q_rad)).cwiseMax(-2.0).cwiseMin(2.0);
    return output;
  }

  bool posture() const { return posture_; }
  int cycles() const { return cycles_; }
  const std::vector<Obstacle>& reported() const { return reported_; }

 private:
  const Scene& scene_;
  double stay_s_, stayed_s_ = 0.0;
  bool posture_ = false;
  int cycles_ = 0;
  std::vector<Obstacle> reported_;
};

Scene empty_scene(const char* family) {
  Scene scene = make_scene(family_named(family), 1);
  scene.boxes.clear();
  scene.furniture.clear();
  return scene;
}

void a_trial_ends_when_the_goal_is_reached(void**) {
  for (const char* family : {"boxes", "boxes@posture"}) {
    const Scene scene = empty_scene(family);
    VisitController visit(scene, 1.0);
    const TrialMetrics metrics = run_trial(scene, visit);
    check(arrived({scene.family, "", scene.seed, metrics}), "%s", family);
    check(visit.cycles() < scene.periods, "%s: it did not end", family);
    check_near(metrics.arrival_s + kDwell_s, visit.cycles() * kPeriod_s, 0.011);
    check(visit.posture() == scene.family->posture, "%s", family);
    check(std::isnan(metrics.final_posture_rad) != scene.family->posture, "%s", family);
  }
}

void a_shorter_visit_of_the_goal_does_not_count(void**) {
  const Scene scene = empty_scene("boxes@posture");
  VisitController visit(scene, 0.05);
  const TrialMetrics metrics = run_trial(scene, visit);
  check(!arrived({scene.family, "", scene.seed, metrics}), "%g rad", metrics.final_posture_rad);
  check(visit.cycles() == scene.periods, "%d cycles", visit.cycles());
}

void the_controller_receives_the_boxes_with_their_present_velocities_and_the_ground(void**) {
  const Scene scene = make_scene(family_named("boxes"), 1);
  VisitController visit(scene, 1e9);
  run_trial(scene, visit);
  check(visit.reported().size() == scene.boxes.size() + scene.furniture.size(), "%zu", visit.reported().size());
  const double last_s = (visit.cycles() - 1) * kPeriod_s;
  for (size_t i = 0; i < visit.reported().size(); ++i) {
    const Obstacle& obstacle = visit.reported()[i];
    check(obstacle.shape == Shape::kBox, "obstacle %zu", i);
    if (i >= scene.boxes.size()) {
      assert_true(obstacle.velocity_mps.isZero(0.0));
      continue;
    }
    check_near(obstacle.capsule.centre(), scene.boxes[i].at(last_s).position_m, 1e-9);
    check_near(obstacle.velocity_mps, scene.boxes[i].at(last_s).velocity_mps, 0.0);
  }
}

void a_box_that_runs_into_the_arm_is_a_contact(void**) {
  for (const JudgeArm* arm : {&lwa3_arm(), static_cast<const JudgeArm*>(&spatial_arm())}) {
    Scene scene = make_scene(family_named("boxes"), 1, *arm);
    const Vector3 tool_m = arm->pose(scene.start_rad).tool(), velocity_mps(0.0, 0.0, -0.3);
    scene.boxes = {BoxPath(tool_m - 3.0 * velocity_mps, velocity_mps, 0.9, 0.1)};
    test::ConstantController idle(Joints::Zero(scene.start_rad.size()));
    const TrialMetrics met = run_trial(scene, idle);
    check(met.clearance_m < -0.03, "%g m", met.clearance_m);
    assert_true(touched({scene.family, "", scene.seed, met}));
    scene.boxes.clear();
    check(run_trial(scene, idle).clearance_m >= 0.05, "an arm at rest without boxes");
  }
}

void check_success(const char* family, uint64_t seed) {
  const Scene scene = make_scene(family_named(family), seed, spatial_arm());
  const TrialMetrics metrics = run_trial(scene, *make_controller(spatial_config().model));
  check(succeeded({scene.family, "", scene.seed, metrics}), "%s:%d: %g m clear, links %g m, %g m away", family,
        static_cast<int>(seed), metrics.clearance_m, metrics.self_clearance_m, metrics.final_error_m);
}

void a_ten_joint_arm_reaches_both_kinds_of_goal(void**) {
  for (const char* family : {"boxes", "boxes@posture"})
    for (uint64_t seed = 0; seed < kScenes; ++seed) check_success(family, seed);
}

/// Here a link ran into another one at full speed.
void a_chain_that_folds_at_full_speed_does_not_touch_itself(void**) {
  check_success("boxes", 1'000'091);
}

/// Here the arm rested for 28 s with links in each other's way, while every path that ignores that seemed free.
void an_arm_that_its_own_links_block_finds_a_way_round_them(void**) {
  check_success("boxes@posture", 2'000'169);
}

void an_exported_scene_has_the_boxes_with_their_turns_and_the_goal(void**) {
  for (const char* family : {"boxes", "boxes@posture"}) {
    const Scene scene = make_scene(family_named(family), 1);
    const auto scenario = sim::load_scenario(test::scratch_file("boxes.yaml", export_scene(scene))).front();
    check(scenario.world.obstacles.size() == scene.boxes.size() + scene.furniture.size(), "%s", family);
    for (double t_s = 0.0; t_s < scene.duration_s(); t_s += 0.4) {
      const sim::World world = sim::advanced(scenario.world, t_s);
      for (size_t i = 0; i < scene.boxes.size(); ++i) {
        check_near(world.obstacles[i].solid.size_m, Vector3(0.3, 0.3, 0.3), 0.0);
        check_near(world.obstacles[i].motion.position_m, scene.boxes[i].at(t_s).position_m, 3e-4);
      }
    }
    const sim::Target& target = *scenario.world.target;
    if (scene.family->posture) check_near(target.joints_rad, scene.goal_rad, 0.0);
    if (!scene.family->posture) check_near(target.motion.position_m, target_at(scene, 0.0).position_m, 0.0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(five_boxes_move_at_constant_speed_and_stay_in_the_workspace),
      cmocka_unit_test(start_and_goal_are_free_and_apart),
      cmocka_unit_test(the_ground_has_its_top_below_the_arm_and_a_hole_for_the_base),
      cmocka_unit_test(the_boxes_of_a_planar_arm_move_in_its_plane),
      cmocka_unit_test(both_kinds_of_goal_have_the_same_scenes),
      cmocka_unit_test(a_trial_ends_when_the_goal_is_reached),
      cmocka_unit_test(a_shorter_visit_of_the_goal_does_not_count),
      cmocka_unit_test(the_controller_receives_the_boxes_with_their_present_velocities_and_the_ground),
      cmocka_unit_test(a_box_that_runs_into_the_arm_is_a_contact),
      cmocka_unit_test(a_ten_joint_arm_reaches_both_kinds_of_goal),
      cmocka_unit_test(a_chain_that_folds_at_full_speed_does_not_touch_itself),
      cmocka_unit_test(an_arm_that_its_own_links_block_finds_a_way_round_them),
      cmocka_unit_test(an_exported_scene_has_the_boxes_with_their_turns_and_the_goal),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
