#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sidestep {

/// What an option demands of its value and what the help text shows for it. Valid as long as its command line.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option required();
  /// The help text shows this name instead of the type of the value.
  Option type_name(const std::string& name);
  /// The help text shows the value that the variable has now.
  Option show_default();
  Option one_of(const std::vector<std::string>& values);
  /// Both ends are permitted. NaN passes, unless not_nan() forbids it.
  Option range(double lower, double upper);
  Option range(int lower, int upper);
  Option not_nan();
  /// The option of a vector takes one value, but may be repeated.
  Option one_value_at_a_time();

 private:
  CLI::Option* option_;
};

/// The options of a program. parse() writes the values to the variables that the options were declared with; these
/// variables must outlive the command line. This class hides CLI11, which is slow to compile.
class CommandLine {
 public:
  explicit CommandLine(const std::string& description);
  ~CommandLine();

  /// A name with dashes ("--config") declares an option, a name without dashes a positional argument. A vector takes
  /// any number of values.
  Option add_option(const std::string& name, std::string& value, const std::string& help);
  Option add_option(const std::string& name, double& value, const std::string& help);
  Option add_option(const std::string& name, int& value, const std::string& help);
  Option add_option(const std::string& name, unsigned& value, const std::string& help);
  Option add_option(const std::string& name, uint64_t& value, const std::string& help);
  Option add_option(const std::string& name, std::vector<std::string>& values, const std::string& help);
  void add_flag(const std::string& name, bool& value, const std::string& help);

  /// A command such as `campaign merge`, with options of its own. The options of the program may follow the command.
  CommandLine add_subcommand(const std::string& name, const std::string& help);

  /// The text below the options in the help text.
  void footer(const std::string& text);

  /// Returns the exit code when the program has to end now: 0 after --help and --version, 2 after an error, which is
  /// printed to standard error.
  std::optional<int> parse(int argc, char** argv);

 private:
  explicit CommandLine(std::shared_ptr<CLI::App> app);

  std::shared_ptr<CLI::App> app_;
};

}  // namespace sidestep
