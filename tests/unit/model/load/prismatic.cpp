#include <fmt/format.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "firmware/model/joint_axes.h"
#include "firmware/model/link_obstacle.h"
#include "firmware/model/load/load_arm.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::Random;

namespace {

constexpr int kArms = 40;

std::string text_of(const Vector3& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

/// A chain of 6 to 10 joints with random axes and frames, about a third of them prismatic, with a sphere on each link.
Arm random_arm(Random& random) {
  const int joints = kMinJoints + random.index(kMaxJoints - kMinJoints + 1);
  const std::string sphere =
      R"(<collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision>)";
  std::string text = "<robot name='random'><link name='l0'>" + sphere + "</link>";
  for (int i = 1; i <= joints; ++i)
    text += fmt::format(
        "<link name='l{0}'>{1}</link><joint name='j{0}' type='{2}'><parent link='l{3}'/>"
        "<child link='l{0}'/><origin xyz='{4}' rpy='{5}'/><axis xyz='{6}'/>"
        "<limit lower='-1.5' upper='2' velocity='1' effort='1'/></joint>",
        i, sphere, random.chance(0.35) ? "prismatic" : "revolute", i - 1, text_of(random.inside(-0.4, 0.4)),
        text_of(random.inside(-1.5, 1.5)), text_of(random.direction()));
  return load_arm(test::scratch_file("random.urdf", text + "</robot>"), "l0", fmt::format("l{}", joints));
}

/// Calls use(arm, q) for some configurations of random arms, which together have prismatic joints in every place.
template <typename Use>
void for_random_arms(unsigned seed, Use&& use) {
  Random random(seed);
  size_t prismatic = 0;
  for (int i = 0; i < kArms; ++i) {
    const Arm arm = random_arm(random);
    prismatic += arm.prismatic.count();
    for (int trial = 0; trial < 10; ++trial) use(arm, random.configuration(arm), random);
  }
  check(prismatic > kArms, "only %zu prismatic joints", prismatic);
}

KDL::JntArray to_kdl(const JointVector& q_rad) {
  KDL::JntArray joints(static_cast<unsigned>(q_rad.size()));
  joints.data = q_rad;
  return joints;
}

void kinematics_and_jacobian_agree_with_kdl(void**) {
  for_random_arms(1, [](const Arm& arm, const JointVector& q_rad, Random&) {
    KDL::ChainFkSolverPos_recursive position(arm.chain);
    KDL::ChainJntToJacSolver derivative(arm.chain);
    KDL::Frame frame;
    KDL::Jacobian expected(static_cast<unsigned>(arm.joints));
    assert_true(position.JntToCart(to_kdl(q_rad), frame) >= 0 && derivative.JntToJac(to_kdl(q_rad), expected) >= 0);
    const LinkPoses poses = forward_kinematics(arm, q_rad);
    check_near(poses.tool_position, Vector3(frame.p.x(), frame.p.y(), frame.p.z()), 1e-12);
    for (int i = 0; i < 3; ++i)
      check_near(Vector3(poses.tool_rotation.row(i)), Vector3(frame.M(i, 0), frame.M(i, 1), frame.M(i, 2)), 1e-12);
    check_near(tool_jacobian(poses, 6), expected.data, 1e-12);
  });
}

void the_derivatives_of_a_link_are_those_of_its_motion(void**) {
  for_random_arms(2, [](const Arm& arm, const JointVector& q_rad, Random& random) {
    const LinkShape& shape = arm.shapes[static_cast<size_t>(random.index(static_cast<int>(arm.shapes.size())))];
    const JointVector qd_radps = random.joints(arm.joints, -1.0, 1.0);
    const double dt_s = 1e-6;
    const LinkPoses now = forward_kinematics(arm, q_rad), later = forward_kinematics(arm, q_rad + dt_s * qd_radps),
                    before = forward_kinematics(arm, q_rad - dt_s * qd_radps);
    const Vector3 velocity_mps =
        (transformed(later, shape).centre() - transformed(before, shape).centre()) / (2.0 * dt_s);
    const Vector3 centre = transformed(now, shape).centre(), direction = random.direction();
    check_near(point_jacobian(now, shape.body, centre) * qd_radps, velocity_mps, 1e-8);
    check_near(JointAxes(now).row(shape.body, centre, direction).dot(qd_radps), direction.dot(velocity_mps), 1e-8);

    const Obstacle link = link_obstacle(now, shape, qd_radps);
    const Matrix3 turn =
        later.rotation[static_cast<size_t>(shape.body)] * before.rotation[static_cast<size_t>(shape.body)].transpose();
    const Eigen::AngleAxisd angle(turn);
    check_near(link.velocity_mps, velocity_mps, 1e-8);
    check_near(link.angular_velocity_radps, Vector3(angle.angle() * angle.axis() / (2.0 * dt_s)), 1e-6);
  });
}

void a_lift_has_the_limits_of_the_urdf_and_a_gentle_acceleration(void**) {
  const Arm arm = load_arm("tests/data/lift_arm.urdf", "mast", "tool");
  assert_int_equal(arm.joints, 8);
  assert_true(arm.prismatic[0] && arm.prismatic.count() == 1);
  check_near(arm.limits.upper_rad[0], 0.6, 0.0);
  check_near(arm.limits.velocity_radps[0], 0.3, 0.0);
  check_near(arm.limits.acceleration_radps2[0], kDefaultAcceleration_mps2, 0.0);
  check_near(arm.limits.acceleration_radps2[1], kDefaultAcceleration_radps2, 0.0);
  check_near(arm.joint_scale[0], kPrismaticScale_m, 0.0);
  check_near(arm.joint_scale.tail(7), Eigen::VectorXd::Ones(7), 0.0);
}

void a_lift_without_an_end_is_refused(void**) {
  Arm arm = load_arm("tests/data/lift_arm.urdf", "mast", "tool");
  arm.limits.upper_rad[0] = std::numeric_limits<double>::infinity();
  const std::string error = test::message_of([&] { check_limits(arm); });
  check(test::one_line_with(error, {"'lift'"}), "%s", error.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(kinematics_and_jacobian_agree_with_kdl),
      cmocka_unit_test(the_derivatives_of_a_link_are_those_of_its_motion),
      cmocka_unit_test(a_lift_has_the_limits_of_the_urdf_and_a_gentle_acceleration),
      cmocka_unit_test(a_lift_without_an_end_is_refused),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
