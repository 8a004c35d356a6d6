#pragma once

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "firmware/model/types.h"

namespace sidestep {

/// Inclusive bounds of a number.
struct NumberRange {
  double lowest;
  double highest;
};

/// One mapping of a YAML file, read strictly: every key is known and given once, every value has the right kind and
/// range. All errors are std::runtime_error with one line: file, key, complaint, number of the line. Control characters
/// in it are replaced and its length is bounded, because any of it can come from a damaged file.
///
/// A member that takes a `value` to fill is for an optional key: it leaves the value unchanged when the key is absent
/// or has no value (null). A member that returns the value is for a required key.
class YamlSection {
 public:
  /// The whole file. An empty file is an empty mapping; a second document in the file is an error.
  static YamlSection of_file(const std::string& file);

  /// A mapping without keys, for a configuration without a file.
  static YamlSection empty() { return YamlSection("command line", "", YAML::Node()); }

  /// True when the key is given, with a value or with null.
  bool has(const std::string& key) const { return node_[key].IsDefined(); }

  /// Throws unless the key has a value.
  void require(const std::string& key) const;

  /// Throws, with the new name, when the key is given under its old name.
  void renamed(const std::string& old_key, const std::string& new_key) const;

  /// A mapping below this one; empty when absent.
  YamlSection section(const std::string& key);

  /// A list of mappings; empty when absent.
  std::vector<YamlSection> sections(const std::string& key);

  double number(const std::string& key, NumberRange range);
  void number(const std::string& key, double& value, NumberRange range);

  int whole(const std::string& key, NumberRange range);
  template <typename Whole>
  void whole(const std::string& key, Whole& value, NumberRange range) {
    auto number_read = static_cast<double>(value);
    number(key, number_read, range);
    if (number_read != std::floor(number_read)) fail(key, "must be a whole number");
    value = static_cast<Whole>(number_read);
  }

  void flag(const std::string& key, bool& value);

  /// Texts are not empty and hold no control characters.
  std::string text(const std::string& key);
  void text(const std::string& key, std::string& value);
  void texts(const std::string& key, std::vector<std::string>& values);

  /// A number for each key of a mapping, whatever its keys are; empty when absent.
  std::map<std::string, double> named_numbers(const std::string& key, NumberRange range);

  std::string choice(const std::string& key, const std::vector<std::string>& choices);
  void choice(const std::string& key, std::string& value, const std::vector<std::string>& choices);

  /// A list of lowest_count to highest_count numbers.
  Eigen::VectorXd numbers(const std::string& key, int lowest_count, int highest_count, NumberRange range);
  Vector3 vector(const std::string& key, NumberRange range) { return numbers(key, 3, 3, range); }
  void vector(const std::string& key, Vector3& value, NumberRange range);

  /// One number for all joints or a list with one for each.
  JointVector per_joint(const std::string& key, int joints, NumberRange range);
  void per_joint(const std::string& key, int joints, JointVector& value, NumberRange range);

  /// True when the key is given as a list.
  bool is_list(const std::string& key) const { return node_[key].IsDefined() && node_[key].IsSequence(); }

  /// A table: a list of at least one row; a row is a list with one number for each column.
  std::vector<Eigen::VectorXd> rows(const std::string& key, const std::vector<NumberRange>& columns);

  /// Must be called after all known keys have been read: throws for any other key.
  void finish() const;

  [[noreturn]] void fail(const std::string& key, const std::string& complaint) const;

 private:
  YamlSection(std::string file, std::string prefix, const YAML::Node& node);

  /// The value of a key, null when absent; the key counts as known from then on.
  YAML::Node take(const std::string& key);
  /// Where a key stands in the file, from 1, or the first key of the section where it is absent; 0: unknown.
  int line_of(const std::string& key) const;
  double to_number(const std::string& key, const YAML::Node& node, NumberRange range) const;
  std::string to_text(const std::string& key, const YAML::Node& node) const;

  std::string file_;
  std::string prefix_;     ///< of the keys in errors: "limits." in the section `limits`
  const YAML::Node node_;  ///< const: operator[] of a mutable node inserts the key
  std::set<std::string> known_;
};

}  // namespace sidestep
