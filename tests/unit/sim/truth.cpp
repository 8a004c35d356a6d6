#include "host/sim/truth.h"

#include <algorithm>
#include <array>

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
      cmocka_unit_test(without_obstacles_the_clearance_is_infinite),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
