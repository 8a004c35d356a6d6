// The message JOINT_TARGET: decoder and input gate.

#include <cmath>

#include "firmware/control/validation.h"
#include "firmware/io/lcm/message_decoder.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/messages.h"
#include "tests/support/random.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::Bytes;
using test::Random;
using test::TestInputs;

namespace {

Bytes message(int64_t utime, const JointVector& q_rad) {
  return test::encoded(test::joint_target_message(utime, q_rad));
}

Bytes point(int64_t utime) {
  return test::encoded(test::target_message(utime, Vector3(1, 2, 3), Vector3(0, 0, 0)));
}

bool receive(TestInputs& inputs, const Bytes& bytes, Target& target, double now_s = 0.0) {
  return inputs.receive_joint_target(bytes.data(), bytes.size(), now_s, target);
}

void a_posture_arrives_as_it_was_sent(void**) {
  Random random(1);
  for (int joints = kMinJoints; joints <= kMaxJoints; ++joints) {
    TestInputs inputs(joints, Settings());
    const JointVector q_rad = random.joints(joints, -1000.0, 1000.0);
    Target target;
    target.position_m.setOnes();
    target.tracks_orientation = true;
    assert_true(receive(inputs, message(77, q_rad), target));
    assert_int_equal(target.utime, 77);
    assert_true(target.is_posture() && !target.tracks_orientation);
    check_near(target.posture_rad, q_rad, 0.0);
    check_near(target.position_m, Vector3(0, 0, 0), 0.0);
    assert_int_equal(inputs.rejected(), 0);
  }
}

void another_number_of_joints_is_rejected_with_that_reason(void**) {
  TestInputs inputs(7, Settings());
  Target target;
  int64_t rejected = 0;
  for (const int joints : {0, 1, 6, 8, 10}) {
    assert_false(receive(inputs, message(1, JointVector::Zero(joints)), target));
    assert_int_equal(inputs.rejected(), ++rejected);
    assert_string_equal(inputs.last_reason(), "joint target with another number of joints than the arm has");
  }
  Bytes bytes = message(1, JointVector::Zero(7));
  for (const int64_t count : {int64_t{-1}, int64_t{6}, int64_t{8}, int64_t{0x7fffffff}, int64_t{0x80000000}}) {
    for (int i = 0; i < 4; ++i)
      bytes[kHeaderBytes + static_cast<size_t>(i)] = static_cast<uint8_t>(count >> (24 - 8 * i));
    assert_false(receive(inputs, bytes, target));
    assert_int_equal(inputs.rejected(), ++rejected);
  }
}

void impossible_positions_are_rejected(void**) {
  TestInputs inputs(7, Settings());
  Target target;
  int64_t rejected = 0;
  for (int joint = 0; joint < 7; ++joint) {
    for (const double wrong : {1000.1, -1e300, std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      JointVector q_rad = JointVector::Zero(7);
      q_rad[joint] = wrong;
      assert_false(receive(inputs, message(1, q_rad), target));
      assert_int_equal(inputs.rejected(), ++rejected);
      assert_string_equal(inputs.last_reason(), "target with impossible values");
    }
  }
}

void every_truncation_and_flipped_bit_is_rejected_or_plausible(void**) {
  const Bytes whole = message(123, JointVector::Constant(7, 0.5));
  for (size_t size = 0; size < whole.size() + 9; ++size) {
    TestInputs inputs(7, Settings());
    Target target;
    Bytes bytes = whole;
    bytes.resize(size);
    assert_int_equal(receive(inputs, bytes, target), size == whole.size());
  }
  for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    TestInputs inputs(7, Settings());
    Target target;
    Bytes bytes = whole;
    bytes[bit / 8] = static_cast<uint8_t>(bytes[bit / 8] ^ 1u << bit % 8);
    if (receive(inputs, bytes, target)) assert_true(plausible(target) && target.posture_rad.size() == 7);
  }
}

void each_channel_takes_only_its_own_type(void**) {
  TestInputs inputs(7, Settings());
  Target target;
  const Bytes posture = message(1, JointVector::Zero(7)), tool = point(1);
  assert_false(receive(inputs, tool, target));
  assert_string_equal(inputs.last_reason(), "joint target of another type");
  assert_false(inputs.receive(posture.data(), posture.size(), 0.0, target));
  assert_string_equal(inputs.last_reason(), "target of another type");
  assert_true(is_joint_target({posture.data(), posture.size()}));
  assert_false(is_joint_target({tool.data(), tool.size()}));
}

/// Each kind has its own order, because their senders may have different clocks.
void the_newest_of_both_kinds_counts_and_old_ones_are_dropped(void**) {
  TestInputs inputs(7, Settings());
  Target target;
  const Bytes early = point(10), late = point(20);
  assert_true(receive(inputs, message(1'000'000, JointVector::Zero(7)), target, 1.0));
  assert_true(target.is_posture());
  assert_true(inputs.receive(early.data(), early.size(), 1.01, target));
  assert_false(target.is_posture());
  check_near(target.position_m, Vector3(1, 2, 3), 0.0);
  assert_false(receive(inputs, message(1'000'000, JointVector::Zero(7)), target, 1.02));
  assert_false(receive(inputs, message(900'000, JointVector::Zero(7)), target, 1.03));
  assert_false(target.is_posture());
  assert_true(receive(inputs, message(1'000'001, JointVector::Zero(7)), target, 1.04));
  assert_true(target.is_posture());
  assert_true(inputs.receive(late.data(), late.size(), 1.05, target));
  assert_false(target.is_posture());
  assert_int_equal(inputs.rejected(), 0);
}

void no_message_allocates_after_the_first(void**) {
  TestInputs inputs(7, Settings());
  Target target;
  Bytes messages[3];
  for (int i = 0; i < 3; ++i) messages[i] = message(i, JointVector::Zero(7));
  JointVector wrong_rad = JointVector::Constant(7, HUGE_VAL);
  const Bytes wrong = message(9, wrong_rad), short_one = message(9, JointVector::Zero(3));
  assert_true(receive(inputs, messages[0], target));
  const int64_t before = test::allocation_count();
  assert_true(receive(inputs, messages[1], target));
  assert_false(receive(inputs, wrong, target));
  assert_false(receive(inputs, short_one, target));
  assert_true(receive(inputs, messages[2], target));
  assert_int_equal(test::allocation_count() - before, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_posture_arrives_as_it_was_sent),
      cmocka_unit_test(another_number_of_joints_is_rejected_with_that_reason),
      cmocka_unit_test(impossible_positions_are_rejected),
      cmocka_unit_test(every_truncation_and_flipped_bit_is_rejected_or_plausible),
      cmocka_unit_test(each_channel_takes_only_its_own_type),
      cmocka_unit_test(the_newest_of_both_kinds_counts_and_old_ones_are_dropped),
      cmocka_unit_test(no_message_allocates_after_the_first),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
