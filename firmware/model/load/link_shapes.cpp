#include "firmware/model/load/link_shapes.h"

#include <algorithm>
#include <cmath>

#include "firmware/base/fail.h"
#include "firmware/model/load/capsule_fit.h"
#include "firmware/model/load/other_joint_collector.h"
#include "firmware/model/load/pieces_cache.h"
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

/// The shape as a capsule, or as a solid in a capsule around it. Frame: that of the collision element.
LinkShape capsule_shape(const Capsule& capsule) {
  LinkShape shape{};
  shape.capsule_body = capsule;
  return shape;
}

LinkShape solid_shape(CoreKind kind, const Vector3& half_m, const Capsule& around) {
  LinkShape shape = capsule_shape(around);
  shape.is_capsule = false;
  shape.solid.kind = kind;
  shape.solid.half_m = half_m;
  return shape;
}

LinkShape piece_shape(const MeshPiece& piece, const MeshPieces& split) {
  Capsule around = capsule_around(piece.polyhedron->vertices);
  around.radius_m += piece.radius_m;
  LinkShape shape = solid_shape(CoreKind::kPolyhedron, Vector3::Zero(), around);
  shape.polyhedron = piece.polyhedron;
  shape.solid.polyhedron = piece.polyhedron.get();
  shape.solid.radius_m = piece.radius_m;
  shape.excess_p95_m = split.excess_p95_m;
  shape.excess_m = split.excess_m;
  return shape;
}

/// Whether a sphere of the link covers the end of a cylinder like the cap of a capsule. `end`: of radius_m, in the
/// link's frame.
bool is_capped(const urdf::Link& link, const Capsule& end) {
  return std::any_of(link.collision_array.begin(), link.collision_array.end(), [&](const auto& collision) {
    if (!collision || !collision->geometry || collision->geometry->type != urdf::Geometry::SPHERE) return false;
    const Vector3 centre = to_eigen(collision->origin).translation();
    return contains({centre, centre, static_cast<const urdf::Sphere&>(*collision->geometry).radius}, end);
  });
}

bool same_part(const LinkShape& a, const LinkShape& b) {
  return a.body == b.body && a.below_arm == b.below_arm && a.other_joint == b.other_joint;
}

Eigen::Isometry3d parent_from(const urdf::Link& link) {
  return to_eigen(link.parent_joint->parent_to_joint_origin_transform);
}

}  // namespace

std::vector<LinkShape> ShapeCollector::mesh_shapes(const urdf::Link& link, const urdf::Mesh& mesh) const {
  try {
    const std::string file = find_mesh(mesh.filename, file_, meshes_.package_path);
    const MeshPieces split =
        split_mesh_cached(load_mesh(file, Vector3(mesh.scale.x, mesh.scale.y, mesh.scale.z)), meshes_.pieces_per_mesh);
    std::vector<LinkShape> shapes;
    for (const MeshPiece& piece : split.pieces) shapes.push_back(piece_shape(piece, split));
    return shapes;
  } catch (const std::exception& error) {
    fail("{}: link '{}': {}", file_, link.name, error.what());
  }
}

/// The shapes of a collision element, in its frame.
std::vector<LinkShape> ShapeCollector::shapes_of(const urdf::Link& link, const urdf::Collision& collision) const {
  const urdf::Geometry& geometry = *collision.geometry;
  const auto positive = [&](double length, const char* what) {
    if (!(std::isfinite(length) && length > 0.0))
      fail("{}: link '{}': a collision {} must be finite and positive", file_, link.name, what);
  };
  if (geometry.type == urdf::Geometry::SPHERE) {
    const auto& sphere = static_cast<const urdf::Sphere&>(geometry);
    positive(sphere.radius, "radius");
    return {capsule_shape({Vector3::Zero(), Vector3::Zero(), sphere.radius})};
  }
  if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    positive(cylinder.radius, "radius");
    positive(cylinder.length, "length");
    const Vector3 half(0, 0, 0.5 * cylinder.length);
    const Eigen::Isometry3d link_from_shape = to_eigen(collision.origin);
    const Vector3 start = link_from_shape * -half, end = link_from_shape * half;
    const Capsule around{-half, half, cylinder.radius};
    if (is_capped(link, {start, start, cylinder.radius}) && is_capped(link, {end, end, cylinder.radius}))
      return {capsule_shape(around)};
    return {solid_shape(CoreKind::kCylinder, {cylinder.radius, cylinder.radius, half.z()}, around)};
  }
  if (geometry.type == urdf::Geometry::BOX) {
    const auto& box = static_cast<const urdf::Box&>(geometry);
    for (double edge : {box.dim.x, box.dim.y, box.dim.z}) positive(edge, "box edge");
    const Vector3 edges_m(box.dim.x, box.dim.y, box.dim.z);
    return {solid_shape(CoreKind::kBox, 0.5 * edges_m, capsule_around_box(edges_m))};
  }
  return mesh_shapes(link, static_cast<const urdf::Mesh&>(geometry));
}

void ShapeCollector::remark_on(const urdf::Link& link) {
  if (link.collision_array.empty() && !link.visual_array.empty())
    remarks_.push_back(
        fmt::format("link '{}' can be seen but has no collision geometry: nothing keeps it clear", link.name));
}

void ShapeCollector::add_shapes_of(const urdf::Link& link, const Mount& mount,
                                   const Eigen::Isometry3d& mount_from_link) {
  remark_on(link);
  for (const auto& collision : link.collision_array) {
    if (!collision || !collision->geometry) fail("{}: link '{}': a collision has no geometry", file_, link.name);
    const Eigen::Isometry3d mount_from_shape = mount_from_link * to_eigen(collision->origin);
    if (!mount_from_shape.matrix().allFinite())
      fail("{}: link '{}': a collision origin is not finite", file_, link.name);
    for (LinkShape& shape : shapes_of(link, *collision)) {
      shape.link = link.name;
      shape.body = mount.body;
      shape.below_arm = mount.below_arm;
      shape.other_joint = mount.other_joint;
      shape.capsule_body.start = mount_from_shape * shape.capsule_body.start;
      shape.capsule_body.end = mount_from_shape * shape.capsule_body.end;
      shape.solid.rotation = mount_from_shape.linear();
      shape.solid.centre = mount_from_shape.translation();
      add(shape);
    }
  }
}

void ShapeCollector::collect(const urdf::Link& link, int body, const Eigen::Isometry3d& body_from_link) {
  collect_branch(link, nullptr, {body, -1, false}, body_from_link);
}

void ShapeCollector::collect_below(const urdf::Link& base) {
  Mount mount{0, -1, true};
  Eigen::Isometry3d mount_from_link = Eigen::Isometry3d::Identity();
  for (const urdf::Link* link = &base; link->getParent(); link = link->getParent().get()) {
    if (!is_fixed(*link)) {
      // Seen from the base, the joint moves what is below it, the other way round.
      const auto joint = others_.add(*link->parent_joint, mount, mount_from_link, OtherJointCollector::kInverse);
      if (!joint) {
        others_.leave_out_below(*link);
        return;
      }
      mount.other_joint = *joint;
      mount_from_link.setIdentity();
    }
    mount_from_link = mount_from_link * parent_from(*link).inverse();
    collect_branch(*link->getParent(), link, mount, mount_from_link);
  }
}

void ShapeCollector::collect_branch(const urdf::Link& link, const urdf::Link* except, const Mount& mount,
                                    const Eigen::Isometry3d& mount_from_link) {
  add_shapes_of(link, mount, mount_from_link);
  for (const auto& child : link.child_links) {
    if (child.get() == except || chain_links_.count(child->name) > 0) continue;
    const Eigen::Isometry3d mount_from_child = mount_from_link * parent_from(*child);
    if (is_fixed(*child)) {
      collect_branch(*child, nullptr, mount, mount_from_child);
    } else if (!OtherJointCollector::carries_shapes(*child)) {
      continue;
    } else if (const auto joint = others_.add(*child->parent_joint, mount, mount_from_child)) {
      collect_branch(*child, nullptr, {mount.body, *joint, mount.below_arm}, Eigen::Isometry3d::Identity());
    } else {
      others_.leave_out(*child);
    }
  }
}

/// Skips a shape that lies inside a capsule of its body, such as a sphere at the end of a cylinder, and removes the
/// shapes that lie inside the new one.
void ShapeCollector::add(const LinkShape& shape) {
  const auto lies_in = [](const LinkShape& inner, const LinkShape& outer) {
    return outer.is_capsule && same_part(inner, outer) && contains(outer.capsule_body, inner.capsule_body);
  };
  for (const LinkShape& other : shapes_)
    if (lies_in(shape, other)) return;
  for (size_t i = shapes_.size(); i-- > 0;)
    if (lies_in(shapes_[i], shape)) shapes_.erase(shapes_.begin() + static_cast<std::ptrdiff_t>(i));
  shapes_.push_back(shape);
}

}  // namespace sidestep
