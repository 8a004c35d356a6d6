#pragma once

#include <cstdint>
#include <random>
#include <regex>
#include <string>
#include <vector>

namespace sidestep::relay {

/// What happens to the messages of some channels; shares are from 0 to 1.
struct Rule {
  std::regex channel;
  double drop = 0.0;
  double duplicate = 0.0;
  double reorder = 0.0;  ///< held back for so long that later ones overtake it
  double corrupt = 0.0;
  double least_delay_s = 0.0, most_delay_s = 0.0;
};

/// Reads "CHANNEL:drop=0.1,delay=0.005..0.05"; CHANNEL is a regular expression. Throws std::runtime_error with one
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

/// A bad network: the same seed and the same messages give the same mischief.
class Impairment {
 public:
  Impairment(std::vector<Rule> rules, unsigned seed) : rules_(std::move(rules)), random_(seed) {}

  /// What becomes of a message: nothing, one delivery or two. The first rule that fits its channel applies; none: it
  /// passes unharmed.
  std::vector<Delivery> deliver(const std::string& channel, std::vector<uint8_t> bytes, double now_s);

  const Counts& counts() const { return counts_; }

 private:
  bool happens(double share, int64_t& count);
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void corrupt(std::vector<uint8_t>& bytes);

  std::vector<Rule> rules_;
  std::mt19937 random_;
  Counts counts_;
};

}  // namespace sidestep::relay
