// Links behind movable joints that are no part of the chain, checked against KDL.

#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <kdl/tree.hpp>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "firmware/model/kinematics.h"
#include "firmware/model/load/load_arm.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::Random;

namespace {

constexpr const char* kUrdf = "tests/data/lift_arm.urdf";
const JointPositions kPositions = {{"head_joint", 0.5}, {"left_1", 0.4}, {"left_2", -1.0}, {"left_finger_joint", 0.03}};

Arm on_the_mast(const JointPositions& positions = kPositions) {
  return load_arm(kUrdf, "mast", "tool", {}, positions);
}

/// The same robot with the lift below the base.
Arm on_the_carriage(JointPositions positions = kPositions) {
  positions["lift"] = 0.35;
  return load_arm(kUrdf, "carriage", "tool", {}, positions);
}

bool has_link(const Arm& arm, const std::string& link) {
  return std::any_of(arm.shapes.begin(), arm.shapes.end(), [&](const LinkShape& shape) { return shape.link == link; });
}

/// Poses of all links by KDL, in the frame of the base link.
class Reference {
 public:
  Reference(const std::string& base) : base_(base) {
    assert_true(kdl_parser::treeFromUrdfModel(*urdf::parseURDFFile(kUrdf), tree_));
    joints_ = KDL::JntArray(tree_.getNrOfJoints());
  }
  void set(const std::string& joint, double position) {
    for (const auto& [name, element] : tree_.getSegments())
      if (element.segment.getJoint().getName() == joint) joints_(element.q_nr) = position;
  }
  KDL::Frame base_from(const std::string& link) const {
    KDL::TreeFkSolverPos_recursive solver(tree_);
    KDL::Frame root_from_base, root_from_link;
    solver.JntToCart(joints_, root_from_base, base_);
    solver.JntToCart(joints_, root_from_link, link);
    return root_from_base.Inverse() * root_from_link;
  }

 private:
  std::string base_;
  KDL::Tree tree_;
  KDL::JntArray joints_;
};

/// The centre of a link's only shape in the frame of the link.
KDL::Vector centre_in(const std::string& link) {
  static const auto model = urdf::parseURDFFile(kUrdf);
  const auto& p = model->getLink(link)->collision_array.at(0)->origin.position;
  return {p.x, p.y, p.z};
}

void check_shapes(const Arm& arm, const LinkPoses& poses, const Reference& reference) {
  for (const LinkShape& shape : arm.shapes) {
    if (shape.link == "platform") continue;  // a box: several capsules
    const KDL::Vector expected = reference.base_from(shape.link) * centre_in(shape.link);
    check_near_because(transformed(poses, shape).centre(), Vector3(expected.x(), expected.y(), expected.z()), 1e-9,
                       "link '%s'", shape.link.c_str());
  }
}

void set_chain(Reference& reference, const Arm& arm, const JointVector& q_rad) {
  for (int i = 0; i < arm.joints; ++i) reference.set(arm.joint_names[static_cast<size_t>(i)], q_rad[i]);
}

void links_behind_other_joints_are_where_their_positions_put_them(void**) {
  Random random(1);
  for (const bool carried : {false, true}) {
    const Arm arm = carried ? on_the_carriage() : on_the_mast();
    for (const char* link : {"mast", "head", "left_upper", "left_lower", "left_finger", "right_finger", "platform"})
      check(has_link(arm, link), "'%s' is missing", link);
    check(arm.warnings.empty(), "%s", arm.warnings.empty() ? "" : arm.warnings[0].c_str());
    Reference reference(carried ? "carriage" : "mast");
    if (carried) reference.set("lift", 0.35);
    for (const auto& [joint, position] : kPositions) reference.set(joint, position);
    reference.set("right_finger_joint", 0.03);
    for (int trial = 0; trial < 20; ++trial) {
      const JointVector q_rad = random.configuration(arm);
      set_chain(reference, arm, q_rad);
      check_shapes(arm, forward_kinematics(arm, q_rad), reference);
    }
  }
}

void they_follow_other_positions_and_so_do_mimics(void**) {
  Random random(2);
  const Arm arm = on_the_carriage();
  Reference reference("carriage");
  for (int trial = 0; trial < 50; ++trial) {
    OtherJoints others = arm.other_positions;
    for (size_t j = 0; j < arm.other_joints.size(); ++j) {
      const OtherJoint& joint = arm.other_joints[j];
      if (joint.mimics >= 0) continue;
      others.position[j] = random.uniform(-1.0, 1.0);
      reference.set(joint.name, others.position[j]);
      if (joint.name == "left_finger_joint") reference.set("right_finger_joint", others.position[j]);
    }
    const JointVector q_rad = random.configuration(arm);
    set_chain(reference, arm, q_rad);
    const OtherFrames frames = place_other_joints(arm, others);
    check_shapes(arm, forward_kinematics(arm, q_rad, frames), reference);
  }
}

void their_velocities_are_those_of_the_motion(void**) {
  Random random(3);
  const Arm arm = on_the_carriage();
  const double dt_s = 1e-6;
  for (int trial = 0; trial < 200; ++trial) {
    OtherJoints now = arm.other_positions;
    for (size_t j = 0; j < arm.other_joints.size(); ++j) {
      now.position[j] = random.uniform(-1.0, 1.0);
      now.velocity[j] = random.uniform(-1.0, 1.0);
    }
    OtherJoints before = now, later = now;
    for (size_t j = 0; j < arm.other_joints.size(); ++j) {
      before.position[j] -= dt_s * now.velocity[j];
      later.position[j] += dt_s * now.velocity[j];
    }
    const JointVector q_rad = random.configuration(arm);
    const OtherFrames frames[] = {place_other_joints(arm, before), place_other_joints(arm, now),
                                  place_other_joints(arm, later)};
    for (const LinkShape& shape : arm.shapes) {
      const auto centre = [&](int i) { return transformed(forward_kinematics(arm, q_rad, frames[i]), shape).centre(); };
      const Vector3 expected_mps = (centre(2) - centre(0)) / (2.0 * dt_s);
      check_near_because(
          other_velocity_at(arm, forward_kinematics(arm, q_rad, frames[1]), shape.other_joint, centre(1)), expected_mps,
          1e-7, "link '%s'", shape.link.c_str());
    }
  }
}

void a_joint_without_a_position_is_named_and_nothing_is_silently_absent(void**) {
  const Arm arm = on_the_carriage({});
  const auto says = [&](const char* joint, const char* text) {
    return std::count_if(arm.warnings.begin(), arm.warnings.end(), [&](const std::string& remark) {
      return remark.find(joint) != std::string::npos && remark.find(text) != std::string::npos;
    });
  };
  assert_int_equal(says("'head_joint'", "nothing keeps clear of the links behind it ('head')"), 1);
  assert_int_equal(says("'left_1'", "('left_upper', 'left_lower')"), 1);
  assert_int_equal(says("'left_finger_joint'", "count as if it were at 0"), 1);
  assert_int_equal(arm.warnings.size(), 3);
  assert_false(has_link(arm, "head") || has_link(arm, "left_upper") || has_link(arm, "left_lower"));
  assert_true(has_link(arm, "left_finger") && has_link(arm, "right_finger") && has_link(arm, "platform"));
}

/// A finger of so many joints in a row on the tool.
Arm with_finger(int joints) {
  std::string finger, parent = "tool";
  for (int i = 0; i < joints; ++i) {
    const std::string name = "phalanx_" + std::to_string(i);
    finger += "<link name='" + name + "'><collision><geometry><sphere radius='0.01'/></geometry></collision></link>" +
              "<joint name='of_" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + name +
              "'/><origin xyz='0 0 0.01'/><axis xyz='1 0 0'/><limit lower='0' upper='1' velocity='1' effort='1'/>" +
              "</joint>";
    parent = name;
  }
  const std::string text = test::replaced(test::text_of(kUrdf), "</robot>", finger + "</robot>");
  return load_arm(test::scratch_file("finger.urdf", text), "mast", "tool", {}, kPositions);
}

void a_hand_of_forty_joints_is_there_and_named_once(void**) {
  const Arm arm = with_finger(40);
  assert_true(has_link(arm, "phalanx_39"));
  check(arm.warnings.size() == 1 && arm.warnings[0].find("it and the joints behind it") != std::string::npos, "%s",
        arm.warnings[0].c_str());
}

void too_many_other_joints_are_refused(void**) {
  const int others = static_cast<int>(on_the_mast().other_joints.size());
  assert_int_equal(with_finger(kMaxOtherJoints - others).other_joints.size(), kMaxOtherJoints);
  const std::string message = test::message_of([&] { with_finger(kMaxOtherJoints - others + 1); });
  assert_true(test::one_line_with(message, {"finger.urdf", std::to_string(kMaxOtherJoints)}));
}

/// The base link is a link of the chain. 0 is not within the limits of left_2.
void joints_on_the_base_link_count_as_at_zero_or_the_nearest_limit(void**) {
  const Arm arm = on_the_mast({});
  assert_true(has_link(arm, "head") && has_link(arm, "left_lower"));
  assert_int_equal(arm.warnings.size(), 4);
  const auto says = [&](const char* text) {
    return std::any_of(arm.warnings.begin(), arm.warnings.end(),
                       [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
  };
  assert_true(says("'head_joint' is no part of the chain: the links behind it ('head') count as if it were at 0"));
  assert_true(says("('left_upper', 'left_lower') count as if it were at 0"));
  assert_true(says("'left_2' is no part of the chain: the links behind it ('left_lower') count as if it were at -0.1"));
}

void a_branch_is_there_up_to_the_first_joint_without_a_position(void**) {
  const Arm arm = on_the_carriage({{"left_1", 0.1}, {"head_joint", 0.0}, {"left_finger_joint", 0.0}});
  assert_true(has_link(arm, "left_upper") && !has_link(arm, "left_lower"));
  assert_int_equal(arm.warnings.size(), 1);
  check(arm.warnings[0].find("'left_2'") != std::string::npos, "%s", arm.warnings[0].c_str());
}

void what_is_below_a_lift_without_a_position_is_named(void**) {
  const Arm arm = load_arm(kUrdf, "carriage", "tool", {}, {{"left_finger_joint", 0.0}});
  assert_false(has_link(arm, "mast"));
  assert_int_equal(arm.warnings.size(), 1);
  for (const char* name : {"'lift'", "'mast'", "'platform'", "'head'", "'left_lower'"})
    check(arm.warnings[0].find(name) != std::string::npos, "%s: %s", name, arm.warnings[0].c_str());
}

void a_position_that_no_other_joint_can_have_is_refused(void**) {
  const struct {
    const char* joint;
    double position;
    const char* complaint;
  } cases[] = {{"neck", 0.1, "no such joint"},
               {"joint_3", 0.1, "of the chain"},
               {"mount", 0.1, "is not a revolute"},
               {"right_finger_joint", 0.01, "mimics"},
               {"head_joint", 1.3, "moves from -0.5 to 1.2"},
               {"head_joint", std::nan(""), "moves from"}};
  for (const auto& each : cases) {
    try {
      on_the_mast({{each.joint, each.position}});
      check(false, "%s at %g is accepted", each.joint, each.position);
    } catch (const BadJointPosition& error) {
      assert_string_equal(error.joint.c_str(), each.joint);
      check(std::string(error.what()).find(each.complaint) != std::string::npos, "%s", error.what());
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(links_behind_other_joints_are_where_their_positions_put_them),
      cmocka_unit_test(they_follow_other_positions_and_so_do_mimics),
      cmocka_unit_test(their_velocities_are_those_of_the_motion),
      cmocka_unit_test(a_joint_without_a_position_is_named_and_nothing_is_silently_absent),
      cmocka_unit_test(a_branch_is_there_up_to_the_first_joint_without_a_position),
      cmocka_unit_test(what_is_below_a_lift_without_a_position_is_named),
      cmocka_unit_test(joints_on_the_base_link_count_as_at_zero_or_the_nearest_limit),
      cmocka_unit_test(a_hand_of_forty_joints_is_there_and_named_once),
      cmocka_unit_test(too_many_other_joints_are_refused),
      cmocka_unit_test(a_position_that_no_other_joint_can_have_is_refused),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
