#include "host/campaign/random.h"

#include <cmath>
#include <vector>

namespace sidestep::campaign {

Random::Random(const std::string& stream, uint64_t seed) {
  std::vector<uint32_t> words(stream.begin(), stream.end());
  words.push_back(static_cast<uint32_t>(seed));
  words.push_back(static_cast<uint32_t>(seed >> 32));
  std::seed_seq sequence(words.begin(), words.end());
  engine_.seed(sequence);
}

double Random::uniform(double low, double high) {
  return low + (high - low) * unit();
}

int Random::integer(int low, int high) {
  return low + static_cast<int>(unit() * (high - low + 1));
}

Eigen::Vector3d Random::direction() {
  const double z = uniform(-1.0, 1.0), angle = uniform(-M_PI, M_PI), r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Eigen::Vector3d Random::in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const double x = unit(), y = unit(), z = unit();
  return low + (high - low).cwiseProduct(Eigen::Vector3d(x, y, z));
}

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - unit()));
  return radius * std::cos(uniform(-M_PI, M_PI));
}

double Random::unit() {
  return static_cast<double>(engine_() >> 11) * 0x1p-53;
}

}  // namespace sidestep::campaign
