#include "host/campaign/plain_tracking.h"
#include "host/campaign/random.h"
#include "host/campaign/scene_export.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/segment.h"
#include "host/campaign/urdf_arm.h"
#include "host/people/body.h"
#include "tests/support/check.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

constexpr uint64_t kScenes = 10;
constexpr const char* kFamilies[] = {"walk-by", "reach-in", "gesture", "two-people"};

const UrdfArm& panda() {
  static const UrdfArm arm(sidestep::load_config("firmware/config/panda.yaml", {}));
  return arm;
}

template <typename Function>
void for_each_scene(Function&& function) {
  for (const char* family : kFamilies) {
    for (uint64_t seed = 0; seed < kScenes; ++seed) function(make_scene(family_named(family), seed));
    for (uint64_t seed = 0; seed < 2; ++seed) function(make_scene(family_named(family), seed, panda()));
  }
}

std::string name(const Scene& scene) {
  return scene.family->name + ':' + std::to_string(scene.seed);
}

void every_scene_has_whole_persons_whom_plain_tracking_touches(void**) {
  for_each_scene([](const Scene& scene) {
    const size_t persons = scene.family->people == People::kTwo ? 2 : 1;
    check(scene.capsules.size() == persons * kBodyParts && scene.spheres.empty(), "%s", name(scene).c_str());
    check(plain_tracking_hits(scene), "%s", name(scene).c_str());
  });
}

void persons_are_away_from_the_arm_at_the_beginning_and_the_end(void**) {
  for_each_scene([](const Scene& scene) {
    const ArmPose start = scene.arm->pose(scene.start_rad), goal = scene.arm->pose(scene.goal_rad);
    for (const double clearance_m : {clearance_at(scene, start, 0.0), clearance_at(scene, start, scene.duration_s()),
                                     clearance_at(scene, goal, scene.duration_s())})
      check(clearance_m >= 0.15, "%s: %g m", name(scene).c_str(), clearance_m);
  });
}

void nobody_touches_the_base_column(void**) {
  for_each_scene([](const Scene& scene) {
    const ArmPose start = scene.arm->pose(scene.start_rad);
    for (int k = 0; k <= scene.periods; k += 5)
      for (const Capsule& capsule : capsules_at(scene, k * kPeriod_s))
        check(segment_distance(start.corners[0], start.corners[1], capsule.start, capsule.end) >=
                  0.15 + capsule.radius_m - 1e-9,
              "%s at period %d", name(scene).c_str(), k);
  });
}

void the_tool_is_held_or_moved_between_two_positions(void**) {
  int held = 0, moved = 0;
  for_each_scene([&](const Scene& scene) {
    const Vector3 start_m = scene.arm->pose(scene.start_rad).tool(), goal_m = scene.arm->pose(scene.goal_rad).tool();
    check_near(target_at(scene, 0.0).position_m, goal_m, 0.0);
    if (scene.move_s == 0.0) {
      ++held;
      check_near(start_m, goal_m, 0.0);
      check_near(target_at(scene, scene.duration_s()).position_m, start_m, 0.0);
      return;
    }
    ++moved;
    const bool back = scene.moves > 1;
    check_near(target_at(scene, 1.5 * scene.move_s).position_m, back ? start_m : goal_m, 0.0);
    const double last_change_s = (scene.moves - 1) * scene.move_s;
    check(last_change_s <= scene.duration_s() - 3.0, "%s: %g s", name(scene).c_str(), last_change_s);
  });
  check(held > 5 && moved > 5, "%d held, %d moved", held, moved);
}

void a_camera_sees_the_same_scenes(void**) {
  for (const char* family : kFamilies) {
    const Scene ideal = make_scene(family_named(family), 3);
    const Scene camera = make_scene(family_named(std::string(family) + "@camera"), 3);
    check_near(ideal.start_rad, camera.start_rad, 0.0);
    for (size_t i = 0; i < ideal.capsules.size(); ++i)
      check_near(ideal.capsules[i].at(2.3).capsule.end, camera.capsules[i].at(2.3).capsule.end, 0.0);
  }
}

/// Spheres along a capsule are a lower bound of its clearance, and near it if they are dense.
void the_clearance_of_a_capsule_is_that_of_its_spheres(void**) {
  Random random("capsules", 1);
  for (const JudgeArm* arm : {&lwa3_arm(), static_cast<const JudgeArm*>(&panda())}) {
    for (int trial = 0; trial < 200; ++trial) {
      Joints q_rad(7);
      for (int i = 0; i < 7; ++i) q_rad[i] = random.uniform(arm->range().lower_rad[i], arm->range().upper_rad[i]);
      const ArmPose pose = arm->pose(q_rad);
      const Vector3 start_m = random.in_box({-1, -1, 0}, {1, 1, 1.3}), end_m = start_m + 0.3 * random.direction();
      double least_m = 1e9;
      for (int k = 0; k <= 300; ++k)
        least_m = std::min(least_m, arm->clearance(pose, start_m + k / 300.0 * (end_m - start_m), 0.05));
      const double clearance_m = arm->clearance(pose, {{start_m, end_m, 0.05}});
      if (least_m > 0.0) check_near_because(clearance_m, least_m, 1e-3, "trial %d", trial);
      check((clearance_m < 0.0) == (least_m < 0.0) || std::abs(least_m) < 1e-3, "trial %d", trial);
    }
  }
}

void a_person_cannot_be_exported(void**) {
  const Scene scene = make_scene(family_named("gesture"), 1);
  const std::string message = sidestep::test::message_of([&] { export_scene(scene); });
  check(sidestep::test::one_line_with(message, {"--replay", "person"}), "%s", message.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_scene_has_whole_persons_whom_plain_tracking_touches),
      cmocka_unit_test(persons_are_away_from_the_arm_at_the_beginning_and_the_end),
      cmocka_unit_test(nobody_touches_the_base_column),
      cmocka_unit_test(the_tool_is_held_or_moved_between_two_positions),
      cmocka_unit_test(a_camera_sees_the_same_scenes),
      cmocka_unit_test(the_clearance_of_a_capsule_is_that_of_its_spheres),
      cmocka_unit_test(a_person_cannot_be_exported),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
