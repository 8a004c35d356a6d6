#include "host/campaign/plain_tracking.h"
#include "host/campaign/scene_maker.h"
#include "tests/support/check.h"

using namespace sidestep::campaign;
using sidestep::Vector3;
using sidestep::test::message_of;
using sidestep::test::one_line_with;

namespace {

constexpr uint64_t kScenes = 12;  // of each family

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all = [] {
    std::vector<Scene> made;
    for (const Family& family : families())
      for (uint64_t seed = 0; !family.has_furniture() && !family.boxes && seed < kScenes; ++seed)
        made.push_back(make_scene(family, seed));
    return made;
  }();
  return all;
}

template <typename Function>
void for_each_scene(bool dodge, Function&& function) {
  for (const Scene& scene : scenes())
    if (scene.family->dodge == dodge && !scene.family->has_people()) function(scene);
}

std::string name(const Scene& scene) {
  return scene.family->name + ':' + std::to_string(scene.seed);
}

void the_witness_keeps_clear_of_every_sphere_but_comes_near_it(void**) {
  for_each_scene(false, [](const Scene& scene) {
    for (const SpherePath& sphere : scene.spheres) {
      double least_m = 1e9;
      for (int k = 0; k <= scene.periods; ++k) {
        const double t_s = k * kPeriod_s;
        const ArmPose arm = lwa3_arm().pose(witness_rad(scene, t_s));
        least_m = std::min(least_m, lwa3_arm().clearance(arm, sphere.at(t_s).position_m, 0.05));
      }
      check(least_m >= 0.05 && least_m <= 0.25, "%s: %g m", name(scene).c_str(), least_m);
    }
  });
}

void the_witness_keeps_the_joint_limits(void**) {
  for_each_scene(false, [](const Scene& scene) {
    const Limits limits = lwa3_arm().range();
    for (const Joints& q_rad : {scene.start_rad, scene.goal_rad})
      check((0.8 * limits.upper_rad - q_rad.cwiseAbs()).minCoeff() >= 0.0, "%s", name(scene).c_str());
    for (double t_s = 0.0; t_s < scene.duration_s(); t_s += 0.01) {
      const Joints slope_radps = (witness_rad(scene, t_s + 1e-6) - witness_rad(scene, t_s - 1e-6)) / 2e-6;
      check(slope_radps.cwiseAbs().maxCoeff() <= 1.2, "%s at %g s", name(scene).c_str(), t_s);
      check_near_because(witness_radps(scene, t_s), slope_radps, 1e-5, "%s at %g s", name(scene).c_str(), t_s);
    }
    check_near(witness_rad(scene, 0.0), scene.start_rad, 0.0);
    check_near(witness_rad(scene, scene.witness_s), scene.goal_rad, 0.0);
    check(scene.duration_s() >= scene.witness_s + 5.0 && scene.duration_s() <= 12.01, "%s", name(scene).c_str());
  });
}

void start_and_goal_are_above_the_floor(void**) {
  for_each_scene(false, [](const Scene& scene) {
    check(lwa3_arm().pose(scene.start_rad).tool().z() > 0.15, "%s", name(scene).c_str());
    check(lwa3_arm().pose(scene.goal_rad).tool().z() > 0.15, "%s", name(scene).c_str());
    check(lwa3_arm().pose(scene.goal_rad).corners[3].z() > 0.10, "%s", name(scene).c_str());
  });
}

void number_and_speed_of_the_spheres_match_the_family(void**) {
  for_each_scene(false, [](const Scene& scene) {
    const Family& family = *scene.family;
    check(scene.spheres.empty() == (family.most_obstacles == 0) &&
              scene.spheres.size() <= static_cast<size_t>(family.most_obstacles),
          "%s", name(scene).c_str());
    for (const SpherePath& sphere : scene.spheres) {
      check(sphere.straight() != family.erratic, "%s", name(scene).c_str());
      for (double t_s = 0.0; t_s <= scene.duration_s(); t_s += 0.05)
        check(sphere.at(t_s).velocity_mps.norm() <= family.speed_mps + 1e-12, "%s", name(scene).c_str());
      check(!family.erratic || sphere.last_knot_s() >= scene.duration_s(), "%s", name(scene).c_str());
    }
  });
}

void plain_tracking_touches_a_sphere_in_every_scene_that_has_any(void**) {
  for_each_scene(false, [](const Scene& scene) {
    check(plain_tracking_hits(scene) != scene.spheres.empty(), "%s", name(scene).c_str());
  });
}

void the_target_of_a_chase_is_the_tool_of_the_witness(void**) {
  for (uint64_t seed = 0; seed < kScenes; ++seed) {
    const Scene scene = make_scene(family_named("chase"), seed);
    for (double t_s = 0.02; t_s < scene.duration_s() - 0.02; t_s += 0.05) {
      const PointMotion target = target_at(scene, t_s);
      check_near(target.position_m, lwa3_arm().pose(witness_rad(scene, t_s)).tool(), 0.0);
      const Vector3 slope_mps =
          (target_at(scene, t_s + 1e-5).position_m - target_at(scene, t_s - 1e-5).position_m) / 2e-5;
      check_near(target.velocity_mps, slope_mps, 1e-4);
    }
  }
}

void the_orientation_target_of_a_full_pose_is_that_of_the_witness(void**) {
  const Scene scene = make_scene(family_named("chase6d"), 3), moving = make_scene(family_named("chase"), 3);
  check_near(scene.goal_rad, moving.goal_rad, 0.0);
  check(!orientation_target_at(moving, 1.0), "a chase has no orientation");
  for (double t_s = 0.02; t_s < scene.duration_s() - 0.02; t_s += 0.05) {
    const auto orientation_target = orientation_target_at(scene, t_s), later = orientation_target_at(scene, t_s + 1e-5);
    check_near(orientation_target->orientation.toRotationMatrix(),
               lwa3_arm().pose(witness_rad(scene, t_s)).tool_rotation, 1e-12);
    const Eigen::AngleAxisd rotation(later->orientation * orientation_target->orientation.conjugate());
    check_near(orientation_target->velocity_radps, Vector3(rotation.angle() / 1e-5 * rotation.axis()), 1e-3);
  }
}

void the_same_seed_gives_the_same_scene(void**) {
  for (const Family& family : families()) {
    if (family.has_furniture() || family.boxes) continue;  // tests/unit/campaign/furniture, boxes
    const Scene a = make_scene(family, 7), b = make_scene(family, 7), other = make_scene(family, 8);
    check_near(a.start_rad, b.start_rad, 0.0);
    check_near(a.goal_rad, b.goal_rad, 0.0);
    check(a.spheres.size() == b.spheres.size(), "%s", family.name.c_str());
    for (size_t i = 0; i < a.spheres.size(); ++i)
      check_near(a.spheres[i].at(1.7).position_m, b.spheres[i].at(1.7).position_m, 0.0);
    check(a.capsules.size() == b.capsules.size(), "%s", family.name.c_str());
    for (size_t i = 0; i < a.capsules.size(); ++i)
      check_near(a.capsules[i].at(1.7).capsule.start, b.capsules[i].at(1.7).capsule.start, 0.0);
    check((a.start_rad - other.start_rad).norm() > 1e-3, "%s", family.name.c_str());
  }
}

void the_families_real_and_moving_have_the_same_scenes(void**) {
  const Scene real = make_scene(family_named("real"), 3), moving = make_scene(family_named("moving"), 3);
  check_near(real.goal_rad, moving.goal_rad, 0.0);
  check(real.spheres.size() == moving.spheres.size(), "%zu spheres", real.spheres.size());
}

/// Whether the point is on the axis of a moving link.
bool crosses_a_moving_link(const ArmPose& arm, const Vector3& center_m) {
  for (size_t i = 1; i < 4; ++i) {
    const Vector3 from = arm.corners[i], to = arm.corners[i + 1];
    if ((from - center_m).norm() + (to - center_m).norm() - (from - to).norm() < 1e-9) return true;
  }
  return false;
}

void dodge_spheres_cross_a_link_and_keep_clear_of_the_column(void**) {
  for_each_scene(true, [](const Scene& scene) {
    const ArmPose arm = lwa3_arm().pose(scene.start_rad);
    check(scene.spheres.size() == static_cast<size_t>(scene.family->most_obstacles), "%s", name(scene).c_str());
    for (const SpherePath& sphere : scene.spheres) {
      const PointMotion start = sphere.at(0.0), crossing = sphere.at(scene.crossing_s);
      check(crosses_a_moving_link(arm, crossing.position_m), "%s", name(scene).c_str());
      check_near((crossing.position_m - start.position_m).norm(), 0.9, 1e-9);
      check_near(start.velocity_mps.norm(), scene.family->speed_mps, 1e-12);
      check(lwa3_arm().clearance(arm, start.position_m, 0.05) >= 0.05, "%s", name(scene).c_str());
      for (double s_m = 0.0; s_m < 2.0; s_m += 0.01) {
        const Vector3 center_m = start.position_m + s_m * start.velocity_mps.normalized();
        const Vector3 column_m(0, 0, std::clamp(center_m.z(), 0.0, 0.3));
        check((center_m - column_m).norm() >= 0.25 - 1e-9, "%s", name(scene).c_str());
      }
    }
    check(scene.duration_s() >= scene.crossing_s + 0.35 / scene.family->speed_mps + 2.0, "%s", name(scene).c_str());
    check_near(target_at(scene, 1.0).position_m, arm.tool(), 0.0);
  });
}

/// An arm whose joints are too slow for any witness.
class SlowArm : public Lwa3Arm {
 public:
  Limits limits(const Family& family) const override {
    Limits limits = Lwa3Arm::limits(family);
    limits.velocity_radps.setConstant(0.05);
    return limits;
  }
};

/// An arm to which every sphere is too close.
class WideArm : public Lwa3Arm {
 public:
  double clearance(const ArmPose&, const Vector3&, double, double) const override { return 0.0; }
};

void an_arm_without_scenes_is_rejected_with_family_and_reason(void**) {
  const SlowArm slow;
  const std::string too_slow = message_of([&] { make_scene(family_named("moving"), 1, slow); });
  check(one_line_with(too_slow, {"moving", "speed"}), "%s", too_slow.c_str());
  const WideArm wide;
  const std::string no_place = message_of([&] { make_scene(family_named("dodge@1"), 1, wide); });
  check(one_line_with(no_place, {"dodge@1", "no scene in"}), "%s", no_place.c_str());
}

void families_are_selected_by_name(void**) {
  check(families_of("all").size() + 12 == families().size(), "%zu", families_of("all").size());
  check(families_of("furniture").size() == 10, "%zu", families_of("furniture").size());
  check(families_of("dodge").size() == 12, "%zu", families_of("dodge").size());
  check(families_of("people").size() == 8, "%zu", families_of("people").size());
  check(families_of("dodge@0.5").size() == 1, "%zu", families_of("dodge@0.5").size());
  check(one_line_with(message_of([] { families_of("slow"); }), {"slow", "moving"}),
        "the message lists the unknown family and the existing ones");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_witness_keeps_clear_of_every_sphere_but_comes_near_it),
      cmocka_unit_test(the_witness_keeps_the_joint_limits),
      cmocka_unit_test(start_and_goal_are_above_the_floor),
      cmocka_unit_test(number_and_speed_of_the_spheres_match_the_family),
      cmocka_unit_test(plain_tracking_touches_a_sphere_in_every_scene_that_has_any),
      cmocka_unit_test(the_target_of_a_chase_is_the_tool_of_the_witness),
      cmocka_unit_test(the_orientation_target_of_a_full_pose_is_that_of_the_witness),
      cmocka_unit_test(the_same_seed_gives_the_same_scene),
      cmocka_unit_test(the_families_real_and_moving_have_the_same_scenes),
      cmocka_unit_test(dodge_spheres_cross_a_link_and_keep_clear_of_the_column),
      cmocka_unit_test(an_arm_without_scenes_is_rejected_with_family_and_reason),
      cmocka_unit_test(families_are_selected_by_name),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
