#include "host/campaign/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/campaign/statistics.h"

namespace sidestep::campaign {
namespace {

using Value = double TrialMetrics::*;
using Statistic = std::function<double(const Sample&)>;
using Bounds = std::function<Interval(const Sample&)>;

Statistic share(bool (*holds)(const Row&)) {
  return [=](const Sample& sample) { return percent(sample, holds); };
}

Statistic average(Value value, double unit = 1.0) {
  return [=](const Sample& sample) { return mean(sample, value) / unit; };
}

Statistic average_success(Value value) {
  return [=](const Sample& sample) { return mean(successes(sample), value); };
}

Statistic over_witness(Value value, Value of_witness) {
  return [=](const Sample& sample) { return ratio(sample, value, of_witness); };
}

Statistic maximum(Value value, double unit = 1.0) {
  return [=](const Sample& sample) { return largest(sample, value) / unit; };
}

Statistic minimum(Value value, double unit = 1.0) {
  return [=](const Sample& sample) { return least(sample, value) / unit; };
}

/// One column of a table; title and unit are two lines above its values.
struct Column {
  const char* title;
  const char* unit;
  int digits;
  Statistic statistic;
  Bounds bounds = nullptr;  ///< printed behind the value
};

/// A share with its confidence interval.
Column interval_column(const char* title, bool (*holds)(const Row&)) {
  return {title, "% (95 %)", 1, share(holds), [=](const Sample& sample) { return confidence(sample, holds); }};
}

using Columns = std::vector<Column>;
using Line = std::vector<std::string>;

constexpr double kMilli = 1e-3, kMicro = 1e-6, kDegree = M_PI / 180.0;

const Columns& boxes_columns() {
  static const Columns columns{
      interval_column("success", succeeded),
      interval_column("contact", touched),
      {"of links", "%", 1, share(touched_itself)},
      {"arrival", "%", 1, share(arrived)},
      {"clearance", "min, mm", 1, minimum(&TrialMetrics::clearance_m, kMilli)},
      {"arrival", "s", 2, average_success(&TrialMetrics::arrival_s)},
  };
  return columns;
}

/// Those of scenes without a witness, then what compares with the witness and the moving target.
Columns reach_columns() {
  Columns columns = boxes_columns();
  columns.insert(
      columns.end(),
      {
          {"arrival", "/ witness", 2, over_witness(&TrialMetrics::arrival_s, &TrialMetrics::witness_arrival_s)},
          {"joint path", "/ witness", 2, over_witness(&TrialMetrics::path_rad, &TrialMetrics::witness_path_rad)},
          {"tracking", "RMS, mm", 1, average(&TrialMetrics::error_rms_m, kMilli)},
          {"on target", "% of time", 1, average(&TrialMetrics::on_target_share, 0.01)},
      });
  return columns;
}

Columns full_pose_columns() {
  Columns columns = reach_columns();
  columns.push_back({"orientation", "RMS, deg", 1, average(&TrialMetrics::turn_rms_rad, kDegree)});
  return columns;
}

const Columns& dodge_columns() {
  static const Columns columns{
      interval_column("contact", touched),
      {"of links", "%", 1, share(touched_itself)},
      {"tool error", "RMS, mm", 1, average(&TrialMetrics::error_rms_m, kMilli)},
      {"tool error", "max, mm", 0, maximum(&TrialMetrics::error_max_m, kMilli)},
      {"orientation", "RMS, deg", 1, average(&TrialMetrics::turn_rms_rad, kDegree)},
      {"returned", "%", 1, share(arrived)},
      {"clearance", "min, mm", 1, minimum(&TrialMetrics::clearance_m, kMilli)},
  };
  return columns;
}

const Columns& people_columns() {
  static const Columns columns{
      interval_column("success", succeeded),
      interval_column("contact", touched),
      interval_column("avoidable", touched_avoidably),
      {"still when", "seen, %", 1, share(touched_avoidably_when_seen)},
      interval_column("deeper than", touched_deeper_than_at_rest),
      {"arm at rest", "touched, %", 1, share(touched_at_rest)},
      {"of links", "%", 1, share(touched_itself)},
      {"own closing", "max, m/s", 2, maximum(&TrialMetrics::closing_mps)},
      {"clearance", "min, mm", 1, minimum(&TrialMetrics::clearance_m, kMilli)},
  };
  return columns;
}

const Columns& furniture_columns() {
  static const Columns columns{
      interval_column("success", succeeded),
      interval_column("contact", touched),
      {"of links", "%", 1, share(touched_itself)},
      {"of mover", "%", 1, share(touched_mover)},
      {"arrival", "%", 1, share(arrived)},
      {"clearance", "min, mm", 1, minimum(&TrialMetrics::clearance_m, kMilli)},
      {"arrival", "s", 2, average_success(&TrialMetrics::arrival_s)},
      {"arrival", "/ witness", 2, over_witness(&TrialMetrics::arrival_s, &TrialMetrics::witness_arrival_s)},
      {"joint path", "/ witness", 2, over_witness(&TrialMetrics::path_rad, &TrialMetrics::witness_path_rad)},
  };
  return columns;
}

const Columns& cpu_columns() {
  static const Columns columns{
      {"hot step", "mean, us", 1, average(&TrialMetrics::cpu_mean_s, kMicro)},
      {"hot step", "max, us", 0, maximum(&TrialMetrics::cpu_worst_s, kMicro)},
  };
  return columns;
}

const Columns& smoothness_columns() {
  static const Columns columns{
      {"joint margin", "min, rad", 3, minimum(&TrialMetrics::limit_margin_rad)},
      {"speed", "max, rad/s", 3, maximum(&TrialMetrics::speed_radps)},
      {"acceleration", "max, rad/s2", 2, maximum(&TrialMetrics::acceleration_radps2)},
      {"acceleration", "mean max", 2, average(&TrialMetrics::acceleration_radps2)},
      {"jerk", "max, rad/s3", 0, maximum(&TrialMetrics::jerk_radps3)},
      {"jerk", "mean max", 0, average(&TrialMetrics::jerk_radps3)},
      {"chatter", "max, 1/s", 1, maximum(&TrialMetrics::chatter_per_s)},
      {"chatter", "mean, 1/s", 2, average(&TrialMetrics::chatter_per_s)},
  };
  return columns;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const std::string text = fmt::format("{:.{}f}", value, digits);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return zero && text[0] == '-' ? text.substr(1) : text;
}

Line line_of(const Sample& sample, const Columns& columns) {
  const Row &first = sample.front(), &last = sample.back();
  Line line{first.law, first.family->name, fmt::format("{}", sample.size()),
            fmt::format("{}..{}", first.seed, last.seed)};
  for (const Column& column : columns) {
    line.push_back(number(column.statistic(sample), column.digits));
    if (!column.bounds) continue;
    const Interval bounds = column.bounds(sample);
    line.back() += fmt::format(" ({}-{})", number(bounds.lower, column.digits), number(bounds.upper, column.digits));
  }
  return line;
}

/// Makes every column as wide as its widest cell; the first two columns are left-aligned, the others right-aligned.
std::string aligned(const std::vector<Line>& lines) {
  std::vector<size_t> widths(lines.front().size(), 0);
  for (const Line& line : lines)
    for (size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  std::string text;
  for (const Line& line : lines) {
    std::string joined;
    for (size_t i = 0; i < line.size(); ++i) joined += fmt::format(i < 2 ? "{:<{}}  " : "{:>{}}  ", line[i], widths[i]);
    joined.erase(joined.find_last_not_of(' ') + 1);
    text += joined + '\n';
  }
  return text;
}

std::string table(const std::vector<Sample>& samples, const Columns& columns) {
  if (samples.empty()) return {};
  std::vector<Line> lines{{"law", "family", "scenes", "seeds"}, {"", "", "", ""}};
  for (const Column& column : columns) {
    lines[0].emplace_back(column.title);
    lines[1].emplace_back(column.unit);
  }
  for (const Sample& sample : samples) lines.push_back(line_of(sample, columns));
  return aligned(lines) + '\n';
}

}  // namespace

std::string tables(const std::vector<Row>& rows, bool with_cpu) {
  const auto all = [&](Columns columns) {
    if (with_cpu) columns.insert(columns.end(), cpu_columns().begin(), cpu_columns().end());
    return columns;
  };
  std::vector<Sample> reaches, full_poses, dodges, people, furniture, boxes;
  for (Sample& sample : samples(rows)) {
    const Family& family = *sample.front().family;
    (family.dodge             ? dodges
     : family.has_people()    ? people
     : family.has_furniture() ? furniture
     : family.boxes           ? boxes
     : family.full_pose       ? full_poses
                              : reaches)
        .push_back(std::move(sample));
  }
  return table(reaches, all(reach_columns())) + table(full_poses, all(full_pose_columns())) +
         table(dodges, all(dodge_columns())) + table(people, all(people_columns())) +
         table(furniture, all(furniture_columns())) + table(boxes, all(boxes_columns()));
}

std::string smoothness_table(const std::vector<Row>& rows) {
  return table(samples(rows), smoothness_columns());
}

}  // namespace sidestep::campaign
