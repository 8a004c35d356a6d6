#include "host/campaign/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <tuple>

namespace sidestep::campaign {
namespace {

struct Column {
  const char* name;
  double TrialMetrics::*value;
};

constexpr std::array<Column, 20> kColumns{{
    {"obstacles", &TrialMetrics::obstacles},
    {"duration_s", &TrialMetrics::duration_s},
    {"clearance_m", &TrialMetrics::clearance_m},
    {"final_error_m", &TrialMetrics::final_error_m},
    {"arrival_s", &TrialMetrics::arrival_s},
    {"witness_arrival_s", &TrialMetrics::witness_arrival_s},
    {"path_rad", &TrialMetrics::path_rad},
    {"witness_path_rad", &TrialMetrics::witness_path_rad},
    {"error_rms_m", &TrialMetrics::error_rms_m},
    {"error_max_m", &TrialMetrics::error_max_m},
    {"on_target_share", &TrialMetrics::on_target_share},
    {"turn_rms_rad", &TrialMetrics::turn_rms_rad},
    {"limit_margin_rad", &TrialMetrics::limit_margin_rad},
    {"speed_radps", &TrialMetrics::speed_radps},
    {"acceleration_radps2", &TrialMetrics::acceleration_radps2},
    {"jerk_radps3", &TrialMetrics::jerk_radps3},
    {"chatter_per_s", &TrialMetrics::chatter_per_s},
    {"cpu_mean_s", &TrialMetrics::cpu_mean_s},
    {"cpu_worst_s", &TrialMetrics::cpu_worst_s},
    {"self_clearance_m", &TrialMetrics::self_clearance_m},
}};

std::string header() {
  std::string line = "family,law,seed";
  for (const Column& column : kColumns) line += fmt::format(",{}", column.name);
  return line;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  size_t begin = 0;
  for (size_t comma; (comma = line.find(',', begin)) != std::string::npos; begin = comma + 1)
    cells.push_back(line.substr(begin, comma - begin));
  cells.push_back(line.substr(begin));
  return cells;
}

template <typename Number>
Number to_number(const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) throw std::runtime_error(fmt::format("'{}' is not a number", text));
  return number;
}

Row to_row(const std::string& line) {
  const std::vector<std::string> cells = split(line);
  if (cells.size() != kColumns.size() + 3)
    throw std::runtime_error(fmt::format("{} values instead of {}", cells.size(), kColumns.size() + 3));
  Row row{&family_named(cells[0]), cells[1], to_number<uint64_t>(cells[2]), {}};
  for (size_t i = 0; i < kColumns.size(); ++i) row.metrics.*kColumns[i].value = to_number<double>(cells[i + 3]);
  return row;
}

auto key(const Row& row) {
  return std::tie(row.law, row.family, row.seed);
}

}  // namespace

void write_csv(const std::string& file, const std::vector<Row>& rows) {
  std::ofstream stream(file);
  stream << header() << '\n';
  for (const Row& row : rows) {
    stream << fmt::format("{},{},{}", row.family->name, row.law, row.seed);
    for (const Column& column : kColumns) stream << fmt::format(",{}", row.metrics.*column.value);
    stream << '\n';
  }
  stream.close();
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be written", file));
}

std::vector<Row> read_csv(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  if (!stream || !std::getline(stream, line)) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  if (line != header()) throw std::runtime_error(fmt::format("{}: not a CSV file of campaign trials", file));
  std::vector<Row> rows;
  for (int number = 2; std::getline(stream, line); ++number) {
    try {
      rows.push_back(to_row(line));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("{}:{}: {}", file, number, error.what()));
    }
  }
  return rows;
}

void sort_rows(std::vector<Row>& rows) {
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return key(a) < key(b); });
  const auto duplicate =
      std::adjacent_find(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return key(a) == key(b); });
  if (duplicate != rows.end())
    throw std::runtime_error(
        fmt::format("{}:{} with law {} occurs twice", duplicate->family->name, duplicate->seed, duplicate->law));
}

}  // namespace sidestep::campaign
