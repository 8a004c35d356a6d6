#include <cstring>
#include <vector>

#include "firmware/model/kinematics.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::home_rad;
using test::lwa3_model;
using test::Random;

namespace {

const char* const kLaws[] = {"paper", "sidestep"};

void check_stream(const ClosedLoop& loop, const char* law, unsigned seed) {
  check(loop.commands.violation().empty(), "%s, seed %u: %s", law, seed, loop.commands.violation().c_str());
}

/// Changes the inputs at random; most cycles stay unchanged.
void disturb(ClosedLoop& loop, Random& random) {
  Target& target = loop.target;
  if (random.chance(0.02))
    target.position_m = random.inside(-1, 1) + Vector3(0, 0, 0.6);  // teleports, often out of reach
  if (random.chance(0.01))
    target.velocity_mps = random.chance(0.5) ? Vector3(random.inside(-0.5, 0.5)) : Vector3(Vector3::Zero());
  if (random.chance(0.01)) target.tracks_orientation = !target.tracks_orientation;
  if (random.chance(0.01)) target.orientation = random.turn();
  if (random.chance(0.02)) loop.sends_target = random.chance(0.8);
  if (random.chance(0.02)) loop.sends_obstacles = random.chance(0.8);
  if (random.chance(0.02)) loop.sends_arm_state = random.chance(0.7);
  if (random.chance(0.02)) loop.stop = random.chance(0.3);
  loop.skipped = random.chance(0.02) ? random.index(5) : 0;
  if (random.chance(0.02)) {
    loop.obstacles->count = 0;
    for (int i = random.index(12); i > 0; --i)
      loop.add_sphere(random.inside(-1, 1) + Vector3(0, 0, 0.6), random.inside(-1, 1), random.uniform(0, 0.2));
  }
}

/// Random disturbances of all inputs except inconsistent arm states.
void the_arm_can_follow_every_command_under_random_disturbances(void**) {
  for (const char* law : kLaws) {
    const Model model = lwa3_model(law);
    for (unsigned seed = 1; seed <= 12; ++seed) {
      Random random(seed);
      ClosedLoop loop(model, random.configuration(model.arm, 0.9));
      int64_t modes[5] = {};
      for (int cycle = 0; cycle < 1500; ++cycle) {
        if (cycle > 60) disturb(loop, random);
        loop.cycle();
        ++modes[static_cast<int>(loop.mode())];
        check(loop.mode() != Mode::kFault || loop.last.report.fault == Fault::kArmStateLost,
              "%s, seed %u, cycle %d: %s", law, seed, cycle, loop.last.report.message);
      }
      check_stream(loop, law, seed);
      check(modes[1] > 10 && modes[2] > 100 && modes[3] > 10, "%s, seed %u: %ld holding, %ld tracking, %ld braking",
            law, seed, modes[1], modes[2], modes[3]);
    }
  }
}

/// One arm state jumps away and back, as after a bit error.
void one_wrong_arm_state_does_not_make_the_commands_jump(void**) {
  for (const char* law : kLaws) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      Random random(seed);
      ClosedLoop loop(lwa3_model(law), home_rad());
      loop.target.position_m = Vector3(-0.1, 0.3, 0.8);
      loop.sends_target = true;
      loop.run(0.6 + 0.01 * random.index(30));
      const JointVector truth_rad = loop.arm.position_rad;
      loop.arm.position_rad = random.configuration(loop.model.arm);
      loop.cycle();
      loop.arm.position_rad = truth_rad;
      loop.run(2.0);
      check_stream(loop, law, seed);
    }
  }
}

void an_arm_that_moves_at_the_start_is_stopped_without_a_jump(void**) {
  for (const char* law : kLaws) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      Random random(seed);
      ClosedLoop loop(lwa3_model(law), home_rad());
      const JointVector qd_radps = random.joints(7, -0.3, 0.3);
      for (int cycle = 0; cycle < 100; ++cycle) {
        if (loop.mode() == Mode::kWait) {  // the arm is moved from outside
          loop.arm.velocity_radps = qd_radps;
          if (cycle > 0) loop.arm.position_rad += qd_radps * loop.model.settings.period_s();
        }
        loop.cycle();
      }
      assert_true(loop.mode() == Mode::kHold);
      check_near(loop.speed_radps(), 0.0, 0);
      check_stream(loop, law, seed);
    }
  }
}

/// No error of the measured velocity leads to a command beyond the limits.
void a_measured_velocity_beyond_the_limits_is_not_commanded(void**) {
  for (const char* law : kLaws) {
    for (const double wrong_radps : {2.05, -3.0, 50.0, 900.0}) {
      ClosedLoop loop(lwa3_model(law), home_rad());
      for (int cycle = 0; cycle < 100; ++cycle) {
        if (!loop.last.commanding) loop.arm.velocity_radps.setConstant(wrong_radps);
        const Inputs inputs = loop.receive();
        const Result result = step(loop.model, loop.state, inputs, loop.now_s());
        if (result.commanding)
          check(result.command.velocity_radps.cwiseAbs().maxCoeff() <= 2.0 + 1e-9,
                "%s: %g rad/s commanded after %g measured", law, result.command.velocity_radps.cwiseAbs().maxCoeff(),
                wrong_radps);
        loop.follow(result);
      }
    }
  }
}

void an_arm_outside_its_limits_returns_inside(void**) {
  for (const char* law : kLaws) {
    JointVector q_rad = home_rad();
    q_rad[1] = 2.1;
    q_rad[3] = -2.05;
    ClosedLoop loop(lwa3_model(law), q_rad);
    loop.run(5.0);
    check_stream(loop, law, 0);
    check(loop.arm.position_rad[1] <= 1.97 + 1e-3 && loop.arm.position_rad[3] >= -1.97 - 1e-3, "%s: still at %g and %g",
          law, loop.arm.position_rad[1], loop.arm.position_rad[3]);
  }
}

/// The command stays near a blocked arm and within the velocity limit.
void commands_stay_near_a_blocked_arm(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop(lwa3_model(law), home_rad());
    loop.target.position_m = Vector3(0.3, 0.4, 0.5);
    loop.sends_target = true;
    double farthest_rad = 0.0, fastest_rad = 0.0;
    JointVector last_rad;
    for (int cycle = 0; cycle < 600; ++cycle) {
      const Inputs inputs = loop.receive();
      const Result result = step(loop.model, loop.state, inputs, loop.now_s());
      loop.follow(result);
      loop.arm.position_rad = home_rad();
      loop.arm.velocity_radps.setZero();
      if (!result.commanding) continue;
      const JointVector& command_rad = result.command.position_rad;
      farthest_rad = std::max(farthest_rad, (command_rad - home_rad()).cwiseAbs().maxCoeff());
      if (last_rad.size() > 0) fastest_rad = std::max(fastest_rad, (command_rad - last_rad).cwiseAbs().maxCoeff());
      last_rad = command_rad;
    }
    assert_true(loop.mode() == Mode::kTrack);
    check(farthest_rad > 0.05, "%s: the command moved by only %g rad", law, farthest_rad);
    check(farthest_rad < 1.5 * loop.model.settings.following_error_rad, "%s: %g rad away", law, farthest_rad);
    check(fastest_rad <= 2.0 * 0.01 + 1e-9, "%s: %g rad in one cycle", law, fastest_rad);
  }
}

/// The arm holds and is pushed slowly, beyond half the following error. The command follows no faster than the arm.
void commands_follow_a_pushed_arm_without_a_jump(void**) {
  const double push_rad = 0.05 * 0.01, rounding_rad = 1e-9;
  for (const char* law : kLaws) {
    ClosedLoop loop(lwa3_model(law), home_rad());
    loop.run(1.0);
    assert_true(loop.mode() == Mode::kHold);
    JointVector pushed_rad = loop.arm.position_rad, last_rad = pushed_rad;
    double fastest_rad = 0.0;
    for (int cycle = 0; cycle < 1000; ++cycle) {
      pushed_rad[0] += push_rad;
      loop.arm.position_rad = pushed_rad;
      loop.arm.velocity_radps.setZero();
      loop.cycle();
      const JointVector& command_rad = loop.last.command.position_rad;
      fastest_rad = std::max(fastest_rad, (command_rad - last_rad).cwiseAbs().maxCoeff());
      last_rad = command_rad;
    }
    const double behind_rad = pushed_rad[0] - last_rad[0], error_rad = loop.model.settings.following_error_rad;
    check(behind_rad > 0.4 * error_rad && behind_rad < 0.6 * error_rad, "%s: %g rad behind", law, behind_rad);
    check(fastest_rad <= push_rad + rounding_rad, "%s: %g rad in one cycle", law, fastest_rad);
  }
}

/// The arm is pushed fast, also while it brakes because of old obstacles. The command catches up, but never faster than
/// a joint could move.
void commands_catch_up_with_a_pushed_arm_within_the_joint_limits(void**) {
  for (const char* law : kLaws) {
    for (const bool while_braking : {false, true}) {
      for (const double push_radps : {0.4, 1.0, 1.9}) {
        ClosedLoop loop(lwa3_model(law), home_rad());
        loop.commands.allow_position_correction();
        loop.run(1.0);
        JointVector moved_rad = loop.arm.position_rad;
        loop.sends_obstacles = !while_braking;
        loop.run(0.2);
        for (int cycle = 0; cycle < 300; ++cycle) {
          if (cycle >= 150) loop.sends_obstacles = true;
          if (cycle * 0.01 * push_radps < 0.8) moved_rad[0] += 0.01 * push_radps;
          loop.arm.position_rad = moved_rad;
          loop.arm.velocity_radps.setZero();
          loop.cycle();
          check(loop.mode() == (loop.sends_obstacles ? Mode::kHold : Mode::kBrake), "%s", loop.last.report.message);
        }
        check_stream(loop, law, 0);
        const double behind_rad = std::abs(moved_rad[0] - loop.last.command.position_rad[0]);
        check(behind_rad < 0.6 * loop.model.settings.following_error_rad, "%s: %g rad behind", law, behind_rad);
      }
    }
  }
}

/// Somebody pushes the arm past a joint's limit. The command stops at the limit within the acceleration limit.
void commands_that_catch_up_stop_at_a_joint_limit(void**) {
  for (const char* law : kLaws) {
    for (const double push_radps : {0.3, 1.0, 1.5, 2.0}) {
      for (const bool tracks : {false, true}) {
        for (const double side : {-1.0, 1.0}) {
          JointVector q_rad = home_rad();
          q_rad[1] = 1.5 * side;
          ClosedLoop loop(lwa3_model(law), q_rad);
          loop.commands.allow_position_correction();
          loop.target.position_m = forward_kinematics(loop.model.arm, q_rad).tool_position;
          loop.sends_target = tracks;
          loop.run(0.8);
          for (int cycle = 0; cycle < 150; ++cycle) {
            if (cycle < 70) loop.arm.position_rad[1] += side * push_radps * 0.01;
            loop.cycle();
          }
          check_stream(loop, law, static_cast<unsigned>(10 * push_radps));
        }
      }
    }
  }
}

/// All joints are pushed at random, past their limits too, while the arm holds, tracks or brakes.
void commands_of_a_pushed_arm_are_within_the_limits(void**) {
  for (const char* law : kLaws) {
    const Model model = lwa3_model(law);
    for (unsigned seed = 1; seed <= 20; ++seed) {
      Random random(seed);
      ClosedLoop loop(model, random.configuration(model.arm, 0.9));
      loop.commands.allow_position_correction();
      loop.run(0.6);
      JointVector push_radps = JointVector::Zero(7);
      for (int cycle = 0; cycle < 600; ++cycle) {
        if (random.chance(0.03)) push_radps = random.joints(7, -1.5, 1.5);
        if (random.chance(0.02)) push_radps.setZero();
        if (random.chance(0.02)) loop.sends_obstacles = random.chance(0.7);
        if (random.chance(0.02)) loop.sends_target = random.chance(0.7);
        loop.arm.position_rad += push_radps * 0.01;
        loop.cycle();
      }
      check_stream(loop, law, seed);
    }
  }
}

/// An arm that is moved toward a limit too fast to stop before it overshoots, and comes back. The rate of the commanded
/// position never changes faster than the acceleration limit.
void an_arm_that_cannot_stop_before_a_limit_overshoots_and_comes_back(void**) {
  for (const char* law : kLaws) {
    for (const double speed_radps : {0.4, 0.5, 1.0, 2.0}) {
      ClosedLoop loop(lwa3_model(law), home_rad());
      const double upper_rad = loop.model.arm.limits.upper_rad[1];
      loop.arm.position_rad[1] = upper_rad - 0.51 * speed_radps - 0.3 * speed_radps * speed_radps / 20.0;  // in 0.51 s
      double last_rad = loop.arm.position_rad[1], last_radps = speed_radps, highest_rad = last_rad;
      for (int cycle = 0; cycle < 300; ++cycle) {
        if (!loop.last.commanding) {  // moved by hand
          loop.arm.velocity_radps[1] = speed_radps;
          loop.arm.position_rad[1] += speed_radps * 0.01;
          last_rad = loop.arm.position_rad[1];
        }
        loop.cycle();
        if (!loop.last.commanding) continue;
        const double rate_radps = (loop.last.command.position_rad[1] - last_rad) / 0.01;
        check(std::abs(rate_radps - last_radps) <= 0.1 + 1e-6, "%s: %g rad/s after %g", law, rate_radps, last_radps);
        check(std::abs(rate_radps) <= 2.0 + 1e-6, "%s: %g rad/s", law, rate_radps);
        last_radps = rate_radps;
        last_rad = loop.last.command.position_rad[1];
        highest_rad = std::max(highest_rad, last_rad);
      }
      check(highest_rad > upper_rad, "%s, %g rad/s: no overshoot", law, speed_radps);
      check(last_rad < upper_rad + 1e-3 && std::abs(last_radps) < 1e-3, "%s: rests at %g", law, last_rad);
    }
  }
}

/// The smaller of the reported and the differentiated velocity counts.
void a_measured_velocity_that_the_positions_contradict_is_not_commanded(void**) {
  for (const char* law : kLaws) {
    for (const double wrong_radps : {0.5, -1.5, 1000.0}) {
      ClosedLoop loop(lwa3_model(law), home_rad());
      for (int cycle = 0; cycle < 100; ++cycle) {
        if (!loop.last.commanding) loop.arm.velocity_radps.setConstant(wrong_radps);
        const Inputs inputs = loop.receive();
        const Result result = step(loop.model, loop.state, inputs, loop.now_s());
        if (result.command.velocity_radps.size() > 0)  // lockstep publishes a command while waiting, too
          check_near(result.command.velocity_radps, JointVector::Zero(7).eval(), 0);
        loop.follow(result);
      }
      check(loop.mode() == Mode::kHold, "%s, %g: %s", law, wrong_radps, loop.last.report.message);
    }
  }
}

std::vector<double> random_run(const Model& model, unsigned seed) {
  std::vector<double> all;
  Random random(seed);
  ClosedLoop loop(model, home_rad());
  for (int cycle = 0; cycle < 1000; ++cycle) {
    if (cycle > 60) disturb(loop, random);
    loop.cycle();
    const Command& command = loop.last.command;
    all.insert(all.end(), command.position_rad.data(), command.position_rad.data() + command.position_rad.size());
    all.insert(all.end(), command.velocity_radps.data(), command.velocity_radps.data() + command.velocity_radps.size());
    all.push_back(loop.last.report.clearance_m);
    all.push_back(loop.last.report.beta);
  }
  return all;
}

void the_same_inputs_give_the_same_commands_bit_for_bit(void**) {
  for (const char* law : kLaws) {
    const Model model = lwa3_model(law), again = lwa3_model(law);
    const std::vector<double> one = random_run(model, 5), two = random_run(again, 5), other = random_run(model, 6);
    assert_int_equal(one.size(), two.size());
    assert_memory_equal(one.data(), two.data(), one.size() * sizeof(double));
    assert_true(one.size() != other.size() || std::memcmp(one.data(), other.data(), one.size() * sizeof(double)) != 0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_arm_can_follow_every_command_under_random_disturbances),
      cmocka_unit_test(one_wrong_arm_state_does_not_make_the_commands_jump),
      cmocka_unit_test(an_arm_that_moves_at_the_start_is_stopped_without_a_jump),
      cmocka_unit_test(a_measured_velocity_beyond_the_limits_is_not_commanded),
      cmocka_unit_test(an_arm_outside_its_limits_returns_inside),
      cmocka_unit_test(commands_stay_near_a_blocked_arm),
      cmocka_unit_test(commands_follow_a_pushed_arm_without_a_jump),
      cmocka_unit_test(commands_catch_up_with_a_pushed_arm_within_the_joint_limits),
      cmocka_unit_test(commands_that_catch_up_stop_at_a_joint_limit),
      cmocka_unit_test(commands_of_a_pushed_arm_are_within_the_limits),
      cmocka_unit_test(an_arm_that_cannot_stop_before_a_limit_overshoots_and_comes_back),
      cmocka_unit_test(a_measured_velocity_that_the_positions_contradict_is_not_commanded),
      cmocka_unit_test(the_same_inputs_give_the_same_commands_bit_for_bit),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
