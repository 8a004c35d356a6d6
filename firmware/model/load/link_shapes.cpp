#include "firmware/model/load/link_shapes.h"

#include <algorithm>
#include <cmath>

#include "firmware/base/fail.h"
#include "firmware/model/load/fit_cache.h"
#include "firmware/model/load/urdf_file.h"

namespace sidestep {

Eigen::Isometry3d to_eigen(const urdf::Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = Vector3(pose.position.x, pose.position.y, pose.position.z);
  result.linear() =
      Quaternion(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z).normalized().toRotationMatrix();
  return result;
}

namespace {

/// Divides a box across its second longest edge into at most 8 strips about as wide as the box is thick, with one
/// capsule each: a single capsule around a table top would fill the space above it.
std::vector<Capsule> capsules_around_strips(const Vector3& edges_m) {
  constexpr int kMostStrips = 8;
  int across = 0, flat = 0;
  edges_m.minCoeff(&flat);
  for (int i = 0; i < 3; ++i)
    if (i != flat && (across == flat || edges_m[i] < edges_m[across])) across = i;
  const int strips = std::clamp(static_cast<int>(std::ceil(edges_m[across] / edges_m[flat])), 1, kMostStrips);
  Vector3 strip_m = edges_m;
  strip_m[across] /= strips;
  const Capsule first = capsule_around_box(strip_m);
  std::vector<Capsule> capsules;
  for (int i = 0; i < strips; ++i) {
    const Vector3 offset = Vector3::Unit(across) * ((i + 0.5) * strip_m[across] - 0.5 * edges_m[across]);
    capsules.push_back({first.start + offset, first.end + offset, first.radius_m});
  }
  return capsules;
}

bool same_part(const LinkShape& a, const LinkShape& b) {
  return a.body == b.body && a.below_arm == b.below_arm;
}

Eigen::Isometry3d parent_from(const urdf::Link& link) {
  return to_eigen(link.parent_joint->parent_to_joint_origin_transform);
}

}  // namespace

CapsuleFit ShapeCollector::enclose_mesh(const urdf::Link& link, const urdf::Mesh& mesh) const {
  try {
    const std::string file = find_mesh(mesh.filename, file_, meshes_.package_path);
    return fit_capsules_cached(load_mesh(file, Vector3(mesh.scale.x, mesh.scale.y, mesh.scale.z)),
                               meshes_.capsules_per_mesh);
  } catch (const std::exception& error) {
    fail("{}: link '{}': {}", file_, link.name, error.what());
  }
}

/// The capsules that enclose one collision shape, in the frame of the shape.
CapsuleFit ShapeCollector::enclose(const urdf::Link& link, const urdf::Geometry& geometry, bool below_arm) const {
  const auto positive = [&](double length, const char* what) {
    if (!(std::isfinite(length) && length > 0.0))
      fail("{}: link '{}': a collision {} must be finite and positive", file_, link.name, what);
  };
  if (geometry.type == urdf::Geometry::SPHERE) {
    const auto& sphere = static_cast<const urdf::Sphere&>(geometry);
    positive(sphere.radius, "radius");
    return {{{Vector3::Zero(), Vector3::Zero(), sphere.radius}}, 0.0};
  }
  if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    positive(cylinder.radius, "radius");
    positive(cylinder.length, "length");
    const Vector3 half(0, 0, 0.5 * cylinder.length);
    return {{{-half, half, cylinder.radius}}, 0.0};
  }
  if (geometry.type == urdf::Geometry::BOX) {
    const auto& box = static_cast<const urdf::Box&>(geometry);
    for (double edge : {box.dim.x, box.dim.y, box.dim.z}) positive(edge, "box edge");
    const Vector3 edges_m(box.dim.x, box.dim.y, box.dim.z);
    return {below_arm ? capsules_around_strips(edges_m) : std::vector<Capsule>{capsule_around_box(edges_m)}, 0.0};
  }
  return enclose_mesh(link, static_cast<const urdf::Mesh&>(geometry));
}

void ShapeCollector::remark_on(const urdf::Link& link) {
  if (link.collision_array.empty() && !link.visual_array.empty())
    remarks_.push_back(
        fmt::format("link '{}' can be seen but has no collision geometry: nothing keeps it clear", link.name));
  const auto& joint = link.parent_joint;
  if (chain_links_.count(link.name) == 0 && joint && joint->type != urdf::Joint::FIXED)
    remarks_.push_back(fmt::format("joint '{}' is no part of the chain{}: what hangs on it counts as if it were at 0",
                                   joint->name, joint->mimic ? " (it mimics another)" : ""));
}

void ShapeCollector::add_shapes_of(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link,
                                   bool below_arm) {
  remark_on(link);
  for (const auto& collision : link.collision_array) {
    if (!collision || !collision->geometry) fail("{}: link '{}': a collision has no geometry", file_, link.name);
    const Eigen::Isometry3d body_from_shape = body_from_link * to_eigen(collision->origin);
    if (!body_from_shape.matrix().allFinite())
      fail("{}: link '{}': a collision origin is not finite", file_, link.name);
    const CapsuleFit fit = enclose(link, *collision->geometry, below_arm);
    for (const Capsule& capsule : fit.capsules)
      add({link.name,
           body,
           {body_from_shape * capsule.start, body_from_shape * capsule.end, capsule.radius_m},
           fit.slack_m,
           below_arm});
  }
}

void ShapeCollector::collect(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link) {
  add_shapes_of(link, body, body_from_link, false);
  for (const auto& child : link.child_links)
    if (chain_links_.count(child->name) == 0) collect(*child, body, body_from_link * parent_from(*child));
}

void ShapeCollector::collect_below(const urdf::Link& base) {
  Eigen::Isometry3d base_from_link = Eigen::Isometry3d::Identity();
  for (const urdf::Link* link = &base; is_fixed(*link); link = link->getParent().get()) {
    base_from_link = base_from_link * parent_from(*link).inverse();
    collect_fixed(*link->getParent(), link, base_from_link);
  }
}

void ShapeCollector::collect_fixed(const urdf::Link& link, const urdf::Link* except,
                                   const Eigen::Isometry3d& base_from_link) {
  add_shapes_of(link, 0, base_from_link, true);
  for (const auto& child : link.child_links)
    if (child.get() != except && is_fixed(*child)) collect_fixed(*child, nullptr, base_from_link * parent_from(*child));
}

/// Skips a shape that lies inside another shape of its body, such as a sphere at the end of a cylinder, and removes the
/// shapes that lie inside the new one.
void ShapeCollector::add(const LinkShape& shape) {
  for (const LinkShape& other : shapes_)
    if (same_part(other, shape) && contains(other.capsule_body, shape.capsule_body)) return;
  for (size_t i = shapes_.size(); i-- > 0;)
    if (same_part(shapes_[i], shape) && contains(shape.capsule_body, shapes_[i].capsule_body))
      shapes_.erase(shapes_.begin() + static_cast<std::ptrdiff_t>(i));
  shapes_.push_back(shape);
}

}  // namespace sidestep
