#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>

namespace sidestep::campaign {

/// Random numbers that are the same with every standard library: the standard defines the engine exactly, but not the
/// distributions, so they are implemented here.
class Random {
 public:
  /// Streams of different names are independent for the same seed.
  Random(const std::string& stream, uint64_t seed);

  double uniform(double low, double high);

  /// Uniform over low .. high, both included.
  int integer(int low, int high);

  /// Uniform on the unit sphere.
  Eigen::Vector3d direction();

  Eigen::Vector3d in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

  /// Standard normal.
  double normal();

 private:
  double unit();

  std::mt19937_64 engine_;
};

}  // namespace sidestep::campaign
