#pragma once

#include <array>
#include <cstdint>

namespace sidestep {

/// A histogram of durations with fixed logarithmic bins: 16 per doubling, from 0.1 us to 1.7 s. Durations outside that
/// range (and NaN, as 0) count in the outermost bins. Adding takes constant time and allocates nothing.
class Histogram {
 public:
  void add(double duration_s);

  /// The duration, s, that a share (0 to 1) of all durations did not exceed: never too low, at most 4.4 % (one bin) too
  /// high. 0 for an empty histogram.
  double quantile_s(double share) const;
  /// The longest duration, s, exact.
  double worst_s() const { return worst_s_; }
  int64_t count() const { return count_; }

 private:
  static constexpr int kBinsPerDoubling = 16;
  static constexpr int kBins = 24 * kBinsPerDoubling;

  std::array<int64_t, kBins> bins_{};
  int64_t count_ = 0;
  double worst_s_ = 0.0;
};

}  // namespace sidestep
