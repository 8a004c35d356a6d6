#include "firmware/io/config/config_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "firmware/base/text_file.h"
#include "firmware/io/config/yaml_document.h"

namespace sidestep {
namespace {

/// A scrambled file can make anything part of a message; it stays one line all the same.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c); }, ' ');
  return text;
}

}  // namespace

Section::Section(std::string file, std::string path, const YAML::Node& node)
    : file_(std::move(file)), path_(std::move(path)), node_(node) {
  if (node_.IsNull()) node_ = YAML::Node(YAML::NodeType::Map);
  if (!node_.IsMap()) {
    const std::string what = path_.empty() ? "the file" : fmt::format("'{}'", path_.substr(0, path_.size() - 1));
    throw std::runtime_error(fmt::format("{}: {} must be a mapping of keys to values", file_, what));
  }
}

Section Section::of_file(const std::string& file) {
  const std::string text = read_text_file(file);
  try {
    return Section(file, "", only_document(text));
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(
        fmt::format("{}:{}: not valid YAML: {}", file, error.mark.line + 1, on_one_line(error.msg)));
  }
}

void Section::fail(const std::string& key, const std::string& what) const {
  const size_t longest = 60;
  std::string name = path_ + key;
  if (name.size() > longest) name.replace(longest, std::string::npos, "...");
  throw std::runtime_error(fmt::format("{}: {}: {}", file_, on_one_line(name), what));
}

YAML::Node Section::take(const std::string& key) {
  known_.insert(key);
  const YAML::Node& node = node_;  // the non-const operator would insert the key
  return node[key] ? node[key] : YAML::Node();
}

Section Section::section(const std::string& key) {
  return Section(file_, path_ + key + ".", take(key));
}

std::vector<Section> Section::sections(const std::string& key) {
  const YAML::Node node = take(key);
  if (!node.IsNull() && !node.IsSequence()) fail(key, "must be a list");
  std::vector<Section> sections;
  for (const YAML::Node& entry : node)
    sections.push_back(Section(file_, fmt::format("{}{}[{}].", path_, key, sections.size()), entry));
  return sections;
}

double Section::to_number(const std::string& key, const YAML::Node& node) const {
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || std::isnan(value))
    fail(key, "must be a number");
  return value;
}

void Section::number(const std::string& key, double& value, double lowest, double highest) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  value = number_within(key, node, lowest, highest);
}

double Section::number_within(const std::string& key, const YAML::Node& node, double lowest, double highest) const {
  const double number = to_number(key, node);
  if (!(number >= lowest && number <= highest))
    fail(key, fmt::format("is {}, must be between {} and {}", number, lowest, highest));
  return number;
}

void Section::numbers(const std::string& key, double* values, Eigen::Index count, double lowest, double highest) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (!node.IsSequence() || node.size() != static_cast<size_t>(count))
    fail(key, fmt::format("must be a list of {} numbers", count));
  for (const YAML::Node& entry : node) *values++ = number_within(key, entry, lowest, highest);
}

void Section::positive(const std::string& key, double& value) {
  number(key, value, std::numeric_limits<double>::min(), std::numeric_limits<double>::max());
}

void Section::not_negative(const std::string& key, double& value) {
  number(key, value, 0.0, std::numeric_limits<double>::max());
}

void Section::flag(const std::string& key, bool& value) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) fail(key, "must be true or false");
}

std::string Section::to_text(const std::string& key, const YAML::Node& node) const {
  if (!node.IsScalar() || node.Scalar().empty()) fail(key, "must be a text");
  const std::string& text = node.Scalar();
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c); }))
    fail(key, "must not hold control characters");
  return text;
}

void Section::text(const std::string& key, std::string& value) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  value = to_text(key, node);
}

void Section::texts(const std::string& key, std::vector<std::string>& values) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (!node.IsSequence()) fail(key, "must be a list of texts");
  values.clear();
  for (const YAML::Node& entry : node) values.push_back(to_text(key, entry));
}

void Section::choice(const std::string& key, std::string& value, const std::vector<std::string>& choices) {
  text(key, value);
  for (const std::string& choice : choices)
    if (value == choice) return;
  fail(key, fmt::format("is '{}', must be one of: {}", value, fmt::join(choices, ", ")));
}

void Section::per_joint(const std::string& key, int joints, JointVector& value) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (node.IsScalar()) {
    value = JointVector::Constant(joints, to_number(key, node));
    return;
  }
  if (!node.IsSequence() || node.size() != static_cast<size_t>(joints))
    fail(key, fmt::format("must be a list of {} numbers, one for each joint", joints));
  value.resize(joints);
  for (int i = 0; i < joints; ++i) value[i] = to_number(key, node[i]);
}

void Section::vector(const std::string& key, Vector3& value) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (!node.IsSequence() || node.size() != 3) fail(key, "must be a list of 3 numbers");
  for (int i = 0; i < 3; ++i) value[i] = to_number(key, node[i]);
  if (!value.allFinite()) fail(key, "must be finite");
}

void Section::renamed(const std::string& old_key, const std::string& new_key) const {
  if (has(old_key)) fail(old_key, fmt::format("this key is now called '{}'", new_key));
}

void Section::finish() const {
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    if (known_.count(key) == 0) fail(key, "there is no such key");
    if (!seen.insert(key).second) fail(key, "stands twice");
  }
}

}  // namespace sidestep
