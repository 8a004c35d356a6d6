// The message CONTROL: decoder and input gate.

#include <cmath>
#include <sidestep/control_t.hpp>

#include "firmware/control/validation.h"
#include "tests/support/check.h"
#include "tests/support/messages.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::Bytes;
using test::TestInputs;

namespace {

Bytes message(int64_t utime, int command, double speed_scale) {
  control_t message{};
  message.utime = utime;
  message.command = static_cast<int8_t>(command);
  message.speed_scale = speed_scale;
  return test::encoded(message);
}

bool receive(TestInputs& inputs, const Bytes& bytes, Control& control, double now_s = 0.0) {
  return inputs.receive(bytes.data(), bytes.size(), now_s, control);
}

void a_message_is_what_the_operator_asks_for(void**) {
  TestInputs inputs(7, Settings());
  Control control;
  for (const int command : {control_t::PAUSE, control_t::RESUME, control_t::STOP}) {
    assert_true(receive(inputs, message(10 + command, command, 0.25), control));
    assert_int_equal(static_cast<int>(control.command), command);
    check_near(control.speed_scale, 0.25, 0.0);
  }
}

void impossible_values_are_rejected(void**) {
  TestInputs inputs(7, Settings());
  Control control;
  int64_t rejected = 0;
  for (const double scale : {-0.001, 1.001, -1.0, 1e300, std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    assert_false(receive(inputs, message(1, control_t::RESUME, scale), control));
    assert_int_equal(inputs.rejected(), ++rejected);
  }
  for (const int command : {-128, -1, 3, 127}) {
    assert_false(receive(inputs, message(1, command, 1.0), control));
    assert_int_equal(inputs.rejected(), ++rejected);
  }
  assert_string_equal(inputs.last_reason(), "control with impossible values");
}

void every_truncation_and_flipped_bit_is_rejected_or_plausible(void**) {
  const Bytes whole = message(123, control_t::PAUSE, 0.5);
  for (size_t size = 0; size < whole.size() + 8; ++size) {
    TestInputs inputs(7, Settings());
    Control control;
    Bytes bytes = whole;
    bytes.resize(size);
    assert_int_equal(receive(inputs, bytes, control), size == whole.size());
  }
  for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    TestInputs inputs(7, Settings());
    Control control;
    Bytes bytes = whole;
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
    if (receive(inputs, bytes, control)) assert_true(plausible(control));
  }
}

void an_older_message_is_dropped_unless_the_operator_has_restarted(void**) {
  TestInputs inputs(7, Settings());
  Control control;
  assert_true(receive(inputs, message(1'000'000, control_t::PAUSE, 1.0), control, 1.0));
  assert_false(receive(inputs, message(900'000, control_t::RESUME, 1.0), control, 1.01));
  assert_false(receive(inputs, message(1'000'000, control_t::RESUME, 1.0), control, 1.02));
  assert_true(control.command == ControlCommand::kPause);
  assert_true(receive(inputs, message(5, control_t::RESUME, 1.0), control, 3.0));
  assert_int_equal(inputs.rejected(), 0);
}

void a_stop_counts_whatever_its_time(void**) {
  TestInputs inputs(7, Settings());
  Control control;
  assert_true(receive(inputs, message(1'000'000, control_t::RESUME, 1.0), control, 1.0));
  for (const int64_t utime : {int64_t{999'999}, int64_t{1'000'000}, int64_t{0}, INT64_MIN}) {
    assert_true(receive(inputs, message(utime, control_t::STOP, 1.0), control, 1.01));
    assert_true(control.command == ControlCommand::kStop);
  }
  assert_false(receive(inputs, message(999'999, control_t::PAUSE, 1.0), control, 1.02));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_message_is_what_the_operator_asks_for),
      cmocka_unit_test(impossible_values_are_rejected),
      cmocka_unit_test(every_truncation_and_flipped_bit_is_rejected_or_plausible),
      cmocka_unit_test(an_older_message_is_dropped_unless_the_operator_has_restarted),
      cmocka_unit_test(a_stop_counts_whatever_its_time),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
