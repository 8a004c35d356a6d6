#include "firmware/control/message_order.h"

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/random.h"

using namespace sidestep;

namespace {

void only_newer_messages_are_accepted(void**) {
  MessageOrder order;
  assert_true(order.accept(1000, 1.000, 0.1));
  assert_false(order.accept(1000, 1.001, 0.1));
  assert_false(order.accept(999, 1.002, 0.1));
  assert_false(MessageOrder(order).accept(1000, 2.000, 0.1));  // a frozen sender repeats its last message
  assert_true(order.accept(1001, 1.003, 0.1));
  assert_true(order.accept(900000000, 1.004, 0.1));
}

void the_first_message_is_accepted_with_any_utime(void**) {
  for (const int64_t utime : {INT64_MIN, int64_t{-1}, int64_t{0}, INT64_MAX}) {
    MessageOrder order;
    check(order.accept(utime, 0.0, 0.1), "%ld", utime);
  }
}

void a_restarted_sender_is_accepted(void**) {
  MessageOrder far_back;
  assert_true(far_back.accept(5'000'000, 1.00, 0.1));
  assert_false(far_back.accept(4'950'000, 1.01, 0.1));  // 50 ms back: late, not restarted
  assert_false(far_back.accept(10, 1.02, 0.1));         // 5 s back: restarted or very late
  assert_false(far_back.accept(20, 1.03, 0.1));
  assert_true(far_back.accept(30, 1.04, 0.1));  // three in a row: restarted
  assert_true(far_back.accept(40, 1.05, 0.1));
  assert_false(far_back.accept(35, 1.06, 0.1));

  MessageOrder silence;
  assert_true(silence.accept(5'000'000, 1.00, 0.1));
  assert_false(silence.accept(4'990'000, 1.09, 0.1));
  assert_true(silence.accept(4'990'000, 1.11, 0.1));
}

/// Any number of such messages between newer ones is dropped, too.
void a_message_that_is_very_late_is_dropped(void**) {
  MessageOrder order;
  for (int i = 0; i < 20; ++i) {
    assert_true(order.accept(5'000'000 + 10'000 * i, 1.00 + 0.01 * i, 0.1));
    assert_false(order.accept(4'000'000 + 10'000 * i, 1.001 + 0.01 * i, 0.1));
    assert_false(order.accept(3'000'000, 1.002 + 0.01 * i, 0.1));
  }
}

void one_message_from_the_far_future_does_not_lock_its_sender_out(void**) {
  MessageOrder order;
  assert_true(order.accept(1'000'000, 1.00, 0.1));
  assert_true(order.accept(INT64_MAX, 1.01, 0.1));
  assert_false(order.accept(1'020'000, 1.02, 0.1));
  assert_false(order.accept(1'030'000, 1.03, 0.1));
  assert_true(order.accept(1'040'000, 1.04, 0.1));
  assert_false(order.accept(INT64_MIN, 1.05, 0.1));
  assert_true(order.accept(1'060'000, 1.06, 0.1));
}

/// Without this bound a sender that stamps in nanoseconds would appear to send seconds apart.
void elapsed_time_follows_the_senders_clock_within_the_network_delay(void**) {
  MessageOrder order;
  assert_true(order.accept(1'000'000, 1.00, 0.1));
  check_near(order.elapsed_s(), 0.0, 0);
  assert_true(order.accept(1'020'000, 1.01, 0.1));
  check_near(order.elapsed_s(), 0.02, 1e-12);
  assert_true(order.accept(1'021'000, 1.05, 0.1));
  check_near(order.elapsed_s(), 0.04, 1e-12);
  assert_true(order.accept(11'021'000, 1.06, 0.1));
  check_near(order.elapsed_s(), 0.11, 1e-12);
}

/// A camera of 30 Hz whose messages take 10 to 26 ms.
void the_time_between_two_sendings_is_free_of_jitter(void**) {
  test::Random random(1);
  MessageOrder order;
  double sum_s = 0.0;
  const int messages = 300;
  for (int k = 0; k <= messages; ++k) {
    const double sent_s = k / 30.0;
    assert_true(order.accept(std::lround(sent_s * 1e6), sent_s + random.uniform(0.010, 0.026), 0.1));
    if (k > 0) check_near(order.sending_interval_s(), 1.0 / 30.0, 3e-4);
    sum_s += order.sending_interval_s();
  }
  check_near(sum_s, messages / 30.0, 0.04);
}

/// Clocks in milliseconds, in nanoseconds, that stand still but for the order, and that are fast by 2 %.
void the_time_between_two_sendings_follows_the_receipts_in_the_mean(void**) {
  for (const double ticks_per_s : {1e3, 1e9, 30.0, 1.02e6}) {
    MessageOrder order;
    double sum_s = 0.0;
    for (int k = 0; k <= 600; ++k) {
      assert_true(order.accept(std::lround(k / 30.0 * ticks_per_s), k / 30.0, 0.1));
      if (k >= 300) sum_s += order.sending_interval_s();
    }
    check_near(sum_s, 301 / 30.0, 0.05);
  }
}

void a_restarted_sender_does_not_turn_time_back(void**) {
  MessageOrder order;
  assert_true(order.accept(9'000'000, 1.00, 0.1));
  assert_true(order.accept(9'033'000, 1.03, 0.1));
  assert_true(order.accept(5, 2.00, 0.1));
  check_near(order.sending_interval_s(), 0.97, 1e-12);
  assert_true(order.accept(30'005, 2.04, 0.1));
  check_near(order.sending_interval_s(), 0.03, 1e-12);
}

/// In lockstep the arm's utime is also the controller's clock.
void old_messages_are_dropped_when_the_messages_are_the_clock(void**) {
  MessageOrder order;
  assert_true(order.accept(5'000'000, 5.00, 0.1));
  assert_true(order.accept(6'000'000, 6.00, 0.1));
  assert_false(order.accept(6'000'000, 6.00, 0.1));
  assert_false(order.accept(5'990'000, 5.99, 0.1));
  assert_true(order.accept(1'000'000, 1.00, 0.1));
  assert_true(order.accept(1'010'000, 1.01, 0.1));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(only_newer_messages_are_accepted),
      cmocka_unit_test(the_first_message_is_accepted_with_any_utime),
      cmocka_unit_test(a_restarted_sender_is_accepted),
      cmocka_unit_test(a_message_that_is_very_late_is_dropped),
      cmocka_unit_test(one_message_from_the_far_future_does_not_lock_its_sender_out),
      cmocka_unit_test(elapsed_time_follows_the_senders_clock_within_the_network_delay),
      cmocka_unit_test(the_time_between_two_sendings_is_free_of_jitter),
      cmocka_unit_test(the_time_between_two_sendings_follows_the_receipts_in_the_mean),
      cmocka_unit_test(a_restarted_sender_does_not_turn_time_back),
      cmocka_unit_test(old_messages_are_dropped_when_the_messages_are_the_clock),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
