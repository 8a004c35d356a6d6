#include "host/relay/impairment.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace sidestep::relay {
namespace {

constexpr double kReorderDelay_s = 0.03;  // of a reordered message; longer than the period of any channel
constexpr double kLongestDelay_s = 10.0;

double number(const std::string& rule, const std::string& text, double highest) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end || !(value >= 0.0 && value <= highest))
    throw std::runtime_error(fmt::format("{}: '{}' must be a number from 0 to {}", rule, text, highest));
  return value;
}

void set(const std::string& text, const std::string& key, const std::string& value, Rule& rule) {
  if (key == "drop") {
    rule.drop = number(text, value, 1.0);
  } else if (key == "duplicate") {
    rule.duplicate = number(text, value, 1.0);
  } else if (key == "reorder") {
    rule.reorder = number(text, value, 1.0);
  } else if (key == "corrupt") {
    rule.corrupt = number(text, value, 1.0);
  } else if (key == "delay") {
    const size_t dots = value.find("..");
    rule.least_delay_s = number(text, value.substr(0, dots), kLongestDelay_s);
    rule.most_delay_s =
        dots == std::string::npos ? rule.least_delay_s : number(text, value.substr(dots + 2), kLongestDelay_s);
    if (rule.most_delay_s < rule.least_delay_s)
      throw std::runtime_error(text + ": delay: the second value must not be less than the first");
  } else {
    throw std::runtime_error(fmt::format("{}: unknown impairment '{}'", text, key));
  }
}

}  // namespace

Rule parse_rule(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == 0 || colon == std::string::npos)
    throw std::runtime_error(text + ": must be CHANNEL:IMPAIRMENT=VALUE,...");
  Rule rule;
  try {
    rule.channel = std::regex(text.substr(0, colon));
  } catch (const std::regex_error&) {
    throw std::runtime_error(text + ": the channel is not a valid regular expression");
  }
  std::istringstream settings(text.substr(colon + 1));
  for (std::string setting; std::getline(settings, setting, ',');) {
    const size_t equals = std::min(setting.find('='), setting.size());
    set(text, setting.substr(0, equals), setting.substr(std::min(equals + 1, setting.size())), rule);
  }
  return rule;
}

bool Impairment::draw(double share, int64_t& count) {
  const bool drawn = uniform(0.0, 1.0) < share;
  count += drawn;
  return drawn;
}

/// Changes up to 8 bytes. Before that one third of the messages lose their end, and another third get bytes appended.
void Impairment::corrupt(std::vector<uint8_t>& bytes) {
  const auto below = [this](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random_); };
  const size_t kind = below(3);
  if (kind == 0) bytes.resize(below(bytes.size() + 1));
  if (kind == 1) bytes.resize(bytes.size() + 1 + below(64));
  for (size_t n = 1 + below(8); n > 0 && !bytes.empty(); --n) bytes[below(bytes.size())] ^= 1 + below(255);
}

std::vector<Delivery> Impairment::deliver(const std::string& channel, std::vector<uint8_t> bytes, double now_s) {
  ++counts_.received;
  const auto rule = std::find_if(rules_.begin(), rules_.end(),
                                 [&](const Rule& candidate) { return std::regex_match(channel, candidate.channel); });
  if (rule == rules_.end()) return {{now_s, channel, std::move(bytes)}};
  if (draw(rule->drop, counts_.dropped)) return {};
  if (draw(rule->corrupt, counts_.corrupted)) corrupt(bytes);
  const double reorder_delay_s = draw(rule->reorder, counts_.reordered) ? kReorderDelay_s : 0.0;
  std::vector<Delivery> deliveries;
  for (int copies = draw(rule->duplicate, counts_.duplicated) ? 2 : 1; copies > 0; --copies) {
    const double delay_s = uniform(rule->least_delay_s, rule->most_delay_s) + reorder_delay_s;
    deliveries.push_back({now_s + delay_s, channel, bytes});
  }
  return deliveries;
}

}  // namespace sidestep::relay
