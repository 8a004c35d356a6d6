#pragma once

#include <array>
#include <cstdint>

namespace sidestep {

/// How often a duration was how long, in fixed bins: 16 for each doubling from 0.1 us to 1.7 s. Adding is bounded and
/// allocates nothing.
class Histogram {
 public:
  void add(double duration_s);

  /// The duration, s, that this share (0 to 1) of all did not exceed: at most 4.4 % too high. 0 before the first.
  double quantile_s(double share) const;
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
