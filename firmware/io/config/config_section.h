#pragma once

#include <yaml-cpp/yaml.h>

#include <set>
#include <string>
#include <vector>

#include "firmware/model/types.h"

namespace sidestep {

/// One mapping of a YAML file, read strictly: every value has the right kind and range, every key is known.
/// All errors are std::runtime_error with one line: file, key, what is wrong.
class Section {
 public:
  /// The whole file as a section. An empty file is an empty mapping.
  static Section of_file(const std::string& file);

  /// No file: every key absent.
  static Section empty() { return Section("command line", "", YAML::Node()); }

  /// A mapping below this one; empty when absent.
  Section section(const std::string& key);

  /// A list of mappings; none when absent.
  std::vector<Section> sections(const std::string& key);

  /// Each leaves `value` as it is when the key is absent.
  void number(const std::string& key, double& value, double lowest, double highest);
  template <typename Whole>
  void whole(const std::string& key, Whole& value, double lowest, double highest) {
    auto read = static_cast<double>(value);
    number(key, read, lowest, highest);
    value = static_cast<Whole>(read);
    if (static_cast<double>(value) != read) fail(key, "must be a whole number");
  }
  void positive(const std::string& key, double& value);
  void not_negative(const std::string& key, double& value);
  void flag(const std::string& key, bool& value);
  void text(const std::string& key, std::string& value);
  void texts(const std::string& key, std::vector<std::string>& values);
  void choice(const std::string& key, std::string& value, const std::vector<std::string>& choices);

  /// A list with as many numbers as `values` has.
  template <typename Vector>
  void numbers(const std::string& key, Vector& values, double lowest, double highest) {
    numbers(key, values.data(), values.size(), lowest, highest);
  }

  /// One number for all joints or a list with one each; may be infinite.
  void per_joint(const std::string& key, int joints, JointVector& value);

  bool has(const std::string& key) const { return static_cast<bool>(node_[key]); }

  /// A list of three finite numbers.
  void vector(const std::string& key, Vector3& value);

  /// Throws, with the new name, where a key still has its old one.
  void renamed(const std::string& old_key, const std::string& new_key) const;

  /// To be called last: throws for a key that nothing has asked for, or one that stands twice.
  void finish() const;

  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  Section(std::string file, std::string path, const YAML::Node& node);
  void numbers(const std::string& key, double* values, Eigen::Index count, double lowest, double highest);
  double number_within(const std::string& key, const YAML::Node& node, double lowest, double highest) const;
  /// The value of a key, or null; remembers that the key is known.
  YAML::Node take(const std::string& key);
  double to_number(const std::string& key, const YAML::Node& node) const;
  std::string to_text(const std::string& key, const YAML::Node& node) const;

  std::string file_;
  std::string path_;  ///< "limits." for the section `limits`
  YAML::Node node_;
  std::set<std::string> known_;
};

}  // namespace sidestep
