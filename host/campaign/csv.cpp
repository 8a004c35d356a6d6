#include "host/campaign/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
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

/// Only in files with families of people.
constexpr std::array<Column, 4> kPeopleColumns{{
    {"rest_clearance_m", &TrialMetrics::rest_clearance_m},
    {"closing_mps", &TrialMetrics::closing_mps},
    {"way_out", &TrialMetrics::way_out},
    {"seen_way_out", &TrialMetrics::seen_way_out},
}};

/// Only in files with families of furniture.
constexpr std::array<Column, 4> kFurnitureColumns{{
    {"final_turn_rad", &TrialMetrics::final_turn_rad},
    {"mover_clearance_m", &TrialMetrics::mover_clearance_m},
    {"goal_clearance_m", &TrialMetrics::goal_clearance_m},
    {"model_goal_clearance_m", &TrialMetrics::model_goal_clearance_m},
}};

/// Only in files with families whose goal is a posture.
constexpr Column kPostureColumn{"final_posture_rad", &TrialMetrics::final_posture_rad};

std::vector<Column> columns_of(MoreColumns more) {
  std::vector<Column> columns(kColumns.begin(), kColumns.end());
  if (more.people) columns.insert(columns.end(), kPeopleColumns.begin(), kPeopleColumns.end());
  if (more.furniture) columns.insert(columns.end(), kFurnitureColumns.begin(), kFurnitureColumns.end());
  if (more.posture) columns.push_back(kPostureColumn);
  return columns;
}

std::string header(MoreColumns more) {
  std::string line = "family,law,seed";
  for (const Column& column : columns_of(more)) line += fmt::format(",{}", column.name);
  return line;
}

/// The columns with this header; none if there are no such columns.
std::vector<Column> columns_named(const std::string& line) {
  for (const bool people : {false, true})
    for (const bool furniture : {false, true})
      for (const bool posture : {false, true})
        if (line == header({people, furniture, posture})) return columns_of({people, furniture, posture});
  return {};
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

Row to_row(const std::string& line, const std::vector<Column>& columns) {
  const std::vector<std::string> cells = split(line);
  if (cells.size() != columns.size() + 3)
    throw std::runtime_error(fmt::format("{} values instead of {}", cells.size(), columns.size() + 3));
  Row row{&family_named(cells[0]), cells[1], to_number<uint64_t>(cells[2]), {}};
  for (size_t i = 0; i < columns.size(); ++i) row.metrics.*columns[i].value = to_number<double>(cells[i + 3]);
  return row;
}

std::string to_line(const Row& row, const std::vector<Column>& columns) {
  std::string line = fmt::format("{},{},{}", row.family->name, row.law, row.seed);
  for (const Column& column : columns) line += fmt::format(",{}", row.metrics.*column.value);
  return line;
}

std::vector<Row> read_rows(std::istream& stream, const std::string& file) {
  std::string line;
  std::getline(stream, line);
  const std::vector<Column> columns = columns_named(line);
  if (columns.empty()) throw std::runtime_error(fmt::format("{}: not a CSV file of campaign trials", file));
  std::vector<Row> rows;
  for (int number = 2; std::getline(stream, line); ++number) {
    try {
      rows.push_back(to_row(line, columns));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("{}:{}: {}", file, number, error.what()));
    }
  }
  return rows;
}

auto key(const Row& row) {
  return std::tie(row.law, row.family, row.seed);
}

}  // namespace

CsvWriter::CsvWriter(const std::string& file, MoreColumns more, const std::vector<Row>& rows)
    : file_(file), more_(more) {
  const bool replaces = std::filesystem::is_regular_file(file);  // else it is new, or such as /dev/stdout
  const std::string replaced = replaces ? std::filesystem::canonical(file).string() : file;
  const std::string written = replaces ? replaced + ".new" : replaced;
  stream_.open(written);
  stream_ << header(more) << '\n';
  for (const Row& row : rows) write(row);
  flush();
  if (replaces) std::filesystem::rename(written, replaced);
}

void CsvWriter::add(const Row& row) {
  const std::lock_guard<std::mutex> lock(mutex_);
  write(row);
  flush();
}

void CsvWriter::write(const Row& row) {
  stream_ << to_line(row, columns_of(more_)) << '\n';
}

void CsvWriter::flush() {
  stream_.flush();
  if (!stream_) throw std::runtime_error(fmt::format("{}: cannot be written", file_));
}

void write_csv(const std::string& file, const std::vector<Row>& rows) {
  MoreColumns more;
  for (const Row& row : rows) more.include(*row.family);
  CsvWriter(file, more, rows);
}

std::vector<Row> read_csv(const std::string& file) {
  std::ifstream stream(file);
  if (!stream || stream.peek() == std::ifstream::traits_type::eof())
    throw std::runtime_error(fmt::format("{}: cannot be read", file));
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::istringstream lines(text);
  std::vector<Row> rows = read_rows(lines, file);
  if (text.back() != '\n')
    throw std::runtime_error(fmt::format("{}: the last line has no end, it may be cut short", file));
  return rows;
}

std::vector<Row> read_interrupted_csv(const std::string& file) {
  std::ifstream stream(file);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  text.resize(text.rfind('\n') + 1);  // 0 without any
  std::istringstream lines(text);
  return text.empty() ? std::vector<Row>{} : read_rows(lines, file);
}

bool same_result(const Row& a, const Row& b) {
  const std::vector<Column> columns = columns_of({true, true, true});
  return std::all_of(columns.begin(), columns.end(), [&](const Column& column) {
    const double x = a.metrics.*column.value, y = b.metrics.*column.value;
    const bool is_cpu = std::string(column.name).rfind("cpu", 0) == 0;
    return is_cpu || x == y || (std::isnan(x) && std::isnan(y));
  });
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
