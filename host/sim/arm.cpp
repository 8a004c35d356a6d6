#include "host/sim/arm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl_parser/kdl_parser.hpp>
#include <optional>
#include <stdexcept>

#include "firmware/model/load/urdf_file.h"

namespace sidestep::sim {
namespace {

Eigen::Isometry3d isometry(const KDL::Frame& frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) pose(row, column) = frame(row, column);
  }
  return pose;
}

KDL::Frame frame_of(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {KDL::Rotation::Quaternion(r.x, r.y, r.z, r.w), {pose.position.x, pose.position.y, pose.position.z}};
}

}  // namespace

class Arm::Builder {
 public:
  Builder(Arm& arm, const std::string& file, const std::vector<std::string>& package_path,
          const std::map<std::string, double>& positions)
      : arm_(arm), file_(file), package_path_(package_path), positions_(positions), model_(read_urdf(file)) {}

  void build(const std::string& base, const std::string& tip) {
    base_link_ = link_named(base);
    for (const urdf::Link* link = link_named(tip); link != base_link_; link = link->getParent().get()) {
      if (!link->getParent()) fail(fmt::format("link '{}' is not below link '{}'", tip, base));
      check(*link->parent_joint);
      chain_.push_back(link);
    }
    model_->root_link_->inertial.reset();  // KDL supports no inertia of the root and would warn
    if (!kdl_parser::treeFromUrdfModel(*model_, tree_)) fail("KDL cannot convert it");
    KDL::Frame base_from_top;
    const urdf::Link* top = base_link_;
    for (; is_placed(*top); top = top->getParent().get()) {
      base_from_top = base_from_top * segment_of(*top).pose(position_of(*top).value_or(0.0)).Inverse();
    }
    add(*top, -1, top == base_link_);
    arm_.bodies_.front().base_from_body = base_from_top;
    if (arm_.joints_ < 1) fail(fmt::format("no joint between '{}' and '{}'", base, tip));
    // add() has added every link of the chain, hence the tip.
    const auto is_tip = [&](const Body& body) { return body.segment.getName() == tip; };
    const auto tool = std::find_if(arm_.bodies_.begin(), arm_.bodies_.end(), is_tip);
    arm_.tool_body_ = static_cast<int>(tool - arm_.bodies_.begin());
  }

  [[noreturn]] void fail(const std::string& complaint) const { throw std::runtime_error(file_ + ": " + complaint); }

 private:
  const urdf::Link* link_named(const std::string& name) const {
    const auto link = model_->getLink(name);
    if (!link) fail(fmt::format("no link '{}'", name));
    return link.get();
  }

  const KDL::Segment& segment_of(const urdf::Link& link) const { return tree_.getSegment(link.name)->second.segment; }

  bool on_chain(const urdf::Link& link) const { return std::count(chain_.begin(), chain_.end(), &link) > 0; }

  // The position of the joint above a link, where it was given, for the joint itself or the one that it mimics.
  std::optional<double> position_of(const urdf::Link& link) const {
    return link.parent_joint ? position_of(*link.parent_joint, 0) : std::nullopt;
  }
  std::optional<double> position_of(const urdf::Joint& joint, int depth) const {
    if (const auto given = positions_.find(joint.name); given != positions_.end()) return given->second;
    const auto master = joint.mimic && depth < 8 ? model_->getJoint(joint.mimic->joint_name) : nullptr;
    const auto position = master ? position_of(*master, depth + 1) : std::nullopt;
    if (!position) return {};
    return joint.mimic->multiplier * *position + joint.mimic->offset;
  }

  bool is_placed(const urdf::Link& link) const { return is_fixed(link) || position_of(link); }

  // Of a joint whose position was not given.
  double default_position(const urdf::Joint& joint, int depth = 0) const {
    const auto master = joint.mimic && depth < 8 ? model_->getJoint(joint.mimic->joint_name) : nullptr;
    if (master) return joint.mimic->multiplier * default_position(*master, depth + 1) + joint.mimic->offset;
    if (!joint.limits || joint.type == urdf::Joint::CONTINUOUS) return 0.0;
    return std::max(joint.limits->lower, std::min(0.0, joint.limits->upper));
  }

  // Adds a link and the links below it. Outside of the arm (the base and all links below it) links count that are
  // rigidly attached or behind a joint with a given position.
  void add(const urdf::Link& link, int parent, bool of_arm) {
    const int index = static_cast<int>(arm_.bodies_.size());
    Body body{segment_of(link),       parent, -1, parent >= 0 ? arm_.bodies_[parent].chain_joints : 0,
              KDL::Frame::Identity(), 0.0};
    if (on_chain(link) && !is_fixed(link)) {
      body.joint = arm_.joints_++;
      ++body.chain_joints;
      if (arm_.joints_ > kMaxJoints) fail(fmt::format("more than {} joints", kMaxJoints));
      add_limits(*link.parent_joint);
    } else if (link.parent_joint && !is_fixed(link)) {
      body.position = position_of(link).value_or(default_position(*link.parent_joint));
    }
    arm_.bodies_.push_back(body);
    for (const auto& collision : link.collision_array) add_part(link, *collision, index);
    for (const auto& child : link.child_links) {
      if (of_arm || is_placed(*child)) add(*child, index, of_arm || child.get() == base_link_);
    }
  }

  void add_limits(const urdf::Joint& joint) {
    double lower = -M_PI, upper = M_PI;
    if (joint.limits && joint.type != urdf::Joint::CONTINUOUS && joint.limits->lower < joint.limits->upper &&
        std::isfinite(joint.limits->upper - joint.limits->lower)) {
      lower = joint.limits->lower, upper = joint.limits->upper;
    }
    for (auto [limits, value] : {std::pair{&arm_.lower_, lower}, std::pair{&arm_.upper_, upper}}) {
      limits->conservativeResize(limits->size() + 1);
      limits->tail<1>()[0] = value;
    }
  }

  void check(const urdf::Joint& joint) const {
    if (joint.type == urdf::Joint::FIXED) return;
    const bool supported = joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
                           joint.type == urdf::Joint::PRISMATIC;
    if (!supported) fail(fmt::format("joint '{}' is neither revolute, continuous, prismatic nor fixed", joint.name));
    if (joint.mimic) fail(fmt::format("joint '{}' mimics another: not supported", joint.name));
    const double axis = std::hypot(joint.axis.x, joint.axis.y, joint.axis.z);
    if (!(axis > 1e-6 && axis < 1e6)) fail(fmt::format("joint '{}': the axis has no direction", joint.name));
  }

  void add_part(const urdf::Link& link, const urdf::Collision& collision, int body) {
    KDL::Frame body_from_part = frame_of(collision.origin);
    Solid solid;
    if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(collision.geometry.get())) {
      const CentredMesh centred = mesh_of(link, *mesh);
      solid = centred.solid;
      body_from_part = body_from_part * KDL::Frame({centred.centre_m.x(), centred.centre_m.y(), centred.centre_m.z()});
    } else {
      solid = solid_of(link, collision.geometry.get());
    }
    if (!solid.size_m.allFinite() || bounding_radius_m(solid) > 100.0 || smallest_size_m(solid) <= 0.0) {
      fail(fmt::format("link '{}': a collision shape has a size out of range", link.name));
    }
    const int chain_joints = arm_.bodies_[body].chain_joints;
    arm_.parts_.push_back({link.name, solid, chain_joints, chain_joints > 0});
    arm_.mounts_.push_back({body, body_from_part});
  }

  CentredMesh mesh_of(const urdf::Link& link, const urdf::Mesh& mesh) const {
    try {
      return load_mesh_solid(mesh.filename, file_, package_path_, {mesh.scale.x, mesh.scale.y, mesh.scale.z});
    } catch (const std::exception& error) {
      fail(fmt::format("link '{}': {}", link.name, error.what()));
    }
  }

  Solid solid_of(const urdf::Link& link, const urdf::Geometry* geometry) const {
    if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(geometry)) {
      return {Shape::kSphere, {sphere->radius, 0.0, 0.0}};
    }
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(geometry)) {
      return {Shape::kCylinder, {cylinder->radius, cylinder->length, 0.0}};
    }
    if (const auto* box = dynamic_cast<const urdf::Box*>(geometry)) {
      return {Shape::kBox, {box->dim.x, box->dim.y, box->dim.z}};
    }
    fail(fmt::format("link '{}': a collision shape of an unknown kind", link.name));
  }

  static double smallest_size_m(const Solid& solid) {
    if (solid.shape == Shape::kMesh) return solid.size_m.maxCoeff();
    const int sizes = solid.shape == Shape::kSphere ? 1 : solid.shape == Shape::kCylinder ? 2 : 3;
    return solid.size_m.head(sizes).minCoeff();
  }

  Arm& arm_;
  std::string file_;
  std::vector<std::string> package_path_;
  const std::map<std::string, double>& positions_;
  KDL::Tree tree_;
  urdf::ModelInterfaceSharedPtr model_;
  const urdf::Link* base_link_ = nullptr;
  std::vector<const urdf::Link*> chain_;  ///< tip first, without the base
};

Arm::Arm(const std::string& urdf_file, const std::string& base, const std::string& tip,
         const std::vector<std::string>& package_path, const std::map<std::string, double>& joint_positions) {
  Builder builder(*this, urdf_file, package_path, joint_positions);
  builder.build(base, tip);
  place(JointVector::Zero(joints_));
  bool finite = base_from_tool_.matrix().allFinite();
  for (const ArmPart& part : parts_) finite = finite && part.base_from_part.matrix().allFinite();
  if (!finite) builder.fail("a pose is not finite");
}

void Arm::place(const JointVector& q_rad) {
  for (size_t i = 1; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    const double q = body.joint >= 0 ? q_rad[body.joint] : body.position;
    body.base_from_body = bodies_[body.parent].base_from_body * body.segment.pose(q);
  }
  for (size_t i = 0; i < parts_.size(); ++i) {
    parts_[i].base_from_part = isometry(bodies_[mounts_[i].body].base_from_body * mounts_[i].body_from_part);
  }
  base_from_tool_ = isometry(bodies_[tool_body_].base_from_body);
}

std::vector<JointAxis> Arm::axes() const {
  std::vector<JointAxis> axes;
  for (const Body& body : bodies_) {
    if (body.joint < 0) continue;
    const KDL::Frame& base_from_parent = bodies_[body.parent].base_from_body;
    const KDL::Vector origin = base_from_parent * body.segment.getJoint().JointOrigin();
    const bool prismatic = body.segment.getJoint().getType() == KDL::Joint::TransAxis;
    const KDL::Vector direction = base_from_parent.M * body.segment.getJoint().JointAxis();
    axes.push_back({{origin.x(), origin.y(), origin.z()}, {direction.x(), direction.y(), direction.z()}, prismatic});
  }
  return axes;
}

}  // namespace sidestep::sim
