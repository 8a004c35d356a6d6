#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <lcm/lcm-cpp.hpp>
#include <queue>

#include "firmware/base/command_line.h"
#include "firmware/base/realtime.h"
#include "host/relay/impairment.h"

namespace {

using namespace sidestep::relay;
using sidestep::monotonic_s;

std::atomic<bool> stop{false};

/// Order of the queue: the earliest delivery is at the top.
struct DueLater {
  bool operator()(const Delivery& a, const Delivery& b) const { return a.due_s > b.due_s; }
};

/// Forwards messages from one network to another, in this direction only.
class Relay {
 public:
  Relay(const std::string& from, const std::string& to, Impairment impairment)
      : from_(from), to_(to), impairment_(std::move(impairment)) {
    if (!from_.good()) throw std::runtime_error(fmt::format("LCM: cannot use the network '{}'", from));
    if (!to_.good()) throw std::runtime_error(fmt::format("LCM: cannot use the network '{}'", to));
    // The C++ binding does not report a failure, for example if another program has the port.
    lcm_subscription_t* all = lcm_subscribe(from_.getUnderlyingLCM(), ".*", on_message, this);
    if (!all) throw std::runtime_error(fmt::format("LCM: cannot subscribe on the network '{}'", from));
    lcm_subscription_set_queue_capacity(all, 20000);
  }

  Counts run() {
    while (!stop) {
      const double wait_s = waiting_.empty() ? 0.05 : std::min(0.05, waiting_.top().due_s - monotonic_s());
      from_.handleTimeout(wait_s > 0.0 ? static_cast<int>(wait_s * 1e3) + 1 : 0);
      for (; !waiting_.empty() && waiting_.top().due_s <= monotonic_s(); waiting_.pop()) send(waiting_.top());
    }
    return impairment_.counts();
  }

 private:
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* relay) {
    static_cast<Relay*>(relay)->forward(buffer, channel);
  }

  void forward(const lcm_recv_buf_t* buffer, const std::string& channel) {
    const auto* bytes = static_cast<const uint8_t*>(buffer->data);
    const double now_s = monotonic_s();
    for (Delivery& delivery : impairment_.deliver(channel, {bytes, bytes + buffer->data_size}, now_s)) {
      if (delivery.due_s <= now_s)
        send(delivery);
      else
        waiting_.push(std::move(delivery));
    }
  }

  void send(const Delivery& delivery) {
    to_.publish(delivery.channel, delivery.bytes.data(), static_cast<unsigned>(delivery.bytes.size()));
  }

  lcm::LCM from_, to_;
  Impairment impairment_;
  std::priority_queue<Delivery, std::vector<Delivery>, DueLater> waiting_;
};

}  // namespace

int main(int argc, char** argv) {
  sidestep::CommandLine app("Forwards LCM messages from one network to another with the impairments of a bad network.");
  std::string from, to;
  std::vector<std::string> rules;
  unsigned seed = 1;
  app.add_option("--from", from, "LCM network to receive from").required().type_name("URL");
  app.add_option("--to", to, "another LCM network, to send to; start a second relay for the opposite direction")
      .required()
      .type_name("URL");
  app.add_option("--rule", rules,
                 "CHANNEL:drop=SHARE,duplicate=SHARE,reorder=SHARE,corrupt=SHARE,delay=S or delay=S..S; CHANNEL is a "
                 "regular expression; the first rule that matches applies, other channels are forwarded unchanged")
      .type_name("RULE");
  app.add_option("--seed", seed, "seed of all random numbers").show_default();
  app.footer(
      "Example: relay --from udpm://239.255.76.67:7667 --to udpm://239.255.76.67:7668 \\\n"
      "               --rule 'ARM_STATE:drop=0.3,delay=0.005..0.05' --rule '.*:corrupt=0.01'\n"
      "Stops on Ctrl-C or SIGTERM. Exit codes: 0 stopped by a signal, 2 wrong arguments or no network.");
  if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
  std::signal(SIGINT, [](int) { stop = true; });
  std::signal(SIGTERM, [](int) { stop = true; });
  try {
    if (from == to) throw std::runtime_error("--from and --to must be different networks");
    std::vector<Rule> parsed;
    parsed.reserve(rules.size());
    for (const std::string& rule : rules) parsed.push_back(parse_rule(rule));
    const Counts counts = Relay(from, to, Impairment(parsed, seed)).run();
    fmt::print("relay: {} messages, {} dropped, {} corrupted, {} duplicated, {} reordered\n", counts.received,
               counts.dropped, counts.corrupted, counts.duplicated, counts.reordered);
  } catch (const std::exception& error) {
    fmt::print(stderr, "relay: {}\n", error.what());
    return 2;
  }
}
