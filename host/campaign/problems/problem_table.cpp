#include "host/campaign/problems/problem_table.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "firmware/base/fail.h"
#include "host/campaign/statistics.h"

namespace sidestep::campaign {
namespace {

using Results = std::vector<ProblemResult>;

template <typename Holds>
long count(const Results& results, const Holds& holds) {
  return std::count_if(results.begin(), results.end(), holds);
}

/// Of the solved ones; "-" without any.
std::string median_arrival_s(const Results& results) {
  std::vector<double> arrivals_s;
  for (const ProblemResult& result : results)
    if (result.arrived(0.01) && !result.touched()) arrivals_s.push_back(result.arrival_s);
  if (arrivals_s.empty()) return "-";
  const auto middle = arrivals_s.begin() + static_cast<long>(arrivals_s.size() / 2);
  std::nth_element(arrivals_s.begin(), middle, arrivals_s.end());
  return fmt::format("{:.2f}", *middle);
}

/// The least clearance to a mover, mm; "-" without any.
std::string mover_clearance_mm(const Results& results) {
  double least_m = std::numeric_limits<double>::quiet_NaN();
  for (const ProblemResult& result : results) least_m = std::fmin(least_m, result.mover_clearance_m);
  return std::isnan(least_m) ? "-" : fmt::format("{:.1f}", 1e3 * least_m);
}

std::string line(const std::string& kind, const Results& results) {
  double clearance_m = sim::kNothingNear;
  for (const ProblemResult& result : results) clearance_m = std::min(clearance_m, result.clearance_m);
  const auto arrived = [&](double within_m) {
    return count(results, [=](const ProblemResult& r) { return r.arrived(within_m) && !r.touched(); });
  };
  return fmt::format("{:24}{:10}{:10}{:10}{:10}{:14.1f}{:>14}{:>16}\n", kind, results.size(), arrived(0.01),
                     arrived(0.005), count(results, [](const ProblemResult& r) { return r.touched(); }),
                     clearance_m * 1e3, mover_clearance_mm(results), median_arrival_s(results));
}

/// The shares of all problems with their 95 % confidence intervals.
std::string intervals(const Results& results) {
  const auto share = [&](const char* name, long count) {
    const auto problems = static_cast<double>(results.size()), found = static_cast<double>(count);
    const Interval interval = wilson_interval(found, problems);
    return fmt::format("{} {:.1f} % ({:.1f}-{:.1f})", name, 100.0 * found / problems, interval.lower, interval.upper);
  };
  const long solved = count(results, [](const ProblemResult& r) { return r.arrived(0.01) && !r.touched(); });
  const long touched = count(results, [](const ProblemResult& r) { return r.touched(); });
  return fmt::format("All, with 95 % confidence: {}, {}.\n", share("solved to 10 mm", solved),
                     share("contact", touched));
}

}  // namespace

std::string problem_table(const Results& results) {
  std::string table = fmt::format("{:24}{:>10}{:>10}{:>10}{:>10}{:>14}{:>14}{:>16}\n", "", "problems", "solved",
                                  "solved", "contact", "clearance", "to mover", "arrival");
  table += fmt::format("{:24}{:>10}{:>10}{:>10}{:>10}{:>14}{:>14}{:>16}\n", "", "", "to 10 mm", "to 5 mm", "",
                       "min, mm", "min, mm", "median, s");
  for (auto first = results.begin(); first != results.end();) {
    const auto end = std::find_if(first, results.end(), [&](const ProblemResult& r) { return r.kind != first->kind; });
    table += line(first->kind, Results(first, end));
    first = end;
  }
  return table + line("all", results) + intervals(results) +
         "Published for the whole set of 7 x 100: VAMP (RRT-Connect) solves 699. cuRobo solves all of its 800.\n";
}

void write_problem_csv(const std::string& file, const Results& results) {
  std::ofstream stream(file);
  stream << "kind,name,error_m,error_rad,arrival_s,clearance_m,self_clearance_m,mover_clearance_m,guided\n";
  for (const ProblemResult& r : results)
    fmt::print(stream, "{},{},{:.6f},{:.6f},{:.2f},{:.6f},{:.6f},{:.6f},{:.3f}\n", r.kind, r.name, r.error_m,
               r.error_rad, r.arrival_s, r.clearance_m, r.self_clearance_m, r.mover_clearance_m, r.guided);
  stream.close();
  if (!stream) fail("{}: cannot be written", file);
}

}  // namespace sidestep::campaign
