#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/model/arm.h"

namespace sidestep::test {

/// Random values from a seed; the same on every run.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double uniform(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(engine_); }
  double normal() { return std::normal_distribution<double>()(engine_); }
  int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  uint64_t bits() { return engine_(); }

  Vector3 inside(double lower, double upper) {
    const double x = uniform(lower, upper), y = uniform(lower, upper), z = uniform(lower, upper);
    return Vector3(x, y, z);
  }
  Vector3 direction() {
    Vector3 v = inside(-1, 1);
    while (v.norm() < 0.1 || v.norm() > 1.0) v = inside(-1, 1);
    return v.normalized();
  }
  Quaternion turn() {
    const Vector3 axis = direction();
    return Quaternion(Eigen::AngleAxisd(uniform(-M_PI, M_PI), axis));
  }
  JointVector joints(int count, double lower, double upper) {
    JointVector v(count);
    for (int i = 0; i < count; ++i) v[i] = uniform(lower, upper);
    return v;
  }
  /// A random configuration within this share of the position limits; of a joint that turns farther, within one turn
  /// around the middle.
  JointVector configuration(const Arm& arm, double share = 1.0) {
    JointVector q_rad(arm.joints);
    for (int i = 0; i < arm.joints; ++i) {
      const double centre = 0.5 * (arm.limits.lower_rad[i] + arm.limits.upper_rad[i]);
      const double around = std::isfinite(centre) ? centre : 0.0, turn_rad = arm.prismatic[i] ? HUGE_VAL : M_PI;
      const double lower = std::max(arm.limits.lower_rad[i], around - turn_rad);
      const double upper = std::min(arm.limits.upper_rad[i], around + turn_rad);
      const double middle = 0.5 * (lower + upper), half = 0.5 * share * (upper - lower);
      q_rad[i] = uniform(middle - half, middle + half);
    }
    return q_rad;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace sidestep::test
