#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::home_rad;
using test::lwa3;
using test::Random;

namespace {

/// The chain of docs/paper.md, "The arm": Craig's convention, signs of alpha flipped, a = 0, then the tool.
Eigen::Isometry3d craig(const JointVector& q_rad) {
  const double alpha_rad[] = {0, M_PI / 2, -M_PI / 2, M_PI / 2, -M_PI / 2, M_PI / 2, -M_PI / 2};
  const double d_m[] = {0.300, 0, 0.328, 0, 0.2765, 0, 0};
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 7; ++i) {
    const double c = std::cos(q_rad[i]), s = std::sin(q_rad[i]);
    const double ca = std::cos(alpha_rad[i]), sa = std::sin(alpha_rad[i]), d = d_m[i];
    Eigen::Matrix4d link;
    link << c, -s, 0, 0, s * ca, c * ca, -sa, -d * sa, s * sa, c * sa, ca, d * ca, 0, 0, 0, 1;
    pose = pose * link;
  }
  Eigen::Isometry3d tool(pose);
  return tool * Eigen::Translation3d(0, 0, 0.3372);
}

KDL::JntArray to_kdl(const JointVector& q_rad) {
  KDL::JntArray joints(static_cast<unsigned>(q_rad.size()));
  joints.data = q_rad;
  return joints;
}

void home_is_the_papers_home(void**) {
  const LinkPoses poses = forward_kinematics(lwa3(), home_rad());
  check_near(poses.tool_position, Vector3(-0.328, 0, 0.9137), 1e-9);
  check_near(poses.tool_rotation, Matrix3(Matrix3::Identity()), 1e-9);
}

void fk_agrees_with_the_dh_chain_in_random_configurations(void**) {
  Random random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = random.configuration(lwa3());
    const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
    check_near_because(poses.tool_position, Vector3(craig(q_rad).translation()), 1e-12, "trial %d", trial);
    check_near_because(poses.tool_rotation, Matrix3(craig(q_rad).linear()), 1e-12, "trial %d", trial);
  }
}

void fk_agrees_with_kdl_in_random_configurations(void**) {
  KDL::ChainFkSolverPos_recursive solver(lwa3().chain);
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = random.configuration(lwa3());
    KDL::Frame frame;
    assert_int_equal(solver.JntToCart(to_kdl(q_rad), frame), 0);
    const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
    for (int row = 0; row < 3; ++row) {
      check_near_because(poses.tool_position[row], frame.p[row], 1e-12, "trial %d", trial);
      for (int column = 0; column < 3; ++column)
        check_near_because(poses.tool_rotation(row, column), frame.M(row, column), 1e-12, "trial %d", trial);
    }
  }
}

void the_tool_jacobian_agrees_with_kdl_in_random_configurations(void**) {
  KDL::ChainJntToJacSolver solver(lwa3().chain);
  Random random(3);
  KDL::Jacobian expected(7);
  for (int trial = 0; trial < 1000; ++trial) {
    const JointVector q_rad = random.configuration(lwa3());
    assert_int_equal(solver.JntToJac(to_kdl(q_rad), expected), 0);
    const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
    check_near_because(tool_jacobian(poses, 6), expected.data, 1e-12, "trial %d", trial);
    check_near_because(tool_jacobian(poses, 3), expected.data.topRows<3>(), 1e-12, "trial %d", trial);
  }
}

void a_point_jacobian_is_the_derivative_of_the_point(void**) {
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const JointVector q_rad = random.configuration(lwa3());
    const int body = random.index(8);
    const Vector3 p_body = random.inside(-0.3, 0.3);
    const auto position = [&](const JointVector& q) {
      const LinkPoses poses = forward_kinematics(lwa3(), q);
      const size_t i = static_cast<size_t>(body);
      return Vector3(poses.origin[i] + poses.rotation[i] * p_body);
    };
    PointJacobian expected(3, 7);
    for (int joint = 0; joint < 7; ++joint) {
      JointVector after = q_rad, before = q_rad;
      after[joint] += 1e-5;
      before[joint] -= 1e-5;
      expected.col(joint) = (position(after) - position(before)) / 2e-5;
    }
    const PointJacobian jacobian = point_jacobian(forward_kinematics(lwa3(), q_rad), body, position(q_rad));
    check_near_because(jacobian, expected, 1e-8, "trial %d, body %d", trial, body);
    for (int joint = body; joint < 7; ++joint) check(jacobian.col(joint).isZero(0.0), "joint beyond body %d", body);
  }
}

void the_arm_is_four_capsules_of_five_centimetres(void**) {
  const Arm& arm = lwa3();
  assert_int_equal(arm.joints, 7);
  assert_int_equal(arm.shapes.size(), 4);
  const struct {
    const char* link;
    int body;
    double length_m;
  } expected[] = {
      {"base_link", 0, 0.3}, {"upper_arm_link", 3, 0.328}, {"forearm_link", 5, 0.2765}, {"hand_link", 7, 0.3372}};
  for (size_t i = 0; i < 4; ++i) {
    const LinkShape& shape = arm.shapes[i];
    assert_string_equal(shape.link.c_str(), expected[i].link);
    assert_int_equal(shape.body, expected[i].body);
    check_near(shape.capsule_body.radius_m, 0.05, 1e-15);
    check_near((shape.capsule_body.end - shape.capsule_body.start).norm(), expected[i].length_m, 1e-12);
  }
}

/// Shoulder, elbow, wrist and tool point are the ends of the capsules' axes in any configuration.
void the_capsules_join_shoulder_elbow_wrist_and_tool(void**) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const LinkPoses poses = forward_kinematics(lwa3(), random.configuration(lwa3()));
    const Vector3 joints[] = {Vector3::Zero(), poses.origin[1], poses.origin[3], poses.origin[5], poses.tool_position};
    check_near(joints[1], Vector3(0, 0, 0.3), 1e-12);
    for (size_t i = 0; i < 4; ++i) {
      const Capsule capsule = transformed(poses, lwa3().shapes[i]);
      const bool rotated = (capsule.start - joints[i]).norm() > (capsule.end - joints[i]).norm();
      check_near_because(rotated ? capsule.end : capsule.start, joints[i], 1e-12, "trial %d, shape %zu", trial, i);
      check_near_because(rotated ? capsule.start : capsule.end, joints[i + 1], 1e-12, "trial %d, shape %zu", trial, i);
    }
  }
}

void limits_are_those_of_the_public_models(void**) {
  const JointLimits& limits = lwa3().limits;
  for (int i = 0; i < 7; ++i) {
    const double reach_rad = i % 2 ? 1.97 : 6.25;
    check_near_because(limits.upper_rad[i], reach_rad, 0, "joint %d", i);
    check_near_because(limits.lower_rad[i], -reach_rad, 0, "joint %d", i);
    check_near_because(limits.velocity_radps[i], 2.0, 0, "joint %d", i);
    check_near_because(limits.acceleration_radps2[i], kDefaultAcceleration_radps2, 0, "joint %d", i);
    check(lwa3().joint_names[static_cast<size_t>(i)] == "joint_" + std::to_string(i + 1), "joint %d", i);
  }
  check_limits(lwa3());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(home_is_the_papers_home),
      cmocka_unit_test(fk_agrees_with_the_dh_chain_in_random_configurations),
      cmocka_unit_test(fk_agrees_with_kdl_in_random_configurations),
      cmocka_unit_test(the_tool_jacobian_agrees_with_kdl_in_random_configurations),
      cmocka_unit_test(a_point_jacobian_is_the_derivative_of_the_point),
      cmocka_unit_test(the_arm_is_four_capsules_of_five_centimetres),
      cmocka_unit_test(the_capsules_join_shoulder_elbow_wrist_and_tool),
      cmocka_unit_test(limits_are_those_of_the_public_models),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
