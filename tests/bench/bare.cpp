#include "tests/bench/bare.h"

namespace sidestep::bench {
namespace {

/// The distances of the moving links to all spheres and of links to one another, with where and in which direction.
void measure_all(const Model& model, const Posture& posture, const ObstacleSet& spheres,
                 std::vector<Proximity>& pairs) {
  BoundedList<Capsule, kMaxShapes> links;
  for (const LinkShape& shape : model.arm.shapes) links.add(placed(posture, shape));
  pairs.clear();
  for (int s = 0; s < links.size(); ++s) {
    if (model.arm.shapes[static_cast<size_t>(s)].body == 0) continue;
    for (int o = 0; o < spheres.count; ++o)
      pairs.push_back(measure_pair(links[s], spheres.obstacles[static_cast<size_t>(o)].capsule));
  }
  for (const auto& [a, b] : model.self_pairs) pairs.push_back(measure_pair(links[a], links[b]));
}

}  // namespace

void BareCycle::run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres, const Vector3& target_m) {
  const double gain_per_s = 8.0, damping2 = 0.05 * 0.05;
  const Posture posture = forward(model.arm, q_rad);
  measure_all(model, posture, spheres, pairs);
  const PointJacobian jacobian = point_jacobian(posture, model.arm.joints, posture.tool_position);
  const Matrix3 gram = jacobian * jacobian.transpose() + damping2 * Matrix3::Identity();
  const Vector3 wish_mps = gain_per_s * (target_m - posture.tool_position);
  velocity_radps = jacobian.transpose() * gram.ldlt().solve(wish_mps);
}

}  // namespace sidestep::bench
