#include "firmware/base/histogram.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr double kLeast_s = 1e-7;

}  // namespace

void Histogram::add(double duration_s) {
  // With the arguments of std::max in this order a NaN counts as kLeast_s.
  const double doublings = std::log2(std::max(kLeast_s, duration_s) / kLeast_s);
  ++bins_[static_cast<size_t>(std::min(doublings * kBinsPerDoubling, kBins - 1.0))];
  ++count_;
  worst_s_ = std::max(worst_s_, duration_s);
}

double Histogram::quantile_s(double share) const {
  const double wanted = share * static_cast<double>(count_);
  int64_t below = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    below += bins_[static_cast<size_t>(bin)];
    // The last bin has no upper edge.
    if (bin + 1 < kBins && below > 0 && static_cast<double>(below) >= wanted)
      return std::min(worst_s_, kLeast_s * std::exp2((bin + 1.0) / kBinsPerDoubling));
  }
  return worst_s_;
}

}  // namespace sidestep
