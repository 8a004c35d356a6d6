#include "host/campaign/furniture/mover.h"

#include <algorithm>

#include "host/campaign/witness_fit.h"

namespace sidestep::campaign {
namespace {

constexpr int kMostDraws = 2'000;
constexpr double kSlowest_mps = 0.1;
constexpr int kEarlierOrLater = 150, kWayPeriods = 10;  // periods
constexpr int kFurniturePeriods = 5;                    // between two looks at the furniture: at most 25 mm of the way

/// A sphere that passes near a random point of a moving link at a random time of the witness's motion.
SpherePath draw_sphere(Random& random, const Scene& scene) {
  const double t_s = random.uniform(0.2, 1.0) * scene.witness_s;
  const ArmPose pose = scene.arm->pose(witness_rad(scene, t_s));
  const auto link = static_cast<size_t>(random.integer(1, static_cast<int>(pose.corners.size()) - 2));
  const double share = random.uniform(0.0, 1.0);
  const Vector3 aside = random.direction();
  const Vector3 pass_m =
      pose.corners[link] + share * (pose.corners[link + 1] - pose.corners[link]) + random.uniform(0.15, 0.35) * aside;
  const Vector3 direction = random.direction();
  const Vector3 velocity_mps = random.uniform(kSlowest_mps, scene.family->speed_mps) * direction;
  return {pass_m - t_s * velocity_mps, velocity_mps};
}

bool touches_furniture(const Scene& scene, const SpherePath& path) {
  sim::Obstacle sphere;
  sphere.solid.size_m.x() = kSphereRadius_m;
  for (int k = 0; k <= scene.periods; k += kFurniturePeriods) {
    sphere.motion.position_m = path.at(k * kPeriod_s).position_m;
    const Eigen::Isometry3d base_from_sphere = sphere.motion.base_from_body();
    const bool touches = std::any_of(scene.furniture.begin(), scene.furniture.end(), [&](const sim::Obstacle& solid) {
      return sim::lower_bound_m(sphere.solid, base_from_sphere, solid) < 0.0 &&
             sim::signed_distance_m(sphere.solid, base_from_sphere, solid.solid, solid.motion.base_from_body()) < 0.0;
    });
    if (touches) return true;
  }
  return false;
}

/// Whether the sphere touches the arm in a posture that the witness has a little earlier or later: it crosses the way,
/// and another timing of the same path is a contact.
bool crosses_way(const Scene& scene, const std::vector<ArmPose>& witness, const SpherePath& sphere) {
  for (int k = 0; k * kPeriod_s < scene.witness_s; k += kWayPeriods) {
    const int first = std::max(0, k - kEarlierOrLater), last = std::min(scene.periods, k + kEarlierOrLater);
    for (int other = first; other <= last; other += kWayPeriods) {
      const Vector3 centre_m = sphere.at(k * kPeriod_s).position_m;
      if (scene.arm->clearance(witness[static_cast<size_t>(other)], centre_m, kSphereRadius_m, 0.0) < 0.0) return true;
    }
  }
  return false;
}

}  // namespace

bool draw_mover(Random& random, Scene& scene) {
  std::vector<ArmPose> witness;
  for (int k = 0; k <= scene.periods; ++k) witness.push_back(scene.arm->pose(witness_rad(scene, k * kPeriod_s)));
  for (int draw = 0; draw < kMostDraws; ++draw) {
    SpherePath sphere = draw_sphere(random, scene);
    if (touches_furniture(scene, sphere) || !fits_witness(*scene.arm, witness, sphere)) continue;
    if (!crosses_way(scene, witness, sphere)) continue;
    scene.spheres = {std::move(sphere)};
    return true;
  }
  return false;
}

}  // namespace sidestep::campaign
