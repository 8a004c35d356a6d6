#include "firmware/model/load/other_joint_collector.h"

#include <algorithm>
#include <cmath>

#include "firmware/base/fail.h"
#include "firmware/model/load/urdf_file.h"

namespace sidestep {
namespace {

constexpr int kLongestMimicry = 8;  // joints that mimic joints that mimic

bool is_movable(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

/// The position nearest to 0 within the limits.
double nearest_to_zero(const urdf::Joint& joint) {
  if (!joint.limits || joint.type == urdf::Joint::CONTINUOUS) return 0.0;
  return std::max(joint.limits->lower, std::min(0.0, joint.limits->upper));
}

void names_behind(const urdf::Link& link, std::string& names) {
  if (!link.collision_array.empty()) names += (names.empty() ? "'" : ", '") + link.name + "'";
  for (const auto& child : link.child_links) names_behind(*child, names);
}

std::string links_behind(const urdf::Link& link) {
  std::string names;
  names_behind(link, names);
  return names;
}

constexpr const char* kHint = "give its position in robot.joint_positions";

}  // namespace

void check_positions(const urdf::ModelInterface& model, const std::vector<std::string>& chain_links,
                     const JointPositions& positions) {
  for (const auto& [name, position] : positions) {
    const auto joint = model.getJoint(name);
    if (!joint) throw BadJointPosition(name, "the URDF has no such joint");
    const auto first = std::find(chain_links.begin(), chain_links.end(), joint->parent_link_name);
    if (first != chain_links.end() && std::count(first, chain_links.end(), joint->child_link_name) > 0)
      throw BadJointPosition(name, "is a joint of the chain, whose position the arm reports");
    if (!is_movable(*joint)) throw BadJointPosition(name, "is not a revolute, continuous or prismatic joint");
    if (joint->mimic) throw BadJointPosition(name, fmt::format("mimics joint '{}'", joint->mimic->joint_name));
    const bool limited = joint->limits && joint->type != urdf::Joint::CONTINUOUS;
    if (!std::isfinite(position) ||
        (limited && !(position >= joint->limits->lower && position <= joint->limits->upper)))
      throw BadJointPosition(name, limited ? fmt::format("is {}, the joint moves from {} to {}", position,
                                                         joint->limits->lower, joint->limits->upper)
                                           : fmt::format("is {}, must be finite", position));
  }
}

bool OtherJointCollector::carries_shapes(const urdf::Link& link) {
  return !link.collision_array.empty() || std::any_of(link.child_links.begin(), link.child_links.end(),
                                                      [](const auto& child) { return carries_shapes(*child); });
}

/// The given position, or the one that follows from the given position of the joint that this one mimics.
std::optional<double> OtherJointCollector::position_of(const urdf::Joint& joint, int depth) const {
  if (const auto given = positions_.find(joint.name); given != positions_.end()) return given->second;
  if (!joint.mimic || depth == kLongestMimicry) return {};
  const auto master = model_.getJoint(joint.mimic->joint_name);
  const auto position = master ? position_of(*master, depth + 1) : std::nullopt;
  if (!position) return {};
  return joint.mimic->multiplier * *position + joint.mimic->offset;
}

/// Whether the joint mimics one that is no part of the chain and carries shapes; then the remark about that one is
/// enough.
bool OtherJointCollector::follows_another(const urdf::Joint& joint) const {
  const auto master = joint.mimic ? model_.getJoint(joint.mimic->joint_name) : nullptr;
  const auto& chain = arm_.chain.segments;
  return master && carries_shapes(*model_.getLink(master->child_link_name)) &&
         std::none_of(chain.begin(), chain.end(),
                      [&](const KDL::Segment& segment) { return segment.getJoint().getName() == master->name; });
}

/// Whether a joint behind this link counts as at 0 because nobody gave its position.
bool OtherJointCollector::assumes_zero_behind(const urdf::Link& link) const {
  return std::any_of(link.child_links.begin(), link.child_links.end(), [this](const auto& child) {
    const urdf::Joint& joint = *child->parent_joint;
    return carries_shapes(*child) &&
           ((is_movable(joint) && !position_of(joint) && nearest_to_zero(joint) == 0.0) || assumes_zero_behind(*child));
  });
}

/// One remark covers a joint and those behind it that count as at 0, too.
void OtherJointCollector::report_assumed(const urdf::Joint& joint, int parent, double position) {
  if (position == 0.0 && parent >= 0 && assumed_[static_cast<size_t>(parent)]) return;
  const urdf::Link& link = *model_.getLink(joint.child_link_name);
  const char* joints = position == 0.0 && assumes_zero_behind(link) ? "it and the joints behind it" : "it";
  arm_.warnings.push_back(
      fmt::format("joint '{}' is no part of the chain: the links behind it ({}) count as if {} were at {:g}; {}",
                  joint.name, links_behind(link), joints, position, kHint));
}

std::optional<int> OtherJointCollector::add(const urdf::Joint& joint, const Mount& mount,
                                            const Eigen::Isometry3d& mount_from_joint, Direction direction) {
  const std::optional<double> position = position_of(joint);
  if (mount.below_arm && !position) return {};
  // A planar or floating joint on a link of the chain stays at 0.
  const Vector3 axis = is_movable(joint) ? Vector3(joint.axis.x, joint.axis.y, joint.axis.z) : Vector3::UnitZ();
  if (!(axis.allFinite() && axis.norm() > 1e-6)) fail("{}: joint '{}': its axis has no direction", file_, joint.name);
  if (!mount_from_joint.matrix().allFinite()) fail("{}: joint '{}': its origin is not finite", file_, joint.name);
  if (arm_.other_joints.size() == static_cast<size_t>(kMaxOtherJoints))
    fail("{}: more than {} movable joints outside the chain carry shapes", file_, kMaxOtherJoints);

  OtherJoint other;
  other.name = joint.name;
  other.body = mount.body;
  other.parent = mount.other_joint;
  other.parent_from_joint = mount_from_joint;
  other.axis = (direction == kInverse ? -1.0 : 1.0) * axis.normalized();
  other.prismatic = joint.type == urdf::Joint::PRISMATIC;
  if (joint.limits) other.fastest = std::max(0.0, joint.limits->velocity);
  const size_t index = arm_.other_joints.size();
  arm_.other_positions.position[index] = position.value_or(nearest_to_zero(joint));
  arm_.other_joints.push_back(other);
  assumed_.push_back(!position);
  if (!position && !follows_another(joint)) report_assumed(joint, other.parent, arm_.other_positions.position[index]);
  return static_cast<int>(index);
}

void OtherJointCollector::leave_out(const urdf::Link& link) {
  arm_.warnings.push_back(
      fmt::format("joint '{}' is no part of the chain: nothing keeps clear of the links behind it "
                  "({}); {}",
                  link.parent_joint->name, links_behind(link), kHint));
}

void OtherJointCollector::leave_out_below(const urdf::Link& link) {
  std::string names;
  for (const auto& [name, other] : model_.links_) {
    const urdf::Link* above = other.get();
    while (above && above != &link) above = above->getParent().get();
    if (!above && !other->collision_array.empty()) names += (names.empty() ? "'" : ", '") + name + "'";
  }
  if (names.empty()) return;
  arm_.warnings.push_back(
      fmt::format("joint '{}' is below the chain: nothing keeps clear of the links below it ({}); "
                  "{}",
                  link.parent_joint->name, names, kHint));
}

/// Through joints that mimic as well, up to one that does not. A joint whose master carries no shapes keeps its
/// position.
void OtherJointCollector::resolve_mimic(OtherJoint& joint) {
  auto element = model_.getJoint(joint.name);
  double multiplier = 1.0, offset = 0.0;
  for (int depth = 0; element && element->mimic; ++depth) {
    if (depth == kLongestMimicry) fail("{}: joint '{}' mimics in a circle", file_, joint.name);
    offset += multiplier * element->mimic->offset;
    multiplier *= element->mimic->multiplier;
    element = model_.getJoint(element->mimic->joint_name);
  }
  if (!element || element->name == joint.name) return;
  const auto& others = arm_.other_joints;
  const auto master =
      std::find_if(others.begin(), others.end(), [&](const OtherJoint& other) { return other.name == element->name; });
  if (master == others.end()) return;
  joint.mimics = static_cast<int>(master - others.begin());
  joint.multiplier = multiplier;
  joint.offset = offset;
}

void OtherJointCollector::finish() {
  for (OtherJoint& joint : arm_.other_joints) resolve_mimic(joint);
  arm_.other_frames = place_other_joints(arm_, arm_.other_positions);
}

}  // namespace sidestep
