#pragma once

#include "host/campaign/search/search_scene.h"
#include "host/sim/truth.h"

namespace sidestep::test {

/// Clearance of a scene of the campaign's search by the URDF and FCL, which share nothing with the search's own
/// distances.
class CapsuleTruth {
 public:
  double clearance_m(const campaign::SearchScene& scene, const sim::JointVector& q_rad, double t_s) {
    std::vector<sim::Obstacle> obstacles;
    for (const campaign::MovingCapsule& obstacle : scene.obstacles) obstacles.push_back(solid_of(obstacle.at(t_s)));
    truth_.place(q_rad);
    return truth_.nearest(obstacles).clearance_m;
  }

 private:
  static sim::Obstacle solid_of(const Capsule& capsule) {
    sim::Obstacle obstacle;
    const Eigen::Vector3d axis_m = capsule.end - capsule.start;
    obstacle.solid = {capsule.is_sphere() ? sim::Shape::kSphere : sim::Shape::kCapsule,
                      {capsule.radius_m, axis_m.norm(), 0.0},
                      nullptr};
    obstacle.motion.position_m = capsule.centre();
    if (!capsule.is_sphere())
      obstacle.motion.orientation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis_m);
    return obstacle;
  }

  sim::Truth truth_{sim::Arm("urdf/lwa3.urdf", "base_link", "tool", {})};
};

}  // namespace sidestep::test
