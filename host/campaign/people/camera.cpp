#include "host/campaign/people/camera.h"

#include "host/people/body.h"

namespace sidestep::campaign {
namespace {

constexpr size_t kSetsForVelocity = 4;

}  // namespace

Obstacle person_obstacle(const CapsuleMotion& motion) {
  Obstacle obstacle;
  obstacle.shape = Shape::kCapsule;
  obstacle.kind = Kind::kPerson;
  obstacle.capsule = motion.capsule;
  obstacle.velocity_mps = motion.centre_mps();
  obstacle.angular_velocity_radps = motion.angular_radps();
  return obstacle;
}

Camera::Camera(const Scene& scene)
    : scene_(scene), random_("camera", scene.seed), noise_m_(random_.uniform(0.005, 0.010)) {}

void Camera::draw_swap(double clock_s) {
  constexpr size_t kPairs[] = {kUpperArmLeft, kForearmLeft, kHandLeft, kThighLeft, kShankLeft};
  const auto persons = static_cast<int>(scene_.capsules.size() / kBodyParts);
  const bool begins = random_.uniform(0.0, 1.0) < kSwap;
  const size_t pair = kPairs[random_.integer(0, 4)] + kBodyParts * static_cast<size_t>(random_.integer(0, persons - 1));
  if (!begins || clock_s < swapped_until_s_) return;
  swapped_ = pair;
  swapped_until_s_ = clock_s + kSwapped_s;
}

bool Camera::capture(double clock_s, double t_s, std::vector<Obstacle>& obstacles) {
  const auto noisy = [this](const Vector3& point_m) -> Vector3 {
    const double x = random_.normal(), y = random_.normal(), z = random_.normal();
    return point_m + noise_m_ * Vector3(x, y, z);
  };
  Set set{clock_s, {}};
  for (const CapsulePath& path : scene_.capsules) {
    const Capsule capsule = path.at(t_s).capsule;
    const Vector3 start_m = noisy(capsule.start);
    set.ends.push_back({start_m, noisy(capsule.end)});
  }
  draw_swap(clock_s);
  if (clock_s < swapped_until_s_) std::swap(set.ends[swapped_], set.ends[swapped_ + 1]);
  if (random_.uniform(0.0, 1.0) < kLoss) return false;
  sets_.push_back(std::move(set));
  if (sets_.size() > kSetsForVelocity) sets_.pop_front();
  const Set &first = sets_.front(), &last = sets_.back();
  const double dt_s = last.clock_s - first.clock_s;
  obstacles.clear();
  for (size_t i = 0; i < last.ends.size(); ++i) {
    CapsuleMotion motion = scene_.capsules[i].at(t_s);  // of which only the radius counts
    motion.capsule = {last.ends[i].start_m, last.ends[i].end_m, motion.capsule.radius_m};
    motion.start_mps = motion.end_mps = Vector3::Zero();
    if (dt_s > 0.0) motion.start_mps = (last.ends[i].start_m - first.ends[i].start_m) / dt_s;
    if (dt_s > 0.0) motion.end_mps = (last.ends[i].end_m - first.ends[i].end_m) / dt_s;
    obstacles.push_back(person_obstacle(motion));
  }
  return true;
}

}  // namespace sidestep::campaign
