#include "tests/support/command_check.h"

#include "tests/support/check.h"

using namespace sidestep;
using test::CommandCheck;

namespace {

constexpr double kPeriod_s = 0.01;

JointVector all(double value) {
  return JointVector::Constant(6, value);
}

/// A check after a valid stream: 0.3 s of acceleration at 5 rad/s2 from 0.1 rad, then constant velocity.
struct Stream {
  CommandCheck watch;
  JointVector position_rad = all(0.1), velocity_radps = all(0.0);

  Stream() : watch({all(-1), all(1), all(2), all(10)}, kPeriod_s) {
    watch.begin(position_rad, velocity_radps);
    for (int i = 0; i < 40; ++i) go(JointVector(velocity_radps + all(i < 30 ? 5 * kPeriod_s : 0.0)));
  }
  void go(const JointVector& velocity) {
    velocity_radps = velocity;
    position_rad += kPeriod_s * velocity;
    watch.feed(position_rad, velocity_radps);
  }
  JointVector next_rad() const { return position_rad + kPeriod_s * velocity_radps; }
  bool complains_of(const char* word) const { return watch.violation().find(word) != std::string::npos; }
};

JointVector with(JointVector vector, int joint, double change) {
  vector[joint] += change;
  return vector;
}

void a_valid_stream_passes(void**) {
  Stream stream;
  while (stream.velocity_radps[0] > 0) stream.go((stream.velocity_radps - all(0.1)).cwiseMax(0.0));
  stream.watch.end();
  assert_string_equal(stream.watch.violation().c_str(), "");
  assert_true(stream.watch.fed() > 50);
}

void a_position_jump_is_detected(void**) {
  for (int joint = 0; joint < 6; ++joint) {
    Stream stream;
    stream.watch.feed(with(stream.next_rad(), joint, 0.03), stream.velocity_radps);
    check(stream.complains_of("jumps") && stream.complains_of(("joint " + std::to_string(joint + 1)).c_str()), "%s",
          stream.watch.violation().c_str());
  }
}

void a_position_that_deviates_from_its_velocity_is_detected(void**) {
  Stream stream;
  stream.watch.feed(with(stream.next_rad(), 2, 1e-6), stream.velocity_radps);
  check(stream.complains_of("leads"), "%s", stream.watch.violation().c_str());
}

void too_much_acceleration_is_detected(void**) {
  Stream stream;
  stream.go(with(stream.velocity_radps, 3, 0.1 + 1e-6));
  check(stream.complains_of("velocity changes"), "%s", stream.watch.violation().c_str());
}

void too_much_velocity_is_detected(void**) {
  Stream stream;
  for (int i = 0; i < 5; ++i) stream.go(with(stream.velocity_radps, 1, 0.1));
  assert_string_equal(stream.watch.violation().c_str(), "");
  stream.go(with(stream.velocity_radps, 1, 0.01));
  check(stream.complains_of("velocity 2.01"), "%s", stream.watch.violation().c_str());
}

void leaving_the_position_limits_is_detected(void**) {
  Stream stream;
  for (int i = 0; i < 100; ++i) stream.go(stream.velocity_radps);
  check(stream.complains_of("outside"), "%s", stream.watch.violation().c_str());
}

void returning_from_outside_the_limits_is_allowed(void**) {
  CommandCheck returning({all(-1), all(1), all(2), all(10)}, kPeriod_s);
  returning.begin(all(1.5), all(0));
  returning.feed(all(1.499), all(-0.1));
  assert_string_equal(returning.violation().c_str(), "");
}

/// While the command catches up with a pushed arm, its positions may deviate from its velocity, but only as fast as a
/// joint could move.
void a_jump_is_detected_even_while_catching_up(void**) {
  CommandCheck gradual({all(-1), all(1), all(2), all(10)}, kPeriod_s), jump = gradual;
  for (CommandCheck* watch : {&gradual, &jump}) {
    watch->allow_position_correction();
    watch->begin(all(0.5), all(0));
  }
  gradual.feed(all(0.501), all(0));
  gradual.feed(all(0.503), all(0));
  assert_string_equal(gradual.violation().c_str(), "");
  gradual.feed(all(0.506 + 1e-6), all(0));
  assert_true(gradual.violation().find("rate changes") != std::string::npos);
  jump.feed(all(0.502), all(0));
  assert_true(jump.violation().find("rate changes") != std::string::npos);
}

void values_that_are_not_finite_are_detected(void**) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    Stream position, velocity;
    position.watch.feed(with(position.next_rad(), 5, bad), position.velocity_radps);
    velocity.watch.feed(velocity.next_rad(), with(velocity.velocity_radps, 5, bad));
    assert_true(position.complains_of("finite"));
    assert_true(velocity.complains_of("finite"));
  }
}

void a_wrong_number_of_joints_is_detected(void**) {
  Stream stream;
  stream.watch.feed(JointVector::Zero(7), JointVector::Zero(7));
  assert_true(stream.complains_of("number of joints"));
}

void a_stream_that_begins_elsewhere_is_detected(void**) {
  CommandCheck begun({all(-1), all(1), all(2), all(10)}, kPeriod_s);
  begun.begin(all(0.5), all(0));
  begun.feed(all(0.4), all(0));
  assert_true(begun.violation().find("jumps") != std::string::npos);
}

void a_stream_that_ends_in_motion_is_detected(void**) {
  Stream stream;
  stream.watch.end();
  assert_true(stream.complains_of("ends in motion"));
}

void the_first_complaint_is_kept(void**) {
  Stream stream;
  stream.watch.feed(with(stream.next_rad(), 0, std::nan("")), stream.velocity_radps);
  const std::string first = stream.watch.violation();
  stream.watch.feed(JointVector::Zero(7), JointVector::Zero(7));
  assert_string_equal(stream.watch.violation().c_str(), first.c_str());
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_valid_stream_passes),
      cmocka_unit_test(a_position_jump_is_detected),
      cmocka_unit_test(a_position_that_deviates_from_its_velocity_is_detected),
      cmocka_unit_test(too_much_acceleration_is_detected),
      cmocka_unit_test(too_much_velocity_is_detected),
      cmocka_unit_test(leaving_the_position_limits_is_detected),
      cmocka_unit_test(returning_from_outside_the_limits_is_allowed),
      cmocka_unit_test(a_jump_is_detected_even_while_catching_up),
      cmocka_unit_test(values_that_are_not_finite_are_detected),
      cmocka_unit_test(a_wrong_number_of_joints_is_detected),
      cmocka_unit_test(a_stream_that_begins_elsewhere_is_detected),
      cmocka_unit_test(a_stream_that_ends_in_motion_is_detected),
      cmocka_unit_test(the_first_complaint_is_kept),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
