#include "firmware/model/load/load_arm.h"

#include <urdf_model/model.h>

#include <cmath>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <limits>

#include "firmware/base/fail.h"
#include "firmware/model/load/link_shapes.h"
#include "firmware/model/load/other_joint_collector.h"
#include "firmware/model/load/urdf_file.h"
#include "firmware/model/rotation.h"

namespace sidestep {
namespace {

// Faster than any joint, and small enough that products of these do not overflow.
constexpr double kFastest_radps = 1e9, kSharpest_radps2 = 1e9;

using sidestep::to_eigen;

Eigen::Isometry3d to_eigen(const KDL::Frame& frame) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    result.translation()[row] = frame.p[row];
    for (int column = 0; column < 3; ++column) result.linear()(row, column) = frame.M(row, column);
  }
  return result;
}

/// A URDF's limits are in rad. No arm turns a joint four times around.
void warn_of_degrees(const urdf::Joint& joint, std::vector<std::string>& warnings) {
  const double range_rad = joint.type == urdf::Joint::REVOLUTE ? joint.limits->upper - joint.limits->lower : 0.0;
  if (range_rad > 8.0 * M_PI)
    warnings.push_back(
        fmt::format("joint '{}' may turn from {:g} to {:g} rad: are its limits in degrees? A URDF's are in "
                    "rad",
                    joint.name, joint.limits->lower, joint.limits->upper));
}

/// The names of the links from base to tip, both included.
std::vector<std::string> path(const std::string& file, const urdf::ModelInterface& model, const std::string& base,
                              const std::string& tip) {
  for (const std::string& name : {base, tip})
    if (!model.getLink(name)) fail("{}: there is no link '{}'", file, name);
  std::vector<std::string> names;
  for (auto link = model.getLink(tip); link; link = link->getParent()) {
    names.insert(names.begin(), link->name);
    if (link->name == base) return names;
    if (names.size() > model.links_.size()) break;
  }
  fail("{}: link '{}' is not above link '{}'", file, base, tip);
}

bool is_prismatic(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::PRISMATIC;
}

void check_joint(const std::string& file, const urdf::Joint& joint) {
  const bool moves =
      joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS || is_prismatic(joint);
  if (!moves && joint.type != urdf::Joint::FIXED)
    fail(
        "{}: joint '{}' is neither revolute, continuous, prismatic nor fixed (a planar or floating joint carries a "
        "mobile base: choose a base link behind it)",
        file, joint.name);
  const auto& origin = joint.parent_to_joint_origin_transform;
  if (!to_eigen(origin).matrix().allFinite()) fail("{}: joint '{}': its origin is not finite", file, joint.name);
  if (!moves) return;
  if (joint.mimic) fail("{}: joint '{}' mimics another: not supported", file, joint.name);
  const double norm = std::hypot(joint.axis.x, joint.axis.y, joint.axis.z);
  if (!(std::isfinite(norm) && norm > 1e-6)) fail("{}: joint '{}': its axis has no direction", file, joint.name);
  if (!joint.limits && joint.type != urdf::Joint::CONTINUOUS) fail("{}: joint '{}' has no <limit>", file, joint.name);
}

void append_limits(JointLimits& limits, const urdf::Joint& joint) {
  const auto append = [](JointVector& vector, double value) {
    vector.conservativeResize(vector.size() + 1);
    vector[vector.size() - 1] = value;
  };
  const bool endless = joint.type == urdf::Joint::CONTINUOUS;
  const double infinity = std::numeric_limits<double>::infinity();
  append(limits.lower_rad, endless ? -infinity : joint.limits->lower);
  append(limits.upper_rad, endless ? infinity : joint.limits->upper);
  append(limits.velocity_radps, joint.limits ? joint.limits->velocity : std::nan(""));
  append(limits.acceleration_radps2, is_prismatic(joint) ? kDefaultAcceleration_mps2 : kDefaultAcceleration_radps2);
}

}  // namespace

Arm load_arm(const std::string& urdf_file, const std::string& base, const std::string& tip, const MeshOptions& meshes,
             const JointPositions& positions) {
  const urdf::ModelInterfaceSharedPtr model = read_urdf(urdf_file);
  const std::vector<std::string> links = path(urdf_file, *model, base, tip);
  for (size_t i = 1; i < links.size(); ++i) check_joint(urdf_file, *model->getLink(links[i])->parent_joint);

  Arm arm;
  KDL::Tree tree;
  model->root_link_->inertial.reset();  // KDL does not support it and would print a warning
  if (!kdl_parser::treeFromUrdfModel(*model, tree) || !tree.getChain(base, tip, arm.chain))
    fail("{}: no kinematic chain from '{}' to '{}'", urdf_file, base, tip);

  check_positions(*model, links, positions);
  OtherJointCollector others(urdf_file, *model, positions, arm);
  ShapeCollector shapes(urdf_file, links, meshes, others, arm.shapes, arm.remarks);
  Eigen::Isometry3d body_from_link = Eigen::Isometry3d::Identity();  // of the link at the start of the next segment
  shapes.collect_below(*model->getLink(base));
  shapes.collect(*model->getLink(base), 0, body_from_link);
  for (unsigned i = 0; i < arm.chain.getNrOfSegments(); ++i) {
    const KDL::Segment& segment = arm.chain.getSegment(i);
    const urdf::Link& link = *model->getLink(links[i + 1]);
    body_from_link = body_from_link * to_eigen(segment.pose(0.0));
    if (segment.getJoint().getType() != KDL::Joint::None) {
      if (arm.joints == kMaxJoints) fail("{}: more than {} joints from '{}' to '{}'", urdf_file, kMaxJoints, base, tip);
      // Rotate the frame so that its z axis is the joint's axis; the rest of the chain is expressed in this frame.
      const urdf::Vector3& axis = link.parent_joint->axis;
      Eigen::Isometry3d link_from_body = Eigen::Isometry3d::Identity();
      link_from_body.linear() = rotation_from_z(Vector3(axis.x, axis.y, axis.z)).toRotationMatrix();
      arm.joint_placement[++arm.joints] = body_from_link * link_from_body;
      arm.joint_names.push_back(link.parent_joint->name);
      arm.prismatic[arm.joints - 1] = is_prismatic(*link.parent_joint);
      append_limits(arm.limits, *link.parent_joint);
      warn_of_degrees(*link.parent_joint, arm.warnings);
      body_from_link = link_from_body.inverse();
    }
    shapes.collect(link, arm.joints, body_from_link);
  }
  arm.last_body_from_tool = body_from_link;
  others.finish();
  arm.joint_scale = JointVector::Ones(arm.joints);
  for (int i = 0; i < arm.joints; ++i)
    if (arm.prismatic[i]) arm.joint_scale[i] = kPrismaticScale_m;

  if (arm.joints < kMinJoints)
    fail("{}: {} joints from '{}' to '{}', at least {} are needed", urdf_file, arm.joints, base, tip, kMinJoints);
  if (arm.shapes.empty())
    fail("{}: no link from '{}' to '{}' has collision geometry, so nothing could be kept clear", urdf_file, base, tip);
  if (arm.shapes.size() > static_cast<size_t>(kMaxLinkShapes))
    fail(
        "{}: {} collision shapes from '{}' to '{}', at most {} are possible: fewer pieces_per_mesh, or fewer "
        "joint_positions of joints below the arm, leave shapes out",
        urdf_file, arm.shapes.size(), base, tip, kMaxLinkShapes);
  return arm;
}

void check_limits(const Arm& arm) {
  const JointLimits& limits = arm.limits;
  for (int i = 0; i < arm.joints; ++i) {
    const std::string& name = arm.joint_names[static_cast<size_t>(i)];
    if (!(limits.lower_rad[i] < limits.upper_rad[i]))
      fail("joint '{}': lower limit {} must be below upper limit {}", name, limits.lower_rad[i], limits.upper_rad[i]);
    if (arm.prismatic[i] && !(std::isfinite(limits.lower_rad[i]) && std::isfinite(limits.upper_rad[i])))
      fail("joint '{}': a prismatic joint needs finite position limits", name);
    if (!(limits.velocity_radps[i] > 0.0 && limits.velocity_radps[i] <= kFastest_radps))
      fail("joint '{}': velocity limit {} must be above 0 and at most {:g}", name, limits.velocity_radps[i],
           kFastest_radps);
    if (!(limits.acceleration_radps2[i] > 0.0 && limits.acceleration_radps2[i] <= kSharpest_radps2))
      fail("joint '{}': acceleration limit {} must be above 0 and at most {:g}", name, limits.acceleration_radps2[i],
           kSharpest_radps2);
  }
}

}  // namespace sidestep
