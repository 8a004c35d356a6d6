#include "host/campaign/sensing.h"

#include <numeric>
#include <utility>

#include "host/campaign/solids.h"

namespace sidestep::campaign {
namespace {

constexpr double kNoise_m = 0.005, kLoss = 0.10;
constexpr int64_t kRate_hz = 30, kDelay_us = 40'000;
static_assert(kRate_hz == Camera::kRate_hz);

Obstacle moving_sphere(const PointMotion& centre) {
  Obstacle obstacle = sphere_obstacle(centre.position_m, kSphereRadius_m);
  obstacle.velocity_mps = centre.velocity_mps;
  return obstacle;
}

}  // namespace

Sensing::Sensing(const Scene& scene) : scene_(scene), random_("sensing", scene.seed), camera_(scene) {}

const ObstacleMeasurement& Sensing::newest_at(int64_t now_us, double t_s) {
  t_s += scene_.ahead_s;
  if (!scene_.family->real && !scene_.family->camera) {
    receive(exact(now_us, t_s));
    return newest_;
  }
  for (int64_t at_us; (at_us = next_capture_ * 1'000'000 / kRate_hz) <= now_us; ++next_capture_)
    capture(at_us, t_s - static_cast<double>(now_us - at_us) / 1e6);
  while (!in_transit_.empty() && in_transit_.front().received_us <= now_us) {
    receive(std::move(in_transit_.front()));
    in_transit_.pop_front();
  }
  return newest_;
}

void Sensing::receive(ObstacleMeasurement measurement) {
  measurement.count = newest_.count + 1;
  newest_ = std::move(measurement);
  if (scene_.shuffles_obstacles) shuffle(newest_);
  if (scene_.reports_velocities) return;
  for (Obstacle& obstacle : newest_.obstacles) {
    obstacle.velocity_mps.setZero();
    obstacle.angular_velocity_radps.setZero();
  }
}

/// The algorithm of Fisher and Yates; std::shuffle may differ between standard libraries.
void Sensing::shuffle(ObstacleMeasurement& measurement) {
  std::vector<size_t>& order = measurement.order;
  order.resize(measurement.obstacles.size());
  std::iota(order.begin(), order.end(), size_t{0});
  for (size_t last = order.size(); last-- > 1;)
    std::swap(order[last], order[static_cast<size_t>(random_.integer(0, static_cast<int>(last)))]);
}

ObstacleMeasurement Sensing::exact(int64_t now_us, double t_s) const {
  ObstacleMeasurement measurement;
  measurement.received_us = now_us;
  for (const SpherePath& sphere : scene_.spheres) measurement.obstacles.push_back(moving_sphere(sphere.at(t_s)));
  for (const sim::Obstacle& box : boxes_at(scene_, t_s)) measurement.obstacles.push_back(reported(box));
  for (const CapsulePath& capsule : scene_.capsules) measurement.obstacles.push_back(person_obstacle(capsule.at(t_s)));
  for (const sim::Obstacle& solid : scene_.furniture) measurement.obstacles.push_back(reported(solid));
  return measurement;
}

void Sensing::capture(int64_t at_us, double t_s) {
  if (scene_.family->camera)
    capture_people(at_us, t_s);
  else
    capture_spheres(at_us, t_s);
}

void Sensing::capture_people(int64_t at_us, double t_s) {
  ObstacleMeasurement measurement;
  measurement.received_us = at_us + Camera::kDelay_us;
  if (camera_.capture(static_cast<double>(at_us) / 1e6, t_s, measurement.obstacles))
    in_transit_.push_back(std::move(measurement));
}

void Sensing::capture_spheres(int64_t at_us, double t_s) {
  ObstacleMeasurement measurement;
  measurement.received_us = at_us + kDelay_us;
  for (const SpherePath& sphere : scene_.spheres) {
    PointMotion measured = sphere.at(t_s);
    for (int axis = 0; axis < 3; ++axis) measured.position_m[axis] += kNoise_m * random_.normal();
    measurement.obstacles.push_back(moving_sphere(measured));
  }
  const bool lost = random_.uniform(0.0, 1.0) < kLoss;
  if (!lost) in_transit_.push_back(std::move(measurement));
}

}  // namespace sidestep::campaign
