// What the tool holds: its place, its distances, allowed contact.

#include "firmware/model/attachments.h"

#include "firmware/model/clearance.h"
#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/fcl_distance.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Random;

namespace {

/// Each shape in turn.
Obstacle random_shape(Random& random, int kind, const Vector3& centre) {
  const double size_m = random.uniform(0.02, 0.15), other_m = random.uniform(0.02, 0.15);
  const Matrix3 rotation = random.turn().toRotationMatrix();
  if (kind == 0) return sphere_obstacle(centre, size_m);
  if (kind == 1) return capsule_obstacle(centre, rotation, size_m, other_m);
  if (kind == 2) return cylinder_obstacle(centre, rotation, size_m, other_m);
  return box_obstacle(centre, rotation, {size_m, other_m, random.uniform(0.02, 0.15)});
}

struct Scene {
  JointVector q_rad = test::home_rad();
  Attachments attachments;
  std::unique_ptr<ObstacleSet> set = std::make_unique<ObstacleSet>();

  explicit Scene(Random& random) {
    for (double& q : q_rad) q += random.uniform(-1.0, 1.0);
    for (int kind = 0; kind < 4; ++kind) {
      attachments.shapes.add(random_shape(random, kind, random.inside(-0.2, 0.2)));
      attachments.shapes[kind].id = 100 + kind;
    }
    place_held_shapes(test::lwa3(), attachments);
    set->count = 12;
    for (int i = 0; i < set->count; ++i) {
      set->obstacles[static_cast<size_t>(i)] = random_shape(random, i % 4, random.inside(-0.8, 0.8));
      set->obstacles[static_cast<size_t>(i)].id = i;
    }
  }
  OtherFrames others() const {
    OtherFrames frames = test::lwa3().other_frames;
    frames.attachments = &attachments;
    return frames;
  }
  Clearance measure(const OtherFrames& others) const {
    const LinkPoses poses = forward_kinematics(test::lwa3(), q_rad, others);
    return measure_clearance(test::lwa3(), poses, {set.get(), 0.0, 0.0, nullptr}, {10.0, 0.5});
  }
  /// FCL's least distance of the held shapes to the obstacles.
  double held_m() const {
    const LinkPoses poses = forward_kinematics(test::lwa3(), q_rad);
    Eigen::Isometry3d base_from_tool = Eigen::Isometry3d::Identity();
    base_from_tool.linear() = poses.tool_rotation;
    base_from_tool.translation() = poses.tool_position;
    double least_m = HUGE_VAL;
    for (const Obstacle& shape : attachments.shapes)
      for (int i = 0; i < set->count; ++i)
        least_m = std::min(
            least_m, test::fcl_distance_m(transformed(base_from_tool, shape), set->obstacles[static_cast<size_t>(i)]));
    return least_m;
  }
};

void distances_of_held_shapes_are_those_of_fcl(void**) {
  Random random(11);
  int held_is_nearest = 0;
  for (int i = 0; i < 300; ++i) {
    const Scene scene(random);
    const double links_m = scene.measure(test::lwa3().other_frames).nearest.distance_m;
    const double held_m = scene.held_m();
    if (std::min(held_m, links_m) < 0.0) continue;
    const Clearance clearance = scene.measure(scene.others());
    check_near(clearance.nearest.distance_m, std::min(held_m, links_m), 1.5e-3);  // FCL's boxes
    held_is_nearest += clearance.nearest.shape >= static_cast<int>(test::lwa3().shapes.size());
  }
  check(held_is_nearest > 30, "%d", held_is_nearest);
}

void an_allowed_obstacle_with_the_id_of_a_held_shape_is_not_avoided(void**) {
  Random random(12);
  for (int i = 0; i < 50; ++i) {
    Scene scene(random);
    const OtherFrames others = scene.others();
    const int nearest = scene.measure(others).nearest.obstacle;
    scene.set->obstacles[static_cast<size_t>(nearest)].id = 102;
    assert_int_equal(scene.measure(others).nearest.obstacle, nearest);  // not allowed
    scene.attachments.allowed.add(102);
    const Clearance clearance = scene.measure(others);
    assert_int_not_equal(clearance.nearest.obstacle, nearest);
    for (const NearPair& pair : clearance.near) assert_int_not_equal(pair.now.obstacle, nearest);
  }
}

void the_tool_and_what_it_holds_may_touch_what_is_allowed_and_the_other_links_may_not(void**) {
  Random random(13);
  const Arm& arm = test::lwa3();
  for (int i = 0; i < 50; ++i) {
    Scene scene(random);
    for (int id = 0; id < scene.set->count; ++id) scene.attachments.allowed.add(id);
    const OtherFrames others = scene.others();
    const LinkPoses poses = forward_kinematics(arm, scene.q_rad, others);
    const Clearance allowed = scene.measure(others);
    for (const NearPair& pair : allowed.near)
      check(shape_at(arm, poses, pair.now.shape).body < 7, "%d", pair.now.shape);
    const double predicted_m = clearance_after(arm, poses, scene.set->obstacles.data(), scene.set->count, 0.0, 10.0);
    double expected_m = 10.0;
    for (const NearPair& pair : allowed.near) expected_m = std::min(expected_m, pair.now.distance_m);
    check_near(predicted_m, expected_m, 1e-9);
  }
}

void a_prediction_counts_held_shapes(void**) {
  Random random(14);
  for (int i = 0; i < 100; ++i) {
    const Scene scene(random);
    const double held_m = scene.held_m();
    const OtherFrames others = scene.others();
    const LinkPoses poses = forward_kinematics(test::lwa3(), scene.q_rad, others);
    const double found_m =
        clearance_after(test::lwa3(), poses, scene.set->obstacles.data(), scene.set->count, 0.0, 10.0);
    if (held_m > 0.0) check(found_m < held_m + 1.5e-3, "%g m, FCL %g m", found_m, held_m);
  }
}

void held_shapes_pair_with_the_links_of_all_bodies_but_the_last_two(void**) {
  Random random(15);
  const Scene scene(random);
  const Arm& arm = test::lwa3();
  int pairs = 0, expected = 0;
  for (const LinkShape& shape : arm.shapes) expected += shape.body < 6;
  for_each_held_pair(arm, scene.attachments, [&](const SelfPair& pair) {
    ++pairs;
    assert_true(arm.shapes[static_cast<size_t>(pair.first)].body < 6);
    assert_in_range(pair.second, arm.shapes.size(), arm.shapes.size() + 3);
  });
  assert_int_equal(pairs, 4 * expected);
}

void attachments_are_the_same_whatever_their_time(void**) {
  Random random(16);
  const Scene scene(random);
  Attachments other = scene.attachments;
  other.utime += 10;
  assert_true(are_same(scene.attachments, other));
  other.allowed.add(3);
  assert_false(are_same(scene.attachments, other));
  other = scene.attachments;
  other.shapes[1].capsule.start.x() += 1e-6;
  assert_false(are_same(scene.attachments, other));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(distances_of_held_shapes_are_those_of_fcl),
      cmocka_unit_test(an_allowed_obstacle_with_the_id_of_a_held_shape_is_not_avoided),
      cmocka_unit_test(the_tool_and_what_it_holds_may_touch_what_is_allowed_and_the_other_links_may_not),
      cmocka_unit_test(a_prediction_counts_held_shapes),
      cmocka_unit_test(held_shapes_pair_with_the_links_of_all_bodies_but_the_last_two),
      cmocka_unit_test(attachments_are_the_same_whatever_their_time),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
