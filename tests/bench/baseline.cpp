#include "tests/bench/baseline.h"
#include "firmware/base/bounded_list.h"
#include "firmware/model/clearance.h"

#include <algorithm>
#include <limits>

#include "firmware/control/paper/damped_inverse.h"

namespace sidestep::bench {
namespace {

/// Measures the moving links against all spheres and the self-pairs: distance, nearest points and normal.
void measure_all(const Model& model, const LinkPoses& poses, const ObstacleSet& spheres,
                 std::vector<Proximity>& pairs) {
  BoundedList<Capsule, kMaxShapes> links;
  for (const LinkShape& shape : model.arm.shapes) links.add(transformed(poses, shape));
  pairs.clear();
  for (int s = 0; s < links.size(); ++s) {
    if (model.arm.shapes[static_cast<size_t>(s)].body == 0) continue;
    for (int o = 0; o < spheres.count; ++o)
      pairs.push_back(measure_pair(links[s], spheres.obstacles[static_cast<size_t>(o)].capsule));
  }
  for (const SelfPair& pair : model.self_pairs) pairs.push_back(measure_pair(links[pair.first], links[pair.second]));
}

/// The least distance of the moving links to the spheres, without nearest points; one square root a pair.
double nearest_sphere_m(const Arm& arm, const LinkPoses& poses, const ObstacleSet& spheres) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const LinkShape& shape : arm.shapes) {
    if (shape.body == 0) continue;
    const Capsule link = transformed(poses, shape);
    const Vector3 axis = link.end - link.start;
    const double inverse_length2 = axis.squaredNorm() > 0.0 ? 1.0 / axis.squaredNorm() : 0.0;
    for (int o = 0; o < spheres.count; ++o) {
      const Capsule& sphere = spheres.obstacles[static_cast<size_t>(o)].capsule;
      const Vector3 to_sphere = sphere.start - link.start;
      const double along = std::clamp(axis.dot(to_sphere) * inverse_length2, 0.0, 1.0);
      const double distance_m = (to_sphere - along * axis).norm() - link.radius_m - sphere.radius_m;
      nearest_m = std::min(nearest_m, distance_m);
    }
  }
  return nearest_m;
}

JointVector toward(const LinkPoses& poses, const Vector3& target_m) {
  const double gain_per_s = 8.0, damping = 0.05;
  const PointJacobian jacobian = point_jacobian(poses, poses.joints, poses.tool_position);
  return damped_solve(jacobian, damping, gain_per_s * (target_m - poses.tool_position));
}

}  // namespace

void BaselineCycle::run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres,
                        const Vector3& target_m) {
  const LinkPoses poses = forward_kinematics(model.arm, q_rad);
  measure_all(model, poses, spheres, pairs);
  velocity_radps = toward(poses, target_m);
}

void DistanceOnlyCycle::run(const Model& model, const JointVector& q_rad, const ObstacleSet& spheres,
                            const Vector3& target_m) {
  const LinkPoses poses = forward_kinematics(model.arm, q_rad);
  nearest_m = nearest_sphere_m(model.arm, poses, spheres);
  velocity_radps = toward(poses, target_m);
}

}  // namespace sidestep::bench
