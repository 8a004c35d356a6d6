#include "firmware/model/link_shapes.h"

#include <cmath>

#include "firmware/model/fail.h"
#include "firmware/model/fit_cache.h"

namespace sidestep {

Eigen::Isometry3d to_eigen(const urdf::Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = Vector3(pose.position.x, pose.position.y, pose.position.z);
  result.linear() =
      Quaternion(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z).normalized().toRotationMatrix();
  return result;
}

CapsuleFit ShapeCollector::enclose_mesh(const urdf::Link& link, const urdf::Mesh& mesh) const {
  try {
    const std::string file = find_mesh(mesh.filename, file_, meshes_.package_path);
    return fit_capsules_cached(load_mesh(file, Vector3(mesh.scale.x, mesh.scale.y, mesh.scale.z)),
                               meshes_.capsules_per_mesh);
  } catch (const std::exception& error) {
    fail("{}: link '{}': {}", file_, link.name, error.what());
  }
}

/// The capsules around one collision shape, in the frame of the shape.
CapsuleFit ShapeCollector::enclose(const urdf::Link& link, const urdf::Geometry& geometry) const {
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
    return {{capsule_around_box(Vector3(box.dim.x, box.dim.y, box.dim.z))}, 0.0};
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

void ShapeCollector::collect(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link) {
  remark_on(link);
  for (const auto& collision : link.collision_array) {
    if (!collision || !collision->geometry) fail("{}: link '{}': a collision has no geometry", file_, link.name);
    const Eigen::Isometry3d body_from_shape = body_from_link * to_eigen(collision->origin);
    if (!body_from_shape.matrix().allFinite())
      fail("{}: link '{}': a collision origin is not finite", file_, link.name);
    const CapsuleFit fit = enclose(link, *collision->geometry);
    for (const Capsule& capsule : fit.capsules)
      add({link.name,
           body,
           {body_from_shape * capsule.start, body_from_shape * capsule.end, capsule.radius_m},
           fit.slack_m});
  }
  for (const auto& child : link.child_links)
    if (chain_links_.count(child->name) == 0)
      collect(*child, body, body_from_link * to_eigen(child->parent_joint->parent_to_joint_origin_transform));
}

/// A shape inside another of its body adds nothing: a sphere that rounds the end of a cylinder, for one.
void ShapeCollector::add(const LinkShape& shape) {
  for (const LinkShape& other : shapes_)
    if (other.body == shape.body && contains(other.capsule_body, shape.capsule_body)) return;
  for (size_t i = shapes_.size(); i-- > 0;)
    if (shapes_[i].body == shape.body && contains(shape.capsule_body, shapes_[i].capsule_body))
      shapes_.erase(shapes_.begin() + static_cast<std::ptrdiff_t>(i));
  shapes_.push_back(shape);
}

}  // namespace sidestep
