#include "host/campaign/furniture/assembly.h"

namespace sidestep::campaign {

void Assembly::add_box(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) {
  add(sim::Shape::kBox, high_m - low_m, 0.5 * (low_m + high_m));
}

void Assembly::add_can(const Eigen::Vector3d& foot_m, double radius_m, double height_m) {
  add(sim::Shape::kCylinder, {radius_m, height_m, 0.0}, foot_m + 0.5 * height_m * Eigen::Vector3d::UnitZ());
}

void Assembly::add(sim::Shape shape, const Eigen::Vector3d& size_m, const Eigen::Vector3d& centre_m) {
  sim::Obstacle& solid = solids_.emplace_back();
  solid.id = static_cast<int32_t>(solids_.size()) - 1;
  solid.solid.shape = shape;
  solid.solid.size_m = size_m;
  solid.motion.position_m = base_from_furniture_ * centre_m;
  solid.motion.orientation = Eigen::Quaterniond(base_from_furniture_.linear());
}

}  // namespace sidestep::campaign
