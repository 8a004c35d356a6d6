#include "host/people/capsule_path.h"

#include <algorithm>

namespace sidestep {
namespace {

/// Position and velocity on the cubic from p with velocity v to q with velocity w, in duration_s; u in 0..1.
void follow_cubic(const Vector3& p, const Vector3& v, const Vector3& q, const Vector3& w, double duration_s, double u,
                  Vector3& position_m, Vector3& velocity_mps) {
  const double uu = u * u, uuu = uu * u;
  position_m = (2.0 * uuu - 3.0 * uu + 1.0) * p + (3.0 * uu - 2.0 * uuu) * q +
               duration_s * ((uuu - 2.0 * uu + u) * v + (uuu - uu) * w);
  velocity_mps = 6.0 * (uu - u) / duration_s * (p - q) + (3.0 * uu - 4.0 * u + 1.0) * v + (3.0 * uu - 2.0 * u) * w;
}

}  // namespace

Vector3 CapsuleMotion::angular_radps() const {
  const Vector3 axis_m = capsule.end - capsule.start;
  const double squared_m2 = axis_m.squaredNorm();
  if (squared_m2 <= 0.0) return Vector3::Zero();
  return axis_m.cross(end_mps - start_mps) / squared_m2;
}

CapsulePath::CapsulePath(double radius_m, double period_s, std::vector<Ends> samples)
    : radius_m_(radius_m), period_s_(period_s), samples_(std::move(samples)) {}

CapsulePath CapsulePath::transformed(const Eigen::Isometry3d& b_from_a) const {
  CapsulePath path = *this;
  for (Ends& ends : path.samples_) ends = {b_from_a * ends.start_m, b_from_a * ends.end_m};
  return path;
}

CapsulePath::Ends CapsulePath::slope_mps(size_t sample) const {
  const size_t before = sample > 0 ? sample - 1 : 0, after = std::min(sample + 1, samples_.size() - 1);
  const double dt_s = static_cast<double>(after - before) * period_s_;
  return {(samples_[after].start_m - samples_[before].start_m) / dt_s,
          (samples_[after].end_m - samples_[before].end_m) / dt_s};
}

CapsuleMotion CapsulePath::at(double t_s) const {
  const double sample = std::max(0.0, t_s / period_s_);
  if (sample >= static_cast<double>(samples_.size() - 1))
    return {{samples_.back().start_m, samples_.back().end_m, radius_m_}, Vector3::Zero(), Vector3::Zero()};
  const auto i = static_cast<size_t>(sample);
  const double u = sample - static_cast<double>(i);
  const Ends from_mps = slope_mps(i), to_mps = slope_mps(i + 1);
  CapsuleMotion motion{{Vector3::Zero(), Vector3::Zero(), radius_m_}, Vector3::Zero(), Vector3::Zero()};
  follow_cubic(samples_[i].start_m, from_mps.start_m, samples_[i + 1].start_m, to_mps.start_m, period_s_, u,
               motion.capsule.start, motion.start_mps);
  follow_cubic(samples_[i].end_m, from_mps.end_m, samples_[i + 1].end_m, to_mps.end_m, period_s_, u, motion.capsule.end,
               motion.end_mps);
  return motion;
}

}  // namespace sidestep
