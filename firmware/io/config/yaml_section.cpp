#include "firmware/io/config/yaml_section.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "firmware/base/text_file.h"

namespace sidestep {
namespace {

constexpr size_t kLongestKey = 60, kLongestComplaint = 300;  // in an error

bool is_control(unsigned char c) {
  return std::iscntrl(c) != 0;
}

std::string printable(std::string text, size_t longest = std::string::npos) {
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text.size() > longest ? text.substr(0, longest) + "..." : text;
}

std::string name_of(const YAML::Node& key) {
  return key.IsScalar() ? key.Scalar() : "(not a text)";
}

std::string indexed(const std::string& key, size_t index) {
  return fmt::format("{}[{}]", key, index);
}

YAML::Node mapping_of(const YAML::Node& node) {
  return node.IsNull() ? YAML::Node(YAML::NodeType::Map) : node;
}

/// Stores where a document starts and ignores all other events.
class StartOfDocument : public YAML::EventHandler {
 public:
  YAML::Mark mark;

  void OnDocumentStart(const YAML::Mark& start) override { mark = start; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// The only document of a text; null for an empty text. YAML::Load() would ignore a second document without an error.
YAML::Node only_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  StartOfDocument document;
  // Not a loop until the end: yaml-cpp's parser never reaches the end of a text that is a single comma.
  if (parser.HandleNextDocument(document) && parser.HandleNextDocument(document))
    throw YAML::ParserException(document.mark, "a second document starts here; only one is allowed");
  return YAML::Load(text);
}

}  // namespace

YamlSection::YamlSection(std::string file, std::string prefix, const YAML::Node& node)
    : file_(std::move(file)), prefix_(std::move(prefix)), node_(mapping_of(node)) {
  if (!node_.IsMap()) fail("", "must be a mapping of keys to values");
  std::set<std::string> seen;
  for (const auto& entry : node_)
    if (const std::string key = name_of(entry.first); !seen.insert(key).second) fail(key, "is given twice");
}

YamlSection YamlSection::of_file(const std::string& file) {
  const std::string text = read_text_file(file);
  try {
    return YamlSection(file, "", only_document(text));
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(fmt::format("{}: line {}: not valid YAML: {}", printable(file), error.mark.line + 1,
                                         printable(error.msg, kLongestComplaint)));
  }
}

int YamlSection::line_of(const std::string& key) const {
  YAML::Mark mark = node_.Mark();
  for (const auto& entry : node_)
    if (name_of(entry.first) == key.substr(0, key.find('['))) mark = entry.first.Mark();
  return mark.is_null() ? 0 : mark.line + 1;
}

void YamlSection::fail(const std::string& key, const std::string& complaint) const {
  std::string name = prefix_ + key;
  if (key.empty() && !name.empty()) name.pop_back();  // the dot of the prefix
  name = printable(name, kLongestKey);
  const int line = node_.IsMap() ? line_of(key) : 0;
  throw std::runtime_error(fmt::format("{}: {}{}{}{}", printable(file_), name, name.empty() ? "" : ": ",
                                       printable(complaint, kLongestComplaint),
                                       line > 0 ? fmt::format(" (line {})", line) : ""));
}

YAML::Node YamlSection::take(const std::string& key) {
  known_.insert(key);
  const YAML::Node value = node_[key];
  return value.IsDefined() ? value : YAML::Node();
}

void YamlSection::require(const std::string& key) const {
  if (!has(key) || node_[key].IsNull()) fail(key, "is missing");
}

void YamlSection::renamed(const std::string& old_key, const std::string& new_key) const {
  if (has(old_key)) fail(old_key, fmt::format("this key is now called '{}'", new_key));
}

YamlSection YamlSection::section(const std::string& key) {
  return YamlSection(file_, prefix_ + key + ".", take(key));
}

std::vector<YamlSection> YamlSection::sections(const std::string& key) {
  const YAML::Node node = take(key);
  if (!node.IsNull() && !node.IsSequence()) fail(key, "must be a list");
  std::vector<YamlSection> sections;
  for (const YAML::Node& entry : node)
    sections.push_back(YamlSection(file_, prefix_ + indexed(key, sections.size()) + ".", entry));
  return sections;
}

double YamlSection::to_number(const std::string& key, const YAML::Node& node, NumberRange range) const {
  double number = 0.0;
  const bool read = node.IsScalar() && YAML::convert<double>::decode(node, number);
  const bool may_be_infinite = std::isinf(range.highest);
  if (!read || std::isnan(number) || (std::isinf(number) && !may_be_infinite))
    fail(key, may_be_infinite ? "must be a number" : "must be a finite number");
  if (!(number >= range.lowest && number <= range.highest))
    fail(key, fmt::format("is {}, must be from {} to {}", number, range.lowest, range.highest));
  return number;
}

void YamlSection::number(const std::string& key, double& value, NumberRange range) {
  if (const YAML::Node node = take(key); !node.IsNull()) value = to_number(key, node, range);
}

double YamlSection::number(const std::string& key, NumberRange range) {
  require(key);
  return to_number(key, take(key), range);
}

int YamlSection::whole(const std::string& key, NumberRange range) {
  require(key);
  int value = 0;
  whole(key, value, range);
  return value;
}

void YamlSection::flag(const std::string& key, bool& value) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) fail(key, "must be true or false");
}

std::string YamlSection::to_text(const std::string& key, const YAML::Node& node) const {
  if (!node.IsScalar() || node.Scalar().empty()) fail(key, "must be a text");
  const std::string& text = node.Scalar();
  if (std::any_of(text.begin(), text.end(), is_control)) fail(key, "must not hold control characters");
  return text;
}

void YamlSection::text(const std::string& key, std::string& value) {
  if (const YAML::Node node = take(key); !node.IsNull()) value = to_text(key, node);
}

std::string YamlSection::text(const std::string& key) {
  require(key);
  return to_text(key, take(key));
}

void YamlSection::texts(const std::string& key, std::vector<std::string>& values) {
  const YAML::Node node = take(key);
  if (node.IsNull()) return;
  if (!node.IsSequence()) fail(key, "must be a list of texts");
  values.clear();
  for (const YAML::Node& entry : node) values.push_back(to_text(indexed(key, values.size()), entry));
}

std::map<std::string, double> YamlSection::named_numbers(const std::string& key, NumberRange range) {
  YamlSection mapping = section(key);
  std::map<std::string, double> numbers;
  for (const auto& entry : mapping.node_) numbers[name_of(entry.first)] = mapping.number(name_of(entry.first), range);
  return numbers;
}

void YamlSection::choice(const std::string& key, std::string& value, const std::vector<std::string>& choices) {
  text(key, value);
  if (std::find(choices.begin(), choices.end(), value) == choices.end())
    fail(key, fmt::format("is '{}', must be one of: {}", value, fmt::join(choices, ", ")));
}

std::string YamlSection::choice(const std::string& key, const std::vector<std::string>& choices) {
  require(key);
  std::string value;
  choice(key, value, choices);
  return value;
}

Eigen::VectorXd YamlSection::numbers(const std::string& key, int lowest_count, int highest_count, NumberRange range) {
  require(key);
  const YAML::Node node = take(key);
  const size_t count = node.size();
  if (!node.IsSequence() || count < static_cast<size_t>(lowest_count) || count > static_cast<size_t>(highest_count)) {
    const std::string counts = lowest_count == highest_count ? fmt::format("{}", lowest_count)
                                                             : fmt::format("{} to {}", lowest_count, highest_count);
    fail(key, fmt::format("must be a list of {} numbers", counts));
  }
  Eigen::VectorXd values(count);
  for (size_t i = 0; i < count; ++i) values[i] = to_number(indexed(key, i), node[i], range);
  return values;
}

void YamlSection::vector(const std::string& key, Vector3& value, NumberRange range) {
  if (!take(key).IsNull()) value = vector(key, range);
}

JointVector YamlSection::per_joint(const std::string& key, int joints, NumberRange range) {
  require(key);
  const YAML::Node node = take(key);
  if (node.IsScalar()) return JointVector::Constant(joints, to_number(key, node, range));
  return numbers(key, joints, joints, range);
}

void YamlSection::per_joint(const std::string& key, int joints, JointVector& value, NumberRange range) {
  if (!take(key).IsNull()) value = per_joint(key, joints, range);
}

std::vector<Eigen::VectorXd> YamlSection::rows(const std::string& key, const std::vector<NumberRange>& columns) {
  require(key);
  const YAML::Node node = take(key);
  if (!node.IsSequence() || node.size() == 0) fail(key, "must be a list of lists, at least one");
  std::vector<Eigen::VectorXd> rows;
  for (const YAML::Node& entry : node) {
    const std::string row_key = indexed(key, rows.size());
    if (!entry.IsSequence() || entry.size() != columns.size())
      fail(row_key, fmt::format("must be a list of {} numbers", columns.size()));
    Eigen::VectorXd& row = rows.emplace_back(columns.size());
    for (size_t i = 0; i < columns.size(); ++i) row[i] = to_number(indexed(row_key, i), entry[i], columns[i]);
  }
  return rows;
}

void YamlSection::finish() const {
  for (const auto& entry : node_)
    if (const std::string key = name_of(entry.first); known_.count(key) == 0) fail(key, "unknown key");
}

}  // namespace sidestep
