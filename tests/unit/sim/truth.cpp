#include "host/sim/truth.h"

#include <algorithm>
#include <array>
#include <set>

#include "firmware/model/link_proximity.h"
#include "firmware/model/load/load_arm.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep::sim;
using Eigen::Vector3d;
using sidestep::test::Random;

namespace {

Truth lwa3() {
  return Truth(Arm("urdf/lwa3.urdf", "base_link", "tool"));
}

JointVector home_rad() {
  JointVector q_rad = JointVector::Zero(7);
  q_rad[1] = M_PI / 2, q_rad[3] = -M_PI / 2;
  return q_rad;
}

Obstacle ball(const Vector3d& position_m, double radius_m = 0.05) {
  Obstacle obstacle;
  obstacle.solid = {Shape::kSphere, {radius_m, 0, 0}};
  obstacle.motion.position_m = position_m;
  return obstacle;
}

/// Shoulder, elbow, wrist and tool point by Craig's D-H convention (docs/paper.md, "The arm"), independent of the URDF.
std::array<Vector3d, 4> stations(const JointVector& q_rad) {
  const double alpha_deg[] = {0, 90, -90, 90, -90, 90, -90}, d_m[] = {0.3, 0, 0.328, 0, 0.2765, 0, 0};
  std::array<Vector3d, 4> stations;
  Eigen::Matrix4d base_from_i = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 7; ++i) {
    const double c = std::cos(q_rad[i]), s = std::sin(q_rad[i]);
    const double ca = std::cos(alpha_deg[i] * M_PI / 180), sa = std::sin(alpha_deg[i] * M_PI / 180);
    Eigen::Matrix4d step;
    step << c, -s, 0, 0, s * ca, c * ca, -sa, -d_m[i] * sa, s * sa, c * sa, ca, d_m[i] * ca, 0, 0, 0, 1;
    base_from_i = base_from_i * step;
    if (i % 2 == 0 && i < 6) stations[i / 2] = base_from_i.topRightCorner<3, 1>();
  }
  stations[3] = (base_from_i * Eigen::Vector4d(0, 0, 0.3372, 1)).head<3>();
  return stations;
}

double to_segment_m(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - along * (b - a)).norm();
}

/// Distance of a point to the axes of the moving links and, with `fixed`, of the base column.
double to_arm_m(const Vector3d& p, const JointVector& q_rad, bool fixed) {
  const auto s = stations(q_rad);
  const double moving_m =
      std::min({to_segment_m(p, s[0], s[1]), to_segment_m(p, s[1], s[2]), to_segment_m(p, s[2], s[3])});
  return fixed ? std::min(moving_m, to_segment_m(p, Vector3d::Zero(), s[0])) : moving_m;
}

void the_tool_at_home_is_at_the_position_of_the_paper(void**) {
  Truth truth = lwa3();
  truth.place(home_rad());
  check_near(truth.tool_m(), Vector3d(-0.328, 0, 0.9137), 1e-12);
}

void the_tool_agrees_with_the_dh_table_of_the_paper(void**) {
  Truth truth = lwa3();
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const JointVector q_rad = random.joints(7, -3, 3);
    truth.place(q_rad);
    check_near(truth.tool_m(), stations(q_rad)[3], 1e-12);
  }
}

void the_arm_at_home_is_0_2490_m_from_the_third_obstacle(void**) {
  Truth truth = lwa3();
  truth.place(home_rad());
  check_near(truth.axis_distance_m(ball({-0.1, 0.1, 0.8})), 0.2490, 5e-5);
  check_near(truth.clearance_m(ball({-0.1, 0.1, 0.8})), 0.1490, 5e-5);
}

void clearance_agrees_with_capsules_in_random_configurations(void**) {
  Truth truth = lwa3();
  Random random(2);
  int touching = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const JointVector q_rad = random.joints(7, -3, 3);
    const Obstacle obstacle = ball(random.inside(-0.6, 0.6) + Vector3d(0, 0, 0.6), random.uniform(0.01, 0.4));
    truth.place(q_rad);
    const double clearance_m = truth.clearance_m(obstacle);
    const double to_axis_m = to_arm_m(obstacle.motion.position_m, q_rad, true);
    const double expected_m = to_axis_m - 0.05 - obstacle.solid.size_m.x();
    check_near(truth.axis_distance_m(obstacle), to_arm_m(obstacle.motion.position_m, q_rad, false), 1e-12);
    touching += clearance_m < 0;
    if (to_axis_m > 0.05) {
      check_near_because(clearance_m, expected_m, 1e-12, "trial %d", trial);
    } else {  // the centre is inside the arm; the distance is that of single cylinders and spheres
      check(clearance_m < 0 && clearance_m >= expected_m - 1e-12, "trial %d: %g", trial, clearance_m);
    }
  }
  check(touching > 200 && touching < 2800, "%d of 3000 touch: the trials do not cover both cases", touching);
}

void the_base_column_counts_for_clearance_but_not_for_the_axis_distance(void**) {
  Truth truth = lwa3();
  truth.place(JointVector::Zero(7));
  const Obstacle low = ball({0.3, 0, 0});
  check_near(truth.clearance_m(low), 0.2, 1e-12);
  check_near(truth.axis_distance_m(low), std::hypot(0.3, 0.3), 1e-12);
  assert_string_equal(truth.nearest({low}).link.c_str(), "base_link");
}

/// A finger 0.2 m beyond the tool on a prismatic joint, which is at 0.
void a_finger_below_the_tool_counts_for_clearance(void**) {
  const std::string finger = R"(<link name="finger"><collision><geometry><sphere radius="0.03"/></geometry></collision>
    </link><joint name="slide" type="prismatic"><parent link="tool"/><child link="finger"/><origin xyz="0 0 0.2"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" velocity="1" effort="1"/></joint></robot>)";
  const std::string urdf = sidestep::test::replaced(sidestep::test::text_of("urdf/lwa3.urdf"), "</robot>", finger);
  Truth truth(Arm(sidestep::test::scratch_file("finger.urdf", urdf), "base_link", "tool"));
  truth.place(home_rad());
  const Obstacle inside = ball(truth.arm().base_from_tool() * Vector3d(0, 0, 0.2), 0.01);
  check_near(truth.clearance_m(inside), -0.04, 1e-9);
  assert_string_equal(truth.nearest({inside}).link.c_str(), "finger");
}

void clearance_of_boxes_and_capsules_agrees_with_hand_computed_ones(void**) {
  Truth truth = lwa3();
  truth.place(JointVector::Zero(7));
  Obstacle wall = ball({0.5, 0, 0.5});
  wall.solid = {Shape::kBox, {0.2, 3, 3}};
  check_near(truth.clearance_m(wall), 0.35, 1e-7);
  Obstacle bar = ball({0.2, 0.2, 1});
  bar.solid = {Shape::kCapsule, {0.02, 0.5, 0}};
  check_near(truth.clearance_m(bar), std::hypot(0.2, 0.2) - 0.07, 1e-7);
  bar.motion.orientation = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX());  // along y
  check_near(truth.clearance_m(bar), 0.2 - 0.07, 1e-7);
  bar.motion.position_m.x() = 0.06;
  check_near(truth.clearance_m(bar), 0.06 - 0.07, 1e-7);
}

void the_nearest_obstacle_has_the_smallest_clearance(void**) {
  Truth truth = lwa3();
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    truth.place(random.joints(7, -2, 2));
    std::vector<Obstacle> obstacles;
    for (int i = 0; i < 40; ++i) {
      obstacles.push_back(ball(random.inside(-1, 1)));
      const Shape shapes[] = {Shape::kSphere, Shape::kCapsule, Shape::kBox};
      obstacles.back().solid = {shapes[i % 3], random.inside(0.02, 0.2)};
      obstacles.back().motion.orientation = random.turn();
    }
    double clearance_m = kNothingNear, axis_distance_m = kNothingNear;
    for (const Obstacle& obstacle : obstacles) {
      clearance_m = std::min(clearance_m, truth.clearance_m(obstacle));
      axis_distance_m = std::min(axis_distance_m, truth.axis_distance_m(obstacle));
    }
    const Nearest nearest = truth.nearest(obstacles);
    check_near(nearest.clearance_m, clearance_m, 0);
    check_near(truth.clearance_m(obstacles[static_cast<size_t>(nearest.obstacle)]), clearance_m, 0);
    check_near(truth.axis_distance_m(obstacles), axis_distance_m, 0);
  }
}

void without_obstacles_the_clearance_is_infinite(void**) {
  Truth truth = lwa3();
  truth.place(home_rad());
  check_near(truth.nearest({}).clearance_m, kNothingNear, 0);
  assert_int_equal(truth.nearest({}).obstacle, -1);
  check_near(truth.axis_distance_m(std::vector<Obstacle>{}), kNothingNear, 0);
}

void links_as_obstacles_are_in_the_frame_of_the_other_arm(void**) {
  Truth truth = lwa3(), other = lwa3();
  const auto apart_m = [&](double x_m) {
    Eigen::Isometry3d base_from_other = Eigen::Isometry3d::Identity();
    base_from_other.translation().x() = x_m;
    return truth.nearest(other.links(base_from_other)).clearance_m;
  };
  for (const double q_rad : {0.0, 0.7}) {  // both arms in the same configuration
    truth.place(JointVector::Constant(7, q_rad));
    other.place(JointVector::Constant(7, q_rad));
    assert_true(apart_m(0.0) < 0.0);
    const double far_m = apart_m(3.0);
    assert_true(far_m > 0.0);
    check(apart_m(3.5) > far_m && apart_m(3.5) <= far_m + 0.5 + 1e-9, "%g m", apart_m(3.5));
  }
}

/// "first second" of every judged pair of links, each pair in both orders.
std::set<std::string> judged_pairs(const Truth& truth) {
  std::set<std::string> names;
  for (const ArmPart& a : truth.arm().parts())
    for (const ArmPart& b : truth.arm().parts())
      if (truth.self_distance().judges(truth.arm(), a.link, b.link)) names.insert(a.link + ' ' + b.link);
  return names;
}

void links_of_the_lwa3_that_can_meet_are_judged(void**) {
  const std::set<std::string> expected{"base_link forearm_link",   "forearm_link base_link",
                                       "base_link hand_link",      "hand_link base_link",
                                       "upper_arm_link hand_link", "hand_link upper_arm_link"};
  assert_true(judged_pairs(lwa3()) == expected);
}

void a_folded_lwa3_touches_itself_and_a_straight_one_does_not(void**) {
  Truth truth = lwa3();
  truth.place(JointVector::Zero(7));
  // The hand's lower end is the elbow's height plus the forearm's length from the upper arm's upper end.
  check_near(truth.nearest_links().clearance_m, 0.2765 - 0.1, 1e-9);
  assert_false(truth.nearest_links(0.1).touch());
  check_near(truth.nearest_links(0.1).clearance_m, kNothingNear, 0);

  JointVector folded_rad = JointVector::Zero(7);
  folded_rad[3] = folded_rad[5] = 1.97;  // the hand returns to the upper arm
  truth.place(folded_rad);
  const NearestLinks nearest = truth.nearest_links();
  check(nearest.touch(), "%g m between %s and %s", nearest.clearance_m, nearest.first.c_str(), nearest.second.c_str());
  assert_string_equal(nearest.first.c_str(), "upper_arm_link");
  assert_string_equal(nearest.second.c_str(), "hand_link");
}

/// As the distance of the axes, which are segments of the D-H table's polyline.
void distances_between_links_agree_with_capsules_in_random_configurations(void**) {
  Truth truth = lwa3();
  Random random(4);
  int touching = 0;
  for (int trial = 0; trial < 500; ++trial) {
    JointVector q_rad = random.joints(7, -1.97, 1.97);
    if (trial % 2 == 0) q_rad[3] = random.uniform(1.7, 1.97), q_rad[4] *= 0.2, q_rad[5] = random.uniform(1.7, 1.97);
    truth.place(q_rad);
    const auto s = stations(q_rad);
    const std::array<Vector3d, 5> corners{Vector3d::Zero(), s[0], s[1], s[2], s[3]};
    double axes_m = kNothingNear;
    for (size_t a = 0; a < 4; ++a) {
      for (size_t b = a + 2; b < 4; ++b) {
        for (int i = 0; i <= 2000; ++i) {  // the error of the sampled distance is at most the square of a step
          const Vector3d p = corners[a] + i / 2000.0 * (corners[a + 1] - corners[a]);
          axes_m = std::min(axes_m, to_segment_m(p, corners[b], corners[b + 1]));
        }
      }
    }
    const NearestLinks nearest = truth.nearest_links();
    touching += nearest.touch();
    if (std::abs(axes_m - 0.1) > 1e-3) check(nearest.touch() == (axes_m < 0.1), "trial %d", trial);
    if (axes_m > 0.101) check_near_because(nearest.clearance_m, axes_m - 0.1, 2e-4, "trial %d", trial);
  }
  check(touching > 20, "only %d touch", touching);
}

const char* const kArm8 = "tests/data/arm8.urdf";

void links_of_one_body_or_of_adjacent_ones_are_not_judged(void**) {
  const Truth truth(Arm(kArm8, "mount", "flange"));
  const std::set<std::string> pairs = judged_pairs(truth);
  for (const char* pair :
       {"pedestal mount", "pedestal s1", "mount s1", "s1 s2_bracket", "s2_bracket s3", "s2_bracket camera", "s3 camera",
        "camera lens", "palm finger_left", "finger_left finger_right", "s7 palm", "s7 finger_left"})
    check(pairs.count(pair) == 0, "%s", pair);
  for (const char* pair : {"pedestal palm", "s1 camera", "s1 palm", "lens palm", "s2_bracket finger_left", "s3 s7"})
    check(pairs.count(pair) == 1, "%s", pair);
}

void links_that_touch_by_construction_are_not_judged(void**) {
  Truth truth(Arm(kArm8, "mount", "flange"));
  Random random(5);
  int contacts = 0;
  for (int trial = 0; trial < 300; ++trial) {
    JointVector q_rad = truth.arm().lower();
    for (int i = 0; i < q_rad.size(); ++i) q_rad[i] = random.uniform(q_rad[i], truth.arm().upper()[i]);
    truth.place(q_rad);
    contacts += truth.nearest_links(0.0).touch();
  }
  check(contacts > 10 && contacts < 290, "%d of 300 postures with contact", contacts);
}

void the_srdf_beside_the_urdf_exempts_no_pair_from_judgement(void**) {
  const std::string urdf = sidestep::test::scratch_file("exempt.urdf", sidestep::test::text_of("urdf/lwa3.urdf"));
  sidestep::test::scratch_file("exempt.srdf",
                               R"(<robot name="lwa3"><disable_collisions link1="upper_arm_link" link2="hand_link"
                                  reason="Never"/></robot>)");
  assert_true(judged_pairs(Truth(Arm(urdf, "base_link", "tool"))) == judged_pairs(lwa3()));
}

/// Below 4 cm the controller's distances are exact.
void distances_between_links_agree_with_the_exact_shapes_of_the_controller(void**) {
  Truth truth(Arm(kArm8, "mount", "flange"));
  const sidestep::Arm arm = sidestep::load_arm(kArm8, "mount", "flange");
  Random random(6);
  int near = 0, touching = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = random.configuration(arm);
    const sidestep::LinkPoses poses = sidestep::forward_kinematics(arm, q_rad);
    double least_m = kNothingNear;
    for (const sidestep::LinkShape& a : arm.shapes) {
      for (const sidestep::LinkShape& b : arm.shapes) {
        if (&a >= &b || !truth.self_distance().judges(truth.arm(), a.link, b.link)) continue;
        const sidestep::Capsule around_a = transformed(poses, a), around_b = transformed(poses, b);
        least_m = std::min(least_m, sidestep::measure_pair({a, poses, around_a}, {b, poses, around_b}).distance_m);
      }
    }
    truth.place(q_rad);
    const NearestLinks nearest = truth.nearest_links(0.1);
    if (least_m < -1e-3) check(nearest.touch(), "trial %d: %g m, controller %g m", trial, nearest.clearance_m, least_m);
    if (least_m < 0.0) ++touching;
    if (least_m < 1e-3) continue;
    if (least_m < sidestep::kExact_m) {
      check_near_because(nearest.clearance_m, least_m, 1e-3, "trial %d", trial);
      ++near;
    } else {
      check(nearest.clearance_m > sidestep::kExact_m - 1e-3, "trial %d: %g m", trial, nearest.clearance_m);
    }
  }
  check(near > 50 && touching > 50, "%d near, %d touching", near, touching);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(links_as_obstacles_are_in_the_frame_of_the_other_arm),
      cmocka_unit_test(the_tool_at_home_is_at_the_position_of_the_paper),
      cmocka_unit_test(the_tool_agrees_with_the_dh_table_of_the_paper),
      cmocka_unit_test(the_arm_at_home_is_0_2490_m_from_the_third_obstacle),
      cmocka_unit_test(clearance_agrees_with_capsules_in_random_configurations),
      cmocka_unit_test(the_base_column_counts_for_clearance_but_not_for_the_axis_distance),
      cmocka_unit_test(a_finger_below_the_tool_counts_for_clearance),
      cmocka_unit_test(clearance_of_boxes_and_capsules_agrees_with_hand_computed_ones),
      cmocka_unit_test(the_nearest_obstacle_has_the_smallest_clearance),
      cmocka_unit_test(links_of_the_lwa3_that_can_meet_are_judged),
      cmocka_unit_test(a_folded_lwa3_touches_itself_and_a_straight_one_does_not),
      cmocka_unit_test(distances_between_links_agree_with_capsules_in_random_configurations),
      cmocka_unit_test(links_of_one_body_or_of_adjacent_ones_are_not_judged),
      cmocka_unit_test(links_that_touch_by_construction_are_not_judged),
      cmocka_unit_test(the_srdf_beside_the_urdf_exempts_no_pair_from_judgement),
      cmocka_unit_test(distances_between_links_agree_with_the_exact_shapes_of_the_controller),
      cmocka_unit_test(without_obstacles_the_clearance_is_infinite),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
