#include <urdf_parser/urdf_parser.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/tree.hpp>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>
#include <vector>

#include "firmware/model/kinematics.h"
#include "firmware/model/load/load_arm.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::message_of;
using test::Random;

namespace {

struct Kind {
  const char* file;
  const char* base;
  const char* tip;
  int joints;
  size_t shapes;
};

const Kind kKinds[] = {
    {"tests/data/arm6.urdf", "foot", "tip", 6, 7},          {"tests/data/arm8.urdf", "mount", "flange", 8, 13},
    {"tests/data/arm10.urdf", "l0", "l10", 10, 6},          {"urdf/lwa3.urdf", "base_link", "tool", 7, 4},
    {"urdf/lwa3.urdf", "shoulder_link", "hand_link", 6, 3},
};

KDL::JntArray to_kdl(const JointVector& q_rad) {
  KDL::JntArray joints(static_cast<unsigned>(q_rad.size()));
  joints.data = q_rad;
  return joints;
}

Vector3 to_eigen(const KDL::Vector& v) {
  return Vector3(v.x(), v.y(), v.z());
}

void every_kind_of_arm_loads(void**) {
  for (const Kind& kind : kKinds) {
    const std::string error = message_of([&] { load_arm(kind.file, kind.base, kind.tip); });
    check(error.empty(), "%s", error.c_str());
    const Arm arm = load_arm(kind.file, kind.base, kind.tip);
    check(arm.joints == kind.joints, "%s: %d joints", kind.file, arm.joints);
    check(arm.shapes.size() == kind.shapes, "%s: %zu shapes", kind.file, arm.shapes.size());
    check(arm.limits.velocity_radps.size() == kind.joints, "%s", kind.file);
    check(message_of([&] { check_limits(arm); }).empty(), "%s", kind.file);
  }
}

void fk_agrees_with_kdl_for_any_axes(void**) {
  for (const Kind& kind : kKinds) {
    const Arm arm = load_arm(kind.file, kind.base, kind.tip);
    KDL::ChainFkSolverPos_recursive solver(arm.chain);
    Random random(1);
    for (int trial = 0; trial < 200; ++trial) {
      const JointVector q_rad = random.configuration(arm);
      KDL::Frame frame;
      assert_true(solver.JntToCart(to_kdl(q_rad), frame) >= 0);
      const LinkPoses poses = forward_kinematics(arm, q_rad);
      check_near_because(poses.tool_position, to_eigen(frame.p), 1e-12, "%s, trial %d", kind.file, trial);
      for (int i = 0; i < 3; ++i)
        check_near_because(Vector3(poses.tool_rotation.row(i)), Vector3(frame.M(i, 0), frame.M(i, 1), frame.M(i, 2)),
                           1e-12, "%s, trial %d", kind.file, trial);
    }
  }
}

void the_jacobian_agrees_with_kdl_for_any_axes(void**) {
  for (const Kind& kind : kKinds) {
    const Arm arm = load_arm(kind.file, kind.base, kind.tip);
    KDL::ChainJntToJacSolver solver(arm.chain);
    KDL::Jacobian expected(static_cast<unsigned>(arm.joints));
    Random random(2);
    for (int trial = 0; trial < 200; ++trial) {
      const JointVector q_rad = random.configuration(arm);
      assert_true(solver.JntToJac(to_kdl(q_rad), expected) >= 0);
      check_near_because(tool_jacobian(forward_kinematics(arm, q_rad), 6), expected.data, 1e-12, "%s, trial %d",
                         kind.file, trial);
    }
  }
}

/// The expected capsule of a collision shape, in the frame of the shape.
Capsule local_capsule(const urdf::Geometry& geometry) {
  if (geometry.type == urdf::Geometry::SPHERE)
    return {Vector3::Zero(), Vector3::Zero(), static_cast<const urdf::Sphere&>(geometry).radius};
  if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    return {Vector3(0, 0, -cylinder.length / 2), Vector3(0, 0, cylinder.length / 2), cylinder.radius};
  }
  const auto& box = static_cast<const urdf::Box&>(geometry);
  return capsule_around_box(Vector3(box.dim.x, box.dim.y, box.dim.z));
}

KDL::Vector at(const KDL::Frame& frame, const Vector3& p) {
  return frame * KDL::Vector(p.x(), p.y(), p.z());
}

/// The capsules of a link by KDL's tree solver, with the joints of side branches at zero.
std::vector<Capsule> expected_capsules(const urdf::ModelInterface& model, const KDL::Tree& tree, const Arm& arm,
                                       const std::string& base, const std::string& link, const JointVector& q_rad) {
  KDL::JntArray joints(tree.getNrOfJoints());
  for (int i = 0; i < arm.joints; ++i)
    for (const auto& [name, element] : tree.getSegments())
      if (element.segment.getJoint().getName() == arm.joint_names[static_cast<size_t>(i)])
        joints(element.q_nr) = q_rad[i];
  KDL::TreeFkSolverPos_recursive solver(tree);
  KDL::Frame root_from_base, root_from_link;
  solver.JntToCart(joints, root_from_base, base);
  solver.JntToCart(joints, root_from_link, link);
  std::vector<Capsule> capsules;
  for (const auto& collision : model.getLink(link)->collision_array) {
    const auto& r = collision->origin.rotation;
    const auto& p = collision->origin.position;
    const KDL::Frame base_from_shape = root_from_base.Inverse() * root_from_link *
                                       KDL::Frame(KDL::Rotation::Quaternion(r.x, r.y, r.z, r.w), {p.x, p.y, p.z});
    const Capsule local = local_capsule(*collision->geometry);
    capsules.push_back(
        {to_eigen(at(base_from_shape, local.start)), to_eigen(at(base_from_shape, local.end)), local.radius_m});
  }
  return capsules;
}

/// All shapes of arm6 and arm8 exist, belong to the right body and are where KDL computes them in any configuration.
void shapes_stay_on_their_links(void**) {
  for (const Kind& kind : {kKinds[0], kKinds[1]}) {
    const Arm arm = load_arm(kind.file, kind.base, kind.tip);
    const auto model = urdf::parseURDFFile(kind.file);
    KDL::Tree tree;
    assert_true(kdl_parser::treeFromUrdfModel(*model, tree));
    Random random(3);
    for (int trial = 0; trial < 20; ++trial) {
      const JointVector q_rad = random.configuration(arm);
      const LinkPoses poses = forward_kinematics(arm, q_rad);
      std::map<std::string, size_t> used;
      for (const LinkShape& shape : arm.shapes) {
        const auto expected = expected_capsules(*model, tree, arm, kind.base, shape.link, q_rad);
        const size_t i = used[shape.link]++;
        check(i < expected.size(), "%s: link '%s' has too many shapes", kind.file, shape.link.c_str());
        const Capsule capsule = transformed(poses, shape);
        check_near_because(capsule.start, expected[i].start, 1e-9, "%s, '%s'", kind.file, shape.link.c_str());
        check_near_because(capsule.end, expected[i].end, 1e-9, "%s, '%s'", kind.file, shape.link.c_str());
        check_near_because(capsule.radius_m, expected[i].radius_m, 0, "%s, '%s'", kind.file, shape.link.c_str());
      }
    }
  }
}

void the_links_attached_to_the_arm_and_those_below_it_belong_to_the_right_body(void**) {
  const Arm arm = load_arm("tests/data/arm8.urdf", "mount", "flange");
  std::map<std::string, int> body_of;
  for (const LinkShape& shape : arm.shapes) body_of[shape.link] = shape.body;
  const std::map<std::string, int> expected = {
      {"pedestal", 0}, {"mount", 0}, {"s1", 1},   {"s2_bracket", 2},  {"s3", 3},           {"camera", 3}, {"lens", 3},
      {"s5", 5},       {"s7", 7},    {"palm", 8}, {"finger_left", 8}, {"finger_right", 8}, {"knuckle", 8}};
  assert_true(body_of == expected);
}

void a_continuous_joint_has_no_position_limits(void**) {
  const JointLimits limits = load_arm("tests/data/arm6.urdf", "foot", "tip").limits;
  const double infinity = std::numeric_limits<double>::infinity();
  const double lower[] = {-3, -2, -infinity, -2.5, -1.5, -infinity}, upper[] = {2.5, 2, infinity, 2.6, 1.4, infinity};
  const double velocity[] = {1.5, 1.6, 1.7, 1.8, 1.9, 2.1};
  for (int i = 0; i < 6; ++i) {
    check_near_because(limits.lower_rad[i], lower[i], 0, "joint %d", i);
    check_near_because(limits.upper_rad[i], upper[i], 0, "joint %d", i);
    check_near_because(limits.velocity_radps[i], velocity[i], 0, "joint %d", i);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_kind_of_arm_loads),
      cmocka_unit_test(fk_agrees_with_kdl_for_any_axes),
      cmocka_unit_test(the_jacobian_agrees_with_kdl_for_any_axes),
      cmocka_unit_test(shapes_stay_on_their_links),
      cmocka_unit_test(the_links_attached_to_the_arm_and_those_below_it_belong_to_the_right_body),
      cmocka_unit_test(a_continuous_joint_has_no_position_limits),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
