#include "firmware/model/attachments.h"

namespace sidestep {
namespace {

bool are_same(const Obstacle& a, const Obstacle& b) {
  return a.id == b.id && a.shape == b.shape && a.capsule.start == b.capsule.start && a.capsule.end == b.capsule.end &&
         a.capsule.radius_m == b.capsule.radius_m && a.half_width_m == b.half_width_m &&
         a.half_thickness_m == b.half_thickness_m;
}

}  // namespace

void place_held_shapes(const Arm& arm, Attachments& attachments) {
  attachments.held.clear();
  for (const Obstacle& shape : attachments.shapes) {
    const Obstacle on_body = transformed(arm.last_body_from_tool, shape);
    const bool is_capsule = on_body.shape == Shape::kSphere || on_body.shape == Shape::kCapsule;
    attachments.held.add({arm.joints, -1, on_body.capsule, is_capsule, solid_of(on_body)});
  }
}

bool are_same(const Attachments& a, const Attachments& b) {
  const auto same = [](const Obstacle& x, const Obstacle& y) { return are_same(x, y); };
  return std::equal(a.shapes.begin(), a.shapes.end(), b.shapes.begin(), b.shapes.end(), same) &&
         std::equal(a.allowed.begin(), a.allowed.end(), b.allowed.begin(), b.allowed.end());
}

}  // namespace sidestep
