#pragma once

#include <cstdint>

namespace sidestep {

/// Pseudo-random numbers (SplitMix64; Steele, Lea, Flood 2014). The same seed gives the same sequence on every
/// platform, which the distributions of the standard library do not guarantee.
class SplitMix64 {
 public:
  explicit SplitMix64(int64_t seed) : state_(static_cast<uint64_t>(seed)) {}

  /// Uniformly distributed in [lower, upper), with 53 random bits.
  double uniform(double lower, double upper) {
    state_ += 0x9e3779b97f4a7c15ULL;
    uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
    return lower + (upper - lower) * static_cast<double>(z >> 11) * 0x1.0p-53;
  }

 private:
  uint64_t state_;
};

}  // namespace sidestep
