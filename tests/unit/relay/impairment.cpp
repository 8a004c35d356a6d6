#include "host/relay/impairment.h"
#include "tests/support/check.h"

using namespace sidestep::relay;
using sidestep::test::message_of;
using sidestep::test::one_line_with;

namespace {

const std::vector<uint8_t> kBytes(100, 7);
constexpr int kMany = 20000;

std::vector<std::vector<Delivery>> deliver_all(const std::string& rule, unsigned seed, int messages = kMany) {
  Impairment impairment({parse_rule(rule)}, seed);
  std::vector<std::vector<Delivery>> all;
  for (int i = 0; i < messages; ++i) all.push_back(impairment.deliver("ARM_STATE", kBytes, 0.01 * i));
  return all;
}

double share(const std::vector<std::vector<Delivery>>& deliveries, bool (*is)(const std::vector<Delivery>&)) {
  int count = 0;
  for (const auto& of_message : deliveries) count += is(of_message);
  return static_cast<double>(count) / static_cast<double>(deliveries.size());
}

void the_shares_match_the_rule(void**) {
  const auto nothing = [](const auto& d) { return d.empty(); };
  const auto twice = [](const auto& d) { return d.size() == 2; };
  const auto changed = [](const auto& d) { return d.size() == 1 && d[0].bytes != kBytes; };
  check_near(share(deliver_all("ARM.*:drop=0.3", 1), nothing), 0.3, 0.015);
  check_near(share(deliver_all("ARM_STATE:duplicate=0.2", 1), twice), 0.2, 0.015);
  check_near(share(deliver_all("ARM_STATE:corrupt=0.5", 1), changed), 0.5, 0.015);
  check_near(share(deliver_all("ARM_STATE:drop=1", 1), nothing), 1.0, 0);
  check_near(share(deliver_all("ARM_STATE:drop=0", 1), nothing), 0.0, 0);
}

void delays_are_in_range_and_reordered_messages_are_overtaken(void**) {
  const auto deliveries = deliver_all("ARM_STATE:delay=0.005..0.05", 2);
  double least_s = 1.0, most_s = 0.0;
  for (size_t i = 0; i < deliveries.size(); ++i) {
    const double delay_s = deliveries[i][0].due_s - 0.01 * static_cast<double>(i);
    least_s = std::min(least_s, delay_s), most_s = std::max(most_s, delay_s);
  }
  check(least_s >= 0.005 && least_s < 0.006 && most_s > 0.049 && most_s <= 0.05 + 1e-9, "%g to %g", least_s, most_s);

  const auto reordered = deliver_all("ARM_STATE:reorder=0.1", 3);
  int overtaken = 0;
  for (size_t i = 0; i + 1 < reordered.size(); ++i) overtaken += reordered[i][0].due_s > reordered[i + 1][0].due_s;
  check(overtaken > kMany / 20 && overtaken < kMany / 8, "%d", overtaken);
}

void the_same_seed_gives_the_same_deliveries(void**) {
  const auto flat = [](unsigned seed) {
    std::vector<std::pair<double, std::vector<uint8_t>>> all;
    for (const auto& deliveries :
         deliver_all("ARM_STATE:drop=0.1,duplicate=0.1,reorder=0.1,corrupt=0.1,delay=0..0.1", seed, 500))
      for (const Delivery& delivery : deliveries) all.emplace_back(delivery.due_s, delivery.bytes);
    return all;
  };
  assert_true(flat(5) == flat(5));
  assert_true(flat(5) != flat(6));
}

void other_channels_are_forwarded_unchanged(void**) {
  Impairment impairment({parse_rule("ARM_STATE:drop=1"), parse_rule("ARM.*:delay=1")}, 1);
  assert_true(impairment.deliver("ARM_STATE", kBytes, 0.0).empty());
  check_near(impairment.deliver("ARM_COMMAND", kBytes, 0.0).at(0).due_s, 1.0, 0);
  const auto passed = impairment.deliver("TARGET", kBytes, 0.0);
  assert_true(passed.size() == 1 && passed[0].due_s == 0.0 && passed[0].bytes == kBytes);
}

void a_malformed_rule_is_rejected_with_one_line(void**) {
  for (const char* rule : {"", "ARM_STATE", ":drop=1", "A:drop", "A:drop=", "A:drop=2", "A:drop=-1", "A:drop=nan",
                           "A:delay=0.2..0.1", "A:delay=..", "A:lose=1", "(:drop=1", "A:drop=1x"})
    check(one_line_with(message_of([&] { parse_rule(rule); }), {rule}), "'%s': '%s'", rule,
          message_of([&] { parse_rule(rule); }).c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_shares_match_the_rule),
      cmocka_unit_test(delays_are_in_range_and_reordered_messages_are_overtaken),
      cmocka_unit_test(the_same_seed_gives_the_same_deliveries),
      cmocka_unit_test(other_channels_are_forwarded_unchanged),
      cmocka_unit_test(a_malformed_rule_is_rejected_with_one_line),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
