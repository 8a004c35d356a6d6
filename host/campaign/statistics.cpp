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
  return row.metrics.final_error_m < arrived_within_m(*row.family);
}
bool succeeded(const Row& row) {
  return !touched(row) && arrived(row);
}

Sample successes(const Sample& sample) {
  Sample result;
  std::copy_if(sample.begin(), sample.end(), std::back_inserter(result), succeeded);
  return result;
}

double percent(const Sample& sample, bool (*holds)(const Row&)) {
  return 100.0 * static_cast<double>(std::count_if(sample.begin(), sample.end(), holds)) /
         static_cast<double>(sample.size());
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
