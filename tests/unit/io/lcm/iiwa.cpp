#include <limits>

#include "firmware/io/lcm/encoder.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/iiwa_driver.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::ClosedLoop;
using test::encoded;
using test::iiwa_status;

namespace {

constexpr int kJoints = 7;

/// Decodes a status into an arm state. Returns whether the status was accepted.
bool receive(const drake::lcmt_iiwa_status& status, ArmState& state) {
  test::TestInputs inputs(kJoints, Settings(), kIiwaDialect);
  const test::Bytes bytes = encoded(status);
  return inputs.receive(bytes.data(), bytes.size(), 0.0, state);
}

void a_status_becomes_an_arm_state(void**) {
  test::Random random(1);
  const JointVector measured_rad = random.joints(kJoints, -2, 2), velocity_radps = random.joints(kJoints, -1, 1);
  const JointVector commanded_rad = measured_rad + random.joints(kJoints, -0.01, 0.01);
  ArmState state;
  assert_true(receive(iiwa_status(0, measured_rad, velocity_radps, commanded_rad), state));  // Drake's time starts at 0
  assert_int_equal(state.utime, 0);
  check_near(state.position_rad, measured_rad, 0);
  check_near(state.velocity_radps, velocity_radps, 0);
  check_near(state.held_rad, commanded_rad, 0);
}

void an_impossible_commanded_position_is_ignored(void**) {
  const JointVector here_rad = JointVector::Constant(kJoints, 0.3), rest = JointVector::Zero(kJoints);
  for (const double wrong_rad : {0.0, 0.4, std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int joint = 0; joint < kJoints; ++joint) {
      JointVector commanded_rad = here_rad;
      commanded_rad[joint] = wrong_rad;
      ArmState state;
      assert_true(receive(iiwa_status(1, here_rad, rest, commanded_rad), state));
      assert_int_equal(state.held_rad.size(), 0);
    }
  }
}

void a_command_holds_positions_only(void**) {
  const Arm& arm = test::lwa3();
  Encoder encoder(arm, kIiwaDialect);
  const Command command{JointVector::LinSpaced(kJoints, -1, 1), JointVector::Constant(kJoints, 0.5)};
  const Packet packet = encoder.encode(command, 123, 7);
  drake::lcmt_iiwa_command message;
  assert_int_equal(message.decode(packet.bytes, 0, static_cast<int>(packet.size)), packet.size);
  assert_int_equal(message.utime, 123);
  assert_int_equal(message.num_joints, kJoints);
  assert_int_equal(message.num_torques, 0);
  for (int i = 0; i < kJoints; ++i)
    check_near(message.joint_position[static_cast<size_t>(i)], command.position_rad[i], 0);
}

void the_command_stream_begins_at_the_position_that_the_drives_hold(void**) {
  ClosedLoop loop = test::at_home("sidestep");
  loop.arm.held_rad = loop.arm.position_rad + JointVector::Constant(kJoints, 0.01);
  loop.run_until(Mode::kHold, 1.0);
  check_near(loop.last.command.position_rad, loop.arm.held_rad, 1e-3);
}

/// Even where the configuration requires no consistent states before the start.
void no_command_is_sent_within_the_guard_time(void**) {
  ClosedLoop loop = test::at_home("sidestep");
  loop.model.settings.start_guard_s = 0.25;
  loop.model.settings.timeouts.consistent_s = 0.0;
  const auto silence_s = [&] {
    const double since_s = loop.now_s();
    do loop.cycle();
    while (!loop.last.commanding && loop.now_s() < since_s + 1.0);
    return loop.now_s() - since_s;
  };
  check_near(silence_s(), 0.26, 1e-6);  // one cycle passes before the first status
  loop.sends_target = true;
  loop.run(0.3);
  loop.arm_clock_offset_us = -1'000'000;  // another driver without a pause: its utimes start again
  check_near(silence_s(), 0.26, 1e-6);
  loop.run(0.3);
  loop.sends_arm_state = false;
  loop.run(0.26);
  loop.sends_arm_state = true;  // the driver may be another one
  check_near(silence_s(), 0.26, 1e-6);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_status_becomes_an_arm_state),
      cmocka_unit_test(an_impossible_commanded_position_is_ignored),
      cmocka_unit_test(a_command_holds_positions_only),
      cmocka_unit_test(the_command_stream_begins_at_the_position_that_the_drives_hold),
      cmocka_unit_test(no_command_is_sent_within_the_guard_time),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
