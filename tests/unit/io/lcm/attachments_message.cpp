// The message ATTACHMENTS: decoder and input gate.

#include <sidestep/attachments_t.hpp>

#include "firmware/control/validation.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::Bytes;
using test::TestInputs;

namespace {

obstacle_t cup() {
  obstacle_t shape{};
  shape.id = 7;
  shape.shape = obstacle_t::CYLINDER;
  shape.position[2] = 0.05;
  shape.quaternion[0] = 1.0;
  shape.size[0] = 0.04, shape.size[1] = 0.1;
  shape.velocity[0] = 3.0;
  return shape;
}

attachments_t two_shapes() {
  attachments_t message{};
  message.utime = 1000;
  message.shapes = {cup(), cup()};
  message.shapes[1].shape = obstacle_t::SPHERE;
  message.allowed = {7, -3, 12};
  return message;
}

Bytes encoded(attachments_t message) {
  message.num_shapes = static_cast<int32_t>(message.shapes.size());
  message.num_allowed = static_cast<int32_t>(message.allowed.size());
  return test::encoded(message);
}

bool receive(TestInputs& inputs, const Bytes& bytes, Attachments& attachments, double now_s = 0.0) {
  return inputs.receive(bytes.data(), bytes.size(), now_s, attachments);
}

void a_message_says_what_the_tool_holds_and_may_touch(void**) {
  TestInputs inputs(test::lwa3(), Settings());
  Attachments attachments;
  assert_true(receive(inputs, encoded(two_shapes()), attachments));
  assert_int_equal(attachments.shapes.size(), 2);
  assert_true(attachments.shapes[0].shape == Shape::kCylinder && attachments.shapes[1].shape == Shape::kSphere);
  assert_true(attachments.shapes[0].velocity_mps.isZero(0.0));
  assert_true(attachments.holds(7) && !attachments.holds(12));
  for (const int32_t id : {7, -3, 12}) assert_true(attachments.allows(id));
  assert_false(attachments.allows(0));
  assert_int_equal(attachments.held.size(), 2);
  assert_int_equal(attachments.held[0].body, 7);
}

void an_empty_message_lets_go_of_everything(void**) {
  TestInputs inputs(test::lwa3(), Settings());
  Attachments attachments;
  assert_true(receive(inputs, encoded(two_shapes()), attachments));
  attachments_t none{};
  none.utime = 2000;
  assert_true(receive(inputs, encoded(none), attachments, 0.1));
  assert_true(attachments.is_empty() && attachments.held.size() == 0);
}

void impossible_counts_and_values_are_rejected_with_a_reason(void**) {
  TestInputs inputs(test::lwa3(), Settings());
  Attachments attachments;
  int64_t rejected = 0;
  const auto is_rejected = [&](const attachments_t& message, const char* reason) {
    assert_false(receive(inputs, encoded(message), attachments));
    assert_int_equal(inputs.rejected(), ++rejected);
    assert_string_equal(inputs.last_reason(), reason);
  };
  attachments_t message = two_shapes();
  message.shapes.assign(kMaxHeldShapes + 1, cup());
  is_rejected(message, "attachments with an impossible count of shapes");
  message = two_shapes();
  message.allowed.assign(kMaxAllowed + 1, 1);
  is_rejected(message, "attachments with an impossible count of allowed obstacles");
  for (const double number : {std::nan(""), HUGE_VAL, -1.0, 1e6}) {
    message = two_shapes();
    message.shapes[1].size[0] = number;
    is_rejected(message, "attachments with impossible values");
  }
  message = two_shapes();
  message.shapes[0].shape = 4;
  is_rejected(message, "attachments with impossible values");
}

void every_truncation_and_flipped_bit_is_rejected_or_plausible(void**) {
  const Bytes whole = encoded(two_shapes());
  for (size_t size = 0; size < whole.size() + 8; ++size) {
    TestInputs inputs(test::lwa3(), Settings());
    Attachments attachments;
    Bytes bytes = whole;
    bytes.resize(size);
    assert_int_equal(receive(inputs, bytes, attachments), size == whole.size());
  }
  size_t accepted = 0;
  for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    TestInputs inputs(test::lwa3(), Settings());
    Attachments attachments;
    Bytes bytes = whole;
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
    if (!receive(inputs, bytes, attachments)) continue;
    ++accepted;
    for (const Obstacle& shape : attachments.shapes) assert_true(plausible(shape));
  }
  check(accepted > 2000, "%zu of %zu accepted", accepted, 8 * whole.size());
}

void an_older_message_is_dropped_unless_the_sender_has_restarted(void**) {
  TestInputs inputs(test::lwa3(), Settings());
  Attachments attachments;
  attachments_t message = two_shapes();
  message.utime = 1'000'000;
  assert_true(receive(inputs, encoded(message), attachments, 1.0));
  message.utime = 900'000;
  assert_false(receive(inputs, encoded(message), attachments, 1.01));
  message.utime = 5;
  assert_true(receive(inputs, encoded(message), attachments, 3.0));
  assert_int_equal(inputs.rejected(), 0);
}

void no_message_allocates_after_the_first(void**) {
  TestInputs inputs(test::lwa3(), Settings());
  Attachments attachments;
  attachments_t message = two_shapes();
  message.shapes.assign(kMaxHeldShapes, cup());
  message.allowed.assign(kMaxAllowed, 3);
  assert_true(receive(inputs, encoded(message), attachments));
  for (int shapes = 0; shapes <= kMaxHeldShapes; ++shapes) {
    ++message.utime;
    message.shapes.assign(static_cast<size_t>(shapes), cup());
    const Bytes bytes = encoded(message);
    const int64_t before = test::allocation_count();
    assert_true(receive(inputs, bytes, attachments));
    assert_int_equal(test::allocation_count() - before, 0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_message_says_what_the_tool_holds_and_may_touch),
      cmocka_unit_test(an_empty_message_lets_go_of_everything),
      cmocka_unit_test(impossible_counts_and_values_are_rejected_with_a_reason),
      cmocka_unit_test(every_truncation_and_flipped_bit_is_rejected_or_plausible),
      cmocka_unit_test(an_older_message_is_dropped_unless_the_sender_has_restarted),
      cmocka_unit_test(no_message_allocates_after_the_first),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
