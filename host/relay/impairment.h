#pragma once

#include <cstdint>
#include <random>
#include <regex>
#include <string>
#include <vector>

namespace sidestep::relay {

/// Impairment of the messages of some channels. Each value without a unit is the share of the messages, 0 to 1.
struct Rule {
  std::regex channel;
  double drop = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0;  ///< delayed until later messages have overtaken it
  double corrupt = 0.0;
  double least_delay_s = 0.0, most_delay_s = 0.0;
};

/// Parses "CHANNEL:drop=0.1,delay=0.005..0.05"; CHANNEL is a regular expression. Throws std::runtime_error with one
/// line.
Rule parse_rule(const std::string& text);

struct Delivery {
  double due_s;
  std::string channel;
  std::vector<uint8_t> bytes;
};

struct Counts {
  int64_t received = 0, dropped = 0, duplicated = 0, reordered = 0, corrupted = 0;
};

/// Model of a bad network. The same seed and the same messages give the same deliveries.
class Impairment {
 public:
  Impairment(std::vector<Rule> rules, unsigned seed) : rules_(std::move(rules)), random_(seed) {}

  /// The deliveries of a message: none, one or two. The first rule that matches the channel applies; without one the
  /// message is delivered unchanged at once.
  std::vector<Delivery> deliver(const std::string& channel, std::vector<uint8_t> bytes, double now_s);

  const Counts& counts() const { return counts_; }

 private:
  /// Draws whether an impairment with this share happens, and counts it.
  bool draw(double share, int64_t& count);
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void corrupt(std::vector<uint8_t>& bytes);

  std::vector<Rule> rules_;
  std::mt19937 random_;
  Counts counts_;
};

}  // namespace sidestep::relay
