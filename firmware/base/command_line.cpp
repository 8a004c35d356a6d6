#include "firmware/base/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <set>

// The Makefile defines SIDESTEP_VERSION, without quotes, from the file VERSION.
#define SIDESTEP_TEXT_OF(tokens) #tokens
#define SIDESTEP_TEXT(macro) SIDESTEP_TEXT_OF(macro)

namespace sidestep {

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option Option::one_of(const std::vector<std::string>& values) {
  option_->check(CLI::IsMember(values));
  return *this;
}

Option Option::range(double lower, double upper) {
  const auto error_of = [lower, upper](const std::string& text) {
    double value = 0.0;
    const bool within = CLI::detail::lexical_cast(text, value) && !(value < lower || value > upper);
    return within ? "" : fmt::format("Value {} not in range {:g} to {:g}", text, lower, upper);
  };
  option_->check(CLI::Validator(error_of, fmt::format("FLOAT in [{:g} - {:g}]", lower, upper)));
  return *this;
}

Option Option::range(int lower, int upper) {
  option_->check(CLI::Range(lower, upper));
  return *this;
}

Option Option::not_nan() {
  const auto error_of = [](const std::string& text) {
    return std::isnan(std::strtod(text.c_str(), nullptr)) ? "is not a number" : "";
  };
  option_->check(CLI::Validator(error_of, ""));
  return *this;
}

Option Option::one_value_at_a_time() {
  option_->allow_extra_args(false);
  return *this;
}

CommandLine::CommandLine(const std::string& description) : app_(std::make_shared<CLI::App>(description)) {
  app_->set_version_flag("--version", "Sidestep " SIDESTEP_TEXT(SIDESTEP_VERSION), "print the version and exit");
}

CommandLine::CommandLine(std::shared_ptr<CLI::App> app) : app_(std::move(app)) {}

CommandLine::~CommandLine() = default;

Option CommandLine::add_option(const std::string& name, std::string& value, const std::string& help) {
  return Option(*app_->add_option(name, value, help));
}

Option CommandLine::add_option(const std::string& name, double& value, const std::string& help) {
  return Option(*app_->add_option(name, value, help));
}

Option CommandLine::add_option(const std::string& name, int& value, const std::string& help) {
  return Option(*app_->add_option(name, value, help));
}

Option CommandLine::add_option(const std::string& name, unsigned& value, const std::string& help) {
  return Option(*app_->add_option(name, value, help));
}

Option CommandLine::add_option(const std::string& name, uint64_t& value, const std::string& help) {
  return Option(*app_->add_option(name, value, help));
}

Option CommandLine::add_option(const std::string& name, std::vector<std::string>& values, const std::string& help) {
  return Option(*app_->add_option(name, values, help));
}

void CommandLine::add_flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

CommandLine CommandLine::add_subcommand(const std::string& name, const std::string& help) {
  app_->add_subcommand(name, help)->fallthrough();
  return CommandLine(app_->get_subcommand_ptr(name));
}

void CommandLine::footer(const std::string& text) {
  app_->footer(text);
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    constexpr int kWrongArguments = 2;
    return app_->exit(error) == 0 ? 0 : kWrongArguments;
  }
}

}  // namespace sidestep
