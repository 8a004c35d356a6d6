#include "host/sim/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "firmware/base/text_file.h"
#include "firmware/io/config/yaml_document.h"

namespace sidestep::sim {
namespace {

// Keys of hostile files may hold line breaks; an error is one line.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return text.size() > 300 ? text.substr(0, 300) + "..." : text;
}

std::string text_of(const YAML::Node& key) {
  return key.IsScalar() ? key.Scalar() : "(not a text)";
}

}  // namespace

Fields::Fields(const YAML::Node& map, std::string file, std::string prefix)
    : map_(map), file_(std::move(file)), prefix_(std::move(prefix)) {
  if (!map_.IsMap()) fail("", "must be a map of keys and values");
  std::set<std::string> seen;
  for (const auto& entry : map_) {
    const std::string key = text_of(entry.first);
    if (!seen.insert(key).second) fail(key, "given twice");
  }
}

Fields Fields::from_file(const std::string& file) {
  try {
    return Fields(only_document(read_text_file(file)), file, "");
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(one_line(fmt::format("{}: line {}: {}", file, error.mark.line + 1, error.msg)));
  }
}

void Fields::fail(const std::string& key, const std::string& complaint) const {
  std::string where = prefix_ + key;
  if (key.empty() && !where.empty()) where.pop_back();
  throw std::runtime_error(one_line(fmt::format("{}: {}{}{}", file_, where, where.empty() ? "" : ": ", complaint)));
}

bool Fields::has(const std::string& key) const {
  return static_cast<const YAML::Node&>(map_)[key].IsDefined();
}

bool Fields::is_list(const std::string& key) const {
  return has(key) && static_cast<const YAML::Node&>(map_)[key].IsSequence();
}

YAML::Node Fields::value(const std::string& key) {
  if (!has(key)) fail(key, "missing");
  asked_.insert(key);
  return map_[key];
}

std::string Fields::text(const std::string& key) {
  const YAML::Node node = value(key);
  if (!node.IsScalar() || node.Scalar().empty()) fail(key, "must be a text");
  return one_line(node.Scalar());
}

std::vector<std::string> Fields::texts(const std::string& key) {
  const YAML::Node node = value(key);
  if (!node.IsSequence()) fail(key, "must be a list of texts");
  std::vector<std::string> texts;
  for (const YAML::Node& entry : node) {
    if (!entry.IsScalar()) fail(fmt::format("{}[{}]", key, texts.size()), "must be a text");
    texts.push_back(entry.Scalar());
  }
  return texts;
}

double Fields::number_in(const YAML::Node& node, const std::string& key, Range range) const {
  double parsed = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, parsed) || !std::isfinite(parsed)) {
    fail(key, "must be a finite number");
  }
  if (parsed < range.least || parsed > range.most) {
    fail(key, fmt::format("must be from {} to {}, is {}", range.least, range.most, parsed));
  }
  return parsed;
}

double Fields::number(const std::string& key, Range range) {
  return number_in(value(key), key, range);
}

int Fields::whole(const std::string& key, Range range) {
  const double parsed = number(key, range);
  if (parsed != std::floor(parsed)) fail(key, "must be a whole number");
  return static_cast<int>(parsed);
}

Eigen::VectorXd Fields::numbers(const std::string& key, int least_count, int most_count, Range range) {
  const YAML::Node node = value(key);
  const size_t count = node.IsSequence() ? node.size() : 0;
  if (count < static_cast<size_t>(least_count) || count > static_cast<size_t>(most_count)) {
    const std::string counts =
        least_count == most_count ? std::to_string(least_count) : fmt::format("{} to {}", least_count, most_count);
    fail(key, fmt::format("must be a list of {} numbers", counts));
  }
  Eigen::VectorXd values(count);
  for (size_t i = 0; i < count; ++i) values[i] = number_in(node[i], fmt::format("{}[{}]", key, i), range);
  return values;
}

std::vector<Eigen::VectorXd> Fields::rows(const std::string& key, const std::vector<Range>& columns) {
  const YAML::Node node = value(key);
  if (!node.IsSequence() || node.size() == 0) fail(key, "must be a list of lists, at least one");
  std::vector<Eigen::VectorXd> rows;
  for (const YAML::Node& entry : node) {
    const std::string row_key = fmt::format("{}[{}]", key, rows.size());
    if (!entry.IsSequence() || entry.size() != columns.size()) {
      fail(row_key, fmt::format("must be a list of {} numbers", columns.size()));
    }
    Eigen::VectorXd& row = rows.emplace_back(columns.size());
    for (size_t i = 0; i < columns.size(); ++i) {
      row[i] = number_in(entry[i], fmt::format("{}[{}]", row_key, i), columns[i]);
    }
  }
  return rows;
}

Fields Fields::section(const std::string& key) {
  return Fields(value(key), file_, prefix_ + key + ".");
}

std::vector<Fields> Fields::list(const std::string& key) {
  const YAML::Node node = value(key);
  if (!node.IsSequence()) fail(key, "must be a list");
  std::vector<Fields> fields;
  for (const YAML::Node& entry : node) {
    fields.push_back(Fields(entry, file_, fmt::format("{}{}[{}].", prefix_, key, fields.size())));
  }
  return fields;
}

void Fields::done() const {
  for (const auto& entry : map_) {
    if (asked_.count(text_of(entry.first)) == 0) fail(text_of(entry.first), "unknown key");
  }
}

}  // namespace sidestep::sim
