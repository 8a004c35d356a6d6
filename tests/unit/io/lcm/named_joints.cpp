// The message OTHER_JOINTS: decoder, input gate and memory.

#include <sidestep/named_joints_t.hpp>

#include "firmware/io/lcm/message_decoder.h"
#include "firmware/model/load/load_arm.h"
#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/messages.h"
#include "tests/support/random.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::Bytes;
using test::encoded;
using test::TestInputs;

namespace {

using Named = std::vector<std::pair<std::string, double>>;

const Arm& arm() {
  static const Arm arm =
      load_arm("tests/data/lift_arm.urdf", "mast", "tool", {},
               {{"head_joint", 0.1}, {"left_1", 0.2}, {"left_2", -0.5}, {"left_finger_joint", 0.01}});
  return arm;
}

size_t index_of(const std::string& joint) {
  for (size_t j = 0; j < arm().other_joints.size(); ++j)
    if (arm().other_joints[j].name == joint) return j;
  check(false, "no joint '%s'", joint.c_str());
  return 0;
}

Bytes message(int64_t utime, const Named& joints) {
  named_joints_t message;
  message.utime = utime;
  message.num_joints = static_cast<int32_t>(joints.size());
  for (const auto& [name, position] : joints) {
    message.joint_name.push_back(name);
    message.joint_position.push_back(position);
  }
  return encoded(message);
}

bool receive(TestInputs& inputs, const Bytes& bytes, OtherJoints& joints, double now_s = 0.0) {
  return inputs.receive(bytes.data(), bytes.size(), now_s, joints);
}

void a_message_moves_the_joints_that_it_names_and_the_others_keep_their_positions(void**) {
  TestInputs inputs(arm(), Settings());
  OtherJoints joints;
  assert_true(receive(inputs, message(1000, {{"left_2", -1.5}, {"head_joint", 0.4}}), joints));
  check_near(joints.position[index_of("left_2")], -1.5, 0.0);
  check_near(joints.position[index_of("head_joint")], 0.4, 0.0);
  check_near(joints.position[index_of("left_1")], 0.2, 0.0);
  assert_true(receive(inputs, message(2000, {{"left_1", 0.3}}), joints, 0.1));
  check_near(joints.position[index_of("left_1")], 0.3, 0.0);
  check_near(joints.position[index_of("left_2")], -1.5, 0.0);
}

/// Senders report all joints of a robot, those of the chain and wheels too.
void joints_of_the_chain_and_unknown_ones_are_skipped(void**) {
  TestInputs inputs(arm(), Settings());
  OtherJoints joints;
  assert_true(receive(inputs, message(1, {{"lift", 0.3}, {"wheel", 99.0}, {"left_1", -0.7}, {"", 1.0}}), joints));
  check_near(joints.position[index_of("left_1")], -0.7, 0.0);
  assert_int_equal(inputs.rejected(), 0);
}

/// left_1 moves at most at 1.5 rad/s.
void velocities_are_differences_of_positions_within_the_limit(void**) {
  TestInputs inputs(arm(), Settings());
  OtherJoints joints;
  const size_t left = index_of("left_1");
  assert_true(receive(inputs, message(0, {{"left_1", 0.0}}), joints, 0.0));
  check_near(joints.velocity[left], 0.0, 0.0);
  assert_true(receive(inputs, message(10000, {{"left_1", 0.01}}), joints, 0.01));
  check_near(joints.velocity[left], 1.0, 1e-9);
  assert_true(receive(inputs, message(20000, {{"left_1", -0.5}}), joints, 0.02));
  check_near(joints.velocity[left], -1.5, 0.0);
  assert_true(receive(inputs, message(30000, {{"head_joint", 0.0}}), joints, 0.03));
  check_near(joints.velocity[left], -1.5, 0.0);  // another sender's message
  assert_true(receive(inputs, message(130000, {{"head_joint", 0.0}}), joints, 0.13));
  check_near(joints.velocity[left], 0.0, 0.0);  // nothing was heard of it
  assert_true(receive(inputs, message(500000, {{"left_1", -0.4}}), joints, 0.5));
  check_near(joints.velocity[left], 0.0, 0.0);  // too long ago for a velocity
}

void a_repeated_or_older_message_is_dropped(void**) {
  TestInputs inputs(arm(), Settings());
  OtherJoints joints;
  assert_true(receive(inputs, message(5000, {{"left_1", 0.1}}), joints));
  assert_false(receive(inputs, message(5000, {{"left_1", 0.2}}), joints));
  assert_false(receive(inputs, message(4000, {{"left_1", 0.3}}), joints));
  assert_int_equal(inputs.rejected(), 0);
  assert_true(receive(inputs, message(6000, {{"head_joint", 0.2}}), joints));
  check_near(joints.position[index_of("left_1")], 0.1, 0.0);
}

void what_is_not_valid_is_rejected_whole_with_a_reason(void**) {
  const Bytes good = message(7, {{"left_1", 0.1}, {"head_joint", 0.2}});
  Bytes negative = good, many = good, longer = good, unended = good, other_type = good;
  negative[16] = 0x80;
  many[18] = 0x7f;
  longer.push_back(0);
  unended[20 + 4 + 6] = 'x';  // the zero behind left_1
  other_type[0] ^= 1;
  Bytes inner_zero = good;
  inner_zero[20 + 4 + 2] = 0;
  Bytes huge_name = good;
  huge_name[20] = 0x7f;
  const Bytes cases[] = {negative,
                         many,
                         longer,
                         unended,
                         other_type,
                         inner_zero,
                         huge_name,
                         message(7, {}),
                         message(7, {{"wheel", 0.1}}),
                         message(7, {{"left_1", std::nan("")}}),
                         message(7, {{"left_1", HUGE_VAL}}),
                         message(7, {{"left_1", 1001.0}}),
                         message(7, Named(257, {"left_1", 0.1}))};
  for (const Bytes& bytes : cases) {
    TestInputs inputs(arm(), Settings());
    OtherJoints joints;
    assert_false(receive(inputs, bytes, joints));
    assert_int_equal(inputs.rejected(), 1);
    check(std::string(inputs.last_reason()).find("other joints") == 0, "%s", inputs.last_reason());
  }
  for (size_t size = 0; size < good.size(); ++size) {
    TestInputs inputs(arm(), Settings());
    OtherJoints joints;
    const Bytes part(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    check(!receive(inputs, part, joints) && inputs.rejected() == 1, "%zu of %zu bytes", size, good.size());
  }
  TestInputs inputs(arm(), Settings());
  OtherJoints joints;
  assert_true(receive(inputs, good, joints));
}

/// The values that pass are finite, whatever the bytes.
void changed_bytes_do_no_harm(void**) {
  test::Random random(1);
  const Bytes good = message(7, {{"left_1", 0.1}, {"head_joint", 0.2}, {"left_finger_joint", 0.02}});
  int accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes = good;
    for (int i = 1 + random.index(3); i > 0; --i)
      bytes[static_cast<size_t>(8 + random.index(static_cast<int>(bytes.size()) - 8))] =
          static_cast<uint8_t>(random.bits());
    TestInputs inputs(arm(), Settings());
    OtherJoints joints;
    if (!receive(inputs, bytes, joints)) continue;
    ++accepted;
    for (const double position : joints.position) check(std::abs(position) <= 1000.0, "%g", position);
  }
  check(accepted > 5000 && accepted < 18000, "%d of 20000 accepted", accepted);
}

void no_message_allocates_after_the_first(void**) {
  TestInputs inputs(arm(), Settings());
  OtherJoints joints;
  const Bytes bytes[] = {message(1, {{"a_long_name_of_a_joint_somewhere_on_the_robot", 0.1}, {"left_1", 0.1}}),
                         message(2, {{"a_long_name_of_a_joint_somewhere_on_the_robot", 0.1}, {"left_1", 0.2}})};
  assert_true(receive(inputs, bytes[0], joints));
  const int64_t before = test::allocation_count();
  const bool accepted = receive(inputs, bytes[1], joints);
  assert_int_equal(test::allocation_count() - before, 0);
  assert_true(accepted);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_message_moves_the_joints_that_it_names_and_the_others_keep_their_positions),
      cmocka_unit_test(joints_of_the_chain_and_unknown_ones_are_skipped),
      cmocka_unit_test(velocities_are_differences_of_positions_within_the_limit),
      cmocka_unit_test(a_repeated_or_older_message_is_dropped),
      cmocka_unit_test(what_is_not_valid_is_rejected_whole_with_a_reason),
      cmocka_unit_test(changed_bytes_do_no_harm),
      cmocka_unit_test(no_message_allocates_after_the_first),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
