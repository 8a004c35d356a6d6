#include "firmware/io/lcm/fragment_assembly.h"

#include <deque>
#include <map>

#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/datagrams.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::Bytes;
using test::Fragment;
using test::fragments;
using test::named;
using test::Random;
using test::short_datagram;

namespace {

constexpr size_t kLargest_bytes = 1000;
constexpr Sender kOne{0x7f000001, 5000}, kOther{0x7f000001, 5001};

/// An assembly with two channels.
struct Subscriber {
  FragmentAssembly assembly{kLargest_bytes};
  int obstacles = assembly.subscribe("OBSTACLES"), target = assembly.subscribe("TARGET");

  /// The data of the message that the datagram completes; empty if it completes none.
  Bytes add(const Bytes& datagram, const Sender& sender = kOne) {
    // In memory of exactly this size, so that the sanitizer sees each byte that is read beyond it.
    const Bytes exact(datagram.begin(), datagram.end());
    const auto message = assembly.add(sender, {exact.data(), exact.size()});
    last_channel = message ? message->channel : -1;
    last_cut = message && message->cut;
    return message ? Bytes(message->packet.bytes, message->packet.bytes + message->packet.size) : Bytes();
  }
  Bytes add(const Fragment& fragment, const Sender& sender = kOne) { return add(fragment.datagram(), sender); }

  int last_channel = -1;
  bool last_cut = false;
};

Bytes counted(size_t size, uint8_t first = 1) {
  Bytes bytes(size);
  for (uint8_t& byte : bytes) byte = first++;
  return bytes;
}

void a_short_message_arrives_on_its_channel(void**) {
  Subscriber subscriber;
  const Bytes data = counted(100);
  assert_true(subscriber.add(short_datagram(named("TARGET", data))) == data);
  assert_int_equal(subscriber.last_channel, subscriber.target);
  assert_true(subscriber.add(short_datagram(named("OBSTACLES", data))) == data);
  assert_int_equal(subscriber.last_channel, subscriber.obstacles);
}

void only_the_exact_channel_is_received(void**) {
  Subscriber subscriber;
  for (const char* channel : {"", "TARGE", "TARGETS", "target", ".*"}) {
    subscriber.add(short_datagram(named(channel, counted(10))));
    check(subscriber.last_channel == -1, "'%s'", channel);
    for (const Fragment& fragment : fragments(channel, 1, counted(100), {50})) subscriber.add(fragment);
    check(subscriber.last_channel == -1, "'%s'", channel);
  }
  assert_int_equal(subscriber.assembly.malformed_datagrams(), 0);
  assert_int_equal(subscriber.assembly.incomplete_messages(), 0);
}

void fragments_make_their_message_in_any_order_after_the_first(void**) {
  const Bytes data = counted(kLargest_bytes);
  const std::vector<Fragment> parts = fragments("OBSTACLES", 3, data, {100, 350, 900});
  for (const std::vector<size_t>& order :
       std::vector<std::vector<size_t>>{{0, 1, 2, 3}, {0, 3, 2, 1}, {0, 0, 2, 2, 1, 0, 1, 3}}) {
    Subscriber subscriber;
    Bytes whole;
    for (const size_t i : order) {
      assert_true(whole.empty());
      whole = subscriber.add(parts[i]);
    }
    assert_true(whole == data);
    assert_int_equal(subscriber.last_channel, subscriber.obstacles);
    assert_int_equal(subscriber.assembly.incomplete_messages(), 0);
  }
}

void a_message_of_one_fragment_arrives(void**) {
  Subscriber subscriber;
  assert_true(subscriber.add(fragments("TARGET", 1, counted(20), {})[0]) == counted(20));
}

void a_malformed_datagram_is_counted_and_has_no_effect(void**) {
  const Bytes data = counted(100), first = named("TARGET", data);
  const std::string longest(FragmentAssembly::kLongestChannelName, 'C');
  const struct {
    const char* what;
    Bytes datagram;
  } cases[] = {
      {"nothing", {}},
      {"a part of a header", {0x4c, 0x43, 0x30, 0x32, 0, 0, 0}},
      {"another magic", short_datagram(first, 0x4c433034)},
      {"a short message without the end of its channel", short_datagram(counted(50))},
      {"a short message without a channel", short_datagram({})},
      {"a short message with a long channel", short_datagram(named(longest + "C", data))},
      {"a fragment without data", Fragment{9, 100, 0, 1, 2, {}}.datagram()},
      {"a fragment without the end of its channel", Fragment{9, 500, 0, 0, 3, counted(200)}.datagram()},
      {"a fragment with a long channel", Fragment{9, 500, 0, 0, 3, named(longest + "C", data)}.datagram()},
      {"a first fragment with only a channel", Fragment{9, 500, 0, 0, 3, named("TARGET", {})}.datagram()},
      {"a message of zero fragments", Fragment{9, 100, 0, 0, 0, first}.datagram()},
      {"a fragment beyond the last", Fragment{9, 200, 100, 2, 2, data}.datagram()},
      {"a fragment far beyond the last", Fragment{9, 200, 100, 0xffff, 2, data}.datagram()},
      {"a message of too many fragments",
       Fragment{9, 1000, 0, 0, FragmentAssembly::kMostFragments + 1, first}.datagram()},
      {"a first fragment with an offset", Fragment{9, 300, 100, 0, 2, first}.datagram()},
      {"a first fragment larger than its message", Fragment{9, 99, 0, 0, 2, first}.datagram()},
      {"a first fragment of an empty message", Fragment{9, 0, 0, 0, 1, first}.datagram()},
  };
  for (const auto& bad : cases) {
    Subscriber subscriber;
    const auto good = fragments("OBSTACLES", 9, counted(300), {200});
    subscriber.add(good[0]);
    subscriber.add(bad.datagram);
    check(subscriber.last_channel == -1, "%s gives a message", bad.what);
    check(subscriber.assembly.malformed_datagrams() == 1, "%s is not counted", bad.what);
    check(subscriber.add(good[1]) == counted(300), "%s breaks the message that has begun", bad.what);
  }
}

/// Fragments of a message that has begun, of which nothing may be written outside the message.
void a_fragment_that_does_not_fit_its_message_is_refused(void**) {
  const struct {
    const char* what;
    Fragment fragment;
  } cases[] = {
      {"offset and size that wrap at 32 bits", {1, 300, 0xffffff00, 1, 2, counted(400)}},
      {"an offset behind the end", {1, 300, 301, 1, 2, counted(1)}},
      {"the largest offset", {1, 300, 0xffffffff, 1, 2, counted(1)}},
      {"one byte too many", {1, 300, 200, 1, 2, counted(101)}},
      {"another size of the message", {1, 301, 200, 1, 2, counted(100)}},
      {"another number of fragments", {1, 300, 200, 1, 3, counted(100)}},
  };
  const Bytes data = counted(300);
  const auto good = fragments("TARGET", 1, data, {200});
  for (const auto& bad : cases) {
    Subscriber subscriber;
    subscriber.add(good[0]);
    subscriber.add(bad.fragment);
    check(subscriber.last_channel == -1, "%s gives a message", bad.what);
    check(subscriber.assembly.malformed_datagrams() == 1, "%s is not counted", bad.what);
    check(subscriber.add(good[1]) == data, "%s breaks the message", bad.what);
  }
}

void a_message_with_a_gap_or_an_overlap_is_discarded(void**) {
  for (const auto& [offset, size] : {std::pair{99u, 201}, {99u, 200}, {101u, 199}, {100u, 199}, {0u, 300}}) {
    Subscriber subscriber;
    subscriber.add({1, 300, 0, 0, 2, named("TARGET", counted(100))});
    subscriber.add({1, 300, offset, 1, 2, counted(static_cast<size_t>(size))});
    check(subscriber.last_channel == -1, "%d bytes at %u give a message", size, offset);
    assert_int_equal(subscriber.assembly.incomplete_messages(), 1);
  }
}

void a_message_that_is_too_large_is_handed_over_cut(void**) {
  for (const uint32_t claimed_bytes : {uint32_t{kLargest_bytes} + 1, 1u << 28, 0xffffffffu}) {
    Subscriber subscriber;
    const Bytes first = subscriber.add({1, claimed_bytes, 0, 0, 5000, named("OBSTACLES", counted(100))});
    assert_true(first == counted(100));
    assert_int_equal(subscriber.last_channel, subscriber.obstacles);
    assert_true(subscriber.last_cut);
    subscriber.add({1, claimed_bytes, 100, 1, 5000, counted(100)});
    assert_int_equal(subscriber.last_channel, -1);
  }
}

void interleaved_messages_of_several_senders_are_kept_apart(void**) {
  Subscriber subscriber;
  const std::pair<Sender, uint32_t> sources[] = {{kOne, 1}, {kOne, 2}, {kOther, 1}, {{kOne.address + 1, kOne.port}, 1}};
  std::vector<std::vector<Fragment>> all;
  for (size_t k = 0; k < std::size(sources); ++k)
    all.push_back(fragments("TARGET", sources[k].second, counted(300, static_cast<uint8_t>(50 * k)), {100, 200}));
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < all.size(); ++k) {
      const Bytes whole = subscriber.add(all[k][i], sources[k].first);
      if (i == 2) check(whole == counted(300, static_cast<uint8_t>(50 * k)), "message %zu", k);
    }
  }
}

void a_restarted_sender_does_not_get_its_old_fragments(void**) {
  Subscriber subscriber;
  const auto old = fragments("TARGET", 0, counted(300, 1), {100, 200}),
             fresh = fragments("TARGET", 0, counted(300, 9), {100, 200});
  subscriber.add(old[0]);
  subscriber.add(old[1]);
  subscriber.add(fresh[0]);
  assert_true(subscriber.add(fresh[2]).empty());
  assert_true(subscriber.add(fresh[1]) == counted(300, 9));
  assert_int_equal(subscriber.assembly.incomplete_messages(), 1);
}

void a_sender_that_floods_first_fragments_does_not_disturb_another(void**) {
  Subscriber subscriber;
  const auto good = fragments("OBSTACLES", 1, counted(300), {100, 200});
  subscriber.add(good[0]);
  for (uint32_t i = 0; i < 10000; ++i) subscriber.add({i, 1000, 0, 0, 2, named("TARGET", counted(100))}, kOther);
  subscriber.add(good[1]);
  assert_true(subscriber.add(good[2]) == counted(300));
  assert_int_equal(subscriber.assembly.incomplete_messages(), 10000 - FragmentAssembly::kSlotsPerSender);
}

void the_message_that_has_waited_longest_is_discarded(void**) {
  constexpr int kOthers = FragmentAssembly::kSlots - 1;
  for (const int others : {kOthers, kOthers + 1}) {
    Subscriber subscriber;
    const auto good = fragments("OBSTACLES", 1, counted(300), {100, 200});
    const auto flood = [&](uint16_t port) {
      for (int i = 0; i < others; ++i, ++port)
        subscriber.add({1, 1000, 0, 0, 2, named("TARGET", counted(100))}, {kOne.address, port});
    };
    subscriber.add(good[0]);
    flood(6000);
    subscriber.add(good[1]);
    flood(7000);
    check(subscriber.add(good[2]).empty() == (others > kOthers), "%d others", others);
  }
}

void no_datagram_allocates(void**) {
  Subscriber subscriber;
  const auto parts = fragments("TARGET", 1, counted(300), {100, 200});
  std::vector<Bytes> datagrams = {short_datagram(named("TARGET", counted(90))), {1, 2, 3}};
  for (const Fragment& part : parts) datagrams.push_back(part.datagram());
  datagrams.push_back(Fragment{2, 1u << 28, 0, 0, 5000, named("TARGET", counted(90))}.datagram());
  const int64_t before = test::allocation_count();
  for (const Bytes& datagram : datagrams) subscriber.assembly.add(kOne, {datagram.data(), datagram.size()});
  assert_int_equal(test::allocation_count() - before, 0);
}

/// A sender of random messages, each cut at random places.
struct RandomSender {
  Sender sender;
  uint32_t sequence = 0;
  std::deque<Fragment> queue;

  Bytes begin(Random& random) {
    const auto size = static_cast<size_t>(1 + random.index(kLargest_bytes));
    Bytes data(size);
    for (uint8_t& byte : data) byte = static_cast<uint8_t>(random.bits());
    std::vector<size_t> cuts;
    for (size_t at = 1; at < size; ++at)
      if (random.chance(0.01)) cuts.push_back(at);
    for (const Fragment& fragment : fragments("OBSTACLES", ++sequence, data, cuts)) queue.push_back(fragment);
    // After the first in any order.
    for (size_t i = queue.size() - 1; i > 1 && random.chance(0.5); --i)
      std::swap(queue[i], queue[static_cast<size_t>(1 + random.index(static_cast<int>(i)))]);
    return data;
  }
};

void any_split_and_interleaving_gives_the_messages_that_were_sent(void**) {
  const unsigned seed = 11;
  print_message("seed %u\n", seed);
  Random random(seed);
  Subscriber subscriber;
  std::vector<RandomSender> senders(FragmentAssembly::kSlots);
  std::map<size_t, Bytes> sent;
  for (uint16_t i = 0; i < senders.size(); ++i) senders[i].sender = {kOne.address, i};
  int complete = 0;
  for (int step = 0; step < 50000; ++step) {
    const auto k = static_cast<size_t>(random.index(static_cast<int>(senders.size())));
    RandomSender& sender = senders[k];
    if (sender.queue.empty()) sent[k] = sender.begin(random);
    const Fragment fragment = sender.queue.front();
    sender.queue.pop_front();
    const Bytes whole = subscriber.add(fragment, sender.sender);
    assert_true(whole.empty() != sender.queue.empty());
    if (whole.empty()) continue;
    assert_true(whole == sent[k]);
    ++complete;
  }
  assert_true(complete > 5000);
  assert_int_equal(subscriber.assembly.incomplete_messages(), 0);
}

/// Changes one field of the header or the length of a datagram. The sequence number and the bytes of the message stay:
/// only the checksum of UDP protects these.
Bytes damaged(Bytes datagram, Random& random) {
  static const size_t kFields[] = {0, 1, 2, 3, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19};
  const int kind = random.index(3);
  const auto some = static_cast<size_t>(1 + random.index(30));
  if (kind == 0)
    datagram[kFields[random.index(std::size(kFields))]] ^= static_cast<uint8_t>(1 << random.index(8));
  else if (kind == 1)
    datagram.resize(datagram.size() - std::min(some, datagram.size()));
  else
    datagram.insert(datagram.end(), some, 0x55);
  return datagram;
}

void damaged_datagrams_never_give_a_message_that_was_not_sent(void**) {
  const unsigned seed = 12;
  print_message("seed %u\n", seed);
  Random random(seed);
  Subscriber subscriber;
  std::vector<RandomSender> senders(FragmentAssembly::kSlots + 4);  // more than there are slots
  for (uint16_t i = 0; i < senders.size(); ++i) senders[i].sender = {kOne.address, i};
  std::map<size_t, std::deque<Bytes>> sent;
  int complete = 0, wrong = 0;
  for (int step = 0; step < 100000; ++step) {
    const auto k = static_cast<size_t>(random.index(static_cast<int>(senders.size())));
    RandomSender& sender = senders[k];
    if (sender.queue.empty()) sent[k].push_back(sender.begin(random));
    if (sent[k].size() > 3) sent[k].pop_front();
    const Fragment fragment = sender.queue.front();
    sender.queue.pop_front();
    if (random.chance(0.02)) continue;  // lost
    for (int copies = random.chance(0.05) ? 2 : 1; copies > 0; --copies) {
      const Bytes datagram = random.chance(0.05) ? damaged(fragment.datagram(), random) : fragment.datagram();
      const Bytes whole = subscriber.add(datagram, sender.sender);
      if (whole.empty() || subscriber.last_cut) continue;
      const auto& known = sent[k];
      wrong += std::find(known.begin(), known.end(), whole) == known.end();
      ++complete;
    }
  }
  print_message("%d messages, %ld incomplete, %ld malformed\n", complete, subscriber.assembly.incomplete_messages(),
                subscriber.assembly.malformed_datagrams());
  assert_int_equal(wrong, 0);
  assert_true(complete > 5000 && subscriber.assembly.incomplete_messages() > 1000 &&
              subscriber.assembly.malformed_datagrams() > 1000);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_short_message_arrives_on_its_channel),
      cmocka_unit_test(only_the_exact_channel_is_received),
      cmocka_unit_test(fragments_make_their_message_in_any_order_after_the_first),
      cmocka_unit_test(a_message_of_one_fragment_arrives),
      cmocka_unit_test(a_malformed_datagram_is_counted_and_has_no_effect),
      cmocka_unit_test(a_fragment_that_does_not_fit_its_message_is_refused),
      cmocka_unit_test(a_message_with_a_gap_or_an_overlap_is_discarded),
      cmocka_unit_test(a_message_that_is_too_large_is_handed_over_cut),
      cmocka_unit_test(interleaved_messages_of_several_senders_are_kept_apart),
      cmocka_unit_test(a_restarted_sender_does_not_get_its_old_fragments),
      cmocka_unit_test(a_sender_that_floods_first_fragments_does_not_disturb_another),
      cmocka_unit_test(the_message_that_has_waited_longest_is_discarded),
      cmocka_unit_test(no_datagram_allocates),
      cmocka_unit_test(any_split_and_interleaving_gives_the_messages_that_were_sent),
      cmocka_unit_test(damaged_datagrams_never_give_a_message_that_was_not_sent),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
