#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace sidestep::campaign {

/// Random numbers that are the same with every standard library: the standard defines the engine exactly, but not the
/// distributions, so they are implemented here.
class Random {
 public:
  /// Streams of different names are independent for the same seed.
  Random(const std::string& stream, uint64_t seed) {
    std::vector<uint32_t> words(stream.begin(), stream.end());
    words.push_back(static_cast<uint32_t>(seed));
    words.push_back(static_cast<uint32_t>(seed >> 32));
    std::seed_seq sequence(words.begin(), words.end());
    engine_.seed(sequence);
  }

  double uniform(double low, double high) { return low + (high - low) * unit(); }

  /// Uniform over low .. high, both included.
  int integer(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }

  /// Uniform on the unit sphere.
  Eigen::Vector3d direction() {
    const double z = uniform(-1.0, 1.0), angle = uniform(-M_PI, M_PI), r = std::sqrt(1.0 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  Eigen::Vector3d in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const double x = unit(), y = unit(), z = unit();
    return low + (high - low).cwiseProduct(Eigen::Vector3d(x, y, z));
  }

  /// Standard normal.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - unit()));
    return radius * std::cos(uniform(-M_PI, M_PI));
  }

 private:
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  std::mt19937_64 engine_;
};

}  // namespace sidestep::campaign
