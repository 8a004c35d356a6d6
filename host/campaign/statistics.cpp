#include "host/campaign/statistics.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "host/campaign/scene.h"

namespace sidestep::campaign {

std::vector<Sample> samples(const std::vector<Row>& rows) {
  std::vector<Sample> result;
  for (const Row& row : rows) {
    const bool same =
        !result.empty() && result.back().back().law == row.law && result.back().back().family == row.family;
    if (!same) result.emplace_back();
    result.back().push_back(row);
  }
  return result;
}

bool touched(const Row& row) {
  return row.metrics.clearance_m < 0.0 || touched_itself(row);
}
bool touched_itself(const Row& row) {
  return row.metrics.self_clearance_m <= 0.0;
}
bool arrived(const Row& row) {
  if (row.family->posture) return row.metrics.final_posture_rad < kArrivedJoint_rad;
  const bool turned_away = row.metrics.final_turn_rad >= kArrived_rad;  // false where there is no orientation
  return row.metrics.final_error_m < arrived_within_m(*row.family) && !turned_away;
}
bool succeeded(const Row& row) {
  return !touched(row) && arrived(row);
}

Sample successes(const Sample& sample) {
  Sample result;
  std::copy_if(sample.begin(), sample.end(), std::back_inserter(result), succeeded);
  return result;
}

bool touched_avoidably(const Row& row) {
  return row.metrics.clearance_m < 0.0 && row.metrics.way_out > 0.0;
}
bool touched_avoidably_when_seen(const Row& row) {
  return row.metrics.clearance_m < 0.0 && row.metrics.seen_way_out > 0.0;
}
bool touched_deeper_than_at_rest(const Row& row) {
  constexpr double kDeeper_m = 1e-3;
  return row.metrics.clearance_m < std::min(0.0, row.metrics.rest_clearance_m) - kDeeper_m;
}
bool touched_at_rest(const Row& row) {
  return row.metrics.rest_clearance_m < 0.0;
}

bool touched_mover(const Row& row) {
  return row.metrics.mover_clearance_m < 0.0;
}

double percent(const Sample& sample, bool (*holds)(const Row&)) {
  return 100.0 * static_cast<double>(std::count_if(sample.begin(), sample.end(), holds)) /
         static_cast<double>(sample.size());
}

// E. B. Wilson, "Probable inference, the law of succession, and statistical inference", 1927.
Interval wilson_interval(double successes, double trials) {
  constexpr double kZ = 1.959963984540054;
  const double share = successes / trials, z2 = kZ * kZ / trials;
  const double middle = share + 0.5 * z2;
  const double half = kZ * std::sqrt(share * (1.0 - share) / trials + 0.25 * z2 / trials);
  const double scale = 100.0 / (1.0 + z2);
  return {std::max(0.0, scale * (middle - half)), std::min(100.0, scale * (middle + half))};
}

Interval confidence(const Sample& sample, bool (*holds)(const Row&)) {
  return wilson_interval(static_cast<double>(std::count_if(sample.begin(), sample.end(), holds)),
                         static_cast<double>(sample.size()));
}

double mean(const Sample& sample, double TrialMetrics::*value) {
  double sum = 0.0;
  int count = 0;
  for (const Row& row : sample) {
    if (std::isnan(row.metrics.*value)) continue;
    sum += row.metrics.*value;
    ++count;
  }
  return sum / count;
}

double largest(const Sample& sample, double TrialMetrics::*value) {
  double result = TrialMetrics::kNone;
  for (const Row& row : sample) result = std::fmax(result, row.metrics.*value);
  return result;
}

double least(const Sample& sample, double TrialMetrics::*value) {
  double result = TrialMetrics::kNone;
  for (const Row& row : sample) result = std::fmin(result, row.metrics.*value);
  return result;
}

double ratio(const Sample& sample, double TrialMetrics::*value, double TrialMetrics::*reference) {
  const Sample good = successes(sample);
  const double sum = std::accumulate(good.begin(), good.end(), 0.0, [&](double so_far, const Row& row) {
    return so_far + row.metrics.*value / row.metrics.*reference;
  });
  return sum / static_cast<double>(good.size());
}

}  // namespace sidestep::campaign
