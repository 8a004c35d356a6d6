#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

namespace sidestep::sim {

/// Inclusive bounds of a number.
struct Range {
  double least;
  double most;
};

/// Strict reading of one YAML map. Whatever is wrong, std::runtime_error says it in one line that names the file and
/// the key: a missing key, a key given twice, not a finite number in range, a wrong size and, with done(), a key nobody
/// asked for.
class Fields {
 public:
  static Fields from_file(const std::string& file);

  bool has(const std::string& key) const;
  std::string text(const std::string& key);
  double number(const std::string& key, Range range);
  int whole(const std::string& key, Range range);

  /// least_count to most_count numbers.
  Eigen::VectorXd numbers(const std::string& key, int least_count, int most_count, Range range);
  Eigen::Vector3d vector(const std::string& key, Range range) { return numbers(key, 3, 3, range); }

  std::vector<std::string> texts(const std::string& key);

  /// A list, not empty, of lists with one number per column.
  std::vector<Eigen::VectorXd> rows(const std::string& key, const std::vector<Range>& columns);

  Fields section(const std::string& key);
  std::vector<Fields> list(const std::string& key);

  /// True when the value of the key is a list.
  bool is_list(const std::string& key) const;

  /// To be called when all has been read.
  void done() const;

  [[noreturn]] void fail(const std::string& key, const std::string& complaint) const;

 private:
  Fields(const YAML::Node& map, std::string file, std::string prefix);
  YAML::Node value(const std::string& key);
  double number_in(const YAML::Node& node, const std::string& key, Range range) const;

  YAML::Node map_;
  std::string file_;
  std::string prefix_;  ///< path of this map with a trailing dot, empty at the top
  std::set<std::string> asked_;
};

}  // namespace sidestep::sim
