#include <algorithm>
#include <functional>

#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::check_stream;
using test::ClosedLoop;
using test::Random;

namespace {

const char* const kLaws[] = {"paper", "sidestep"};

/// What one arm state reports wrongly.
struct Glitch {
  JointVector position_rad, velocity_radps;
};

/// 0.01 to 3 rad and rad/s, in one joint or in several, in the position, the velocity or both.
Glitch random_glitch(Random& random) {
  Glitch glitch{JointVector::Zero(7), JointVector::Zero(7)};
  const int kind = random.index(3), first = random.index(7), last = random.chance(0.5) ? first : 6;
  const auto size = [&] { return (random.chance(0.5) ? 1 : -1) * 0.01 * std::pow(300.0, random.uniform(0, 1)); };
  for (int joint = first; joint <= last; ++joint) {
    if (kind != 1) glitch.position_rad[joint] = size();
    if (kind != 0) glitch.velocity_radps[joint] = size();
  }
  return glitch;
}

/// A cycle that receives the arm with this error.
void cycle(ClosedLoop& loop, const Glitch& glitch) {
  Inputs inputs = loop.receive();
  ArmState wrong = *inputs.arm.message;
  wrong.position_rad += glitch.position_rad;
  wrong.velocity_radps += glitch.velocity_radps;
  inputs.arm.message = &wrong;
  loop.follow(step(loop.model, loop.state, inputs, loop.now_s()));
}

/// The arm on its way to a random target, at a random moment.
ClosedLoop in_motion(const Model& model, Random& random) {
  ClosedLoop loop(model, test::home_rad());
  loop.target.position_m = random.inside(-0.6, 0.6) + Vector3(0, 0, 0.6);
  loop.sends_target = true;
  loop.run(0.6 + 0.01 * random.index(40));
  return loop;
}

void one_wrong_arm_state_is_bridged_without_leaving_track(void**) {
  for (const char* law : kLaws) {
    const Model model = test::lwa3_model(law);
    double fastest_radps = 0.0;
    for (unsigned seed = 1; seed <= 300; ++seed) {
      Random random(seed);
      ClosedLoop loop = in_motion(model, random);
      fastest_radps = std::max(fastest_radps, loop.arm.velocity_radps.cwiseAbs().maxCoeff());
      cycle(loop, random_glitch(random));
      for (int after = 0; after < 30; ++after) {
        check(loop.mode() == Mode::kTrack && loop.last.commanding, "%s, seed %u, %d cycles after: %s", law, seed, after,
              loop.last.report.message);
        loop.cycle();
      }
      check_stream(loop);
    }
    check(fastest_radps > 1.9, "%s: only %g rad/s", law, fastest_radps);
  }
}

/// Up to 0.3 s of states that are each wrong by another amount, or all by the same one. The commands either go on or
/// brake to rest, and the arm tracks again. (A wrong state within reach is accepted, and the command may close its
/// following error.)
void wrong_arm_states_in_a_row_never_make_the_commands_jump(void**) {
  for (const char* law : kLaws) {
    const Model model = test::lwa3_model(law);
    int faults = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      Random random(seed);
      ClosedLoop loop = in_motion(model, random);
      const Glitch same = random_glitch(random);
      const bool another_each_time = random.chance(0.5);
      bool fault = false;
      loop.commands.allow_position_correction();
      for (int wrong = 1 + random.index(30); wrong > 0; --wrong) {
        cycle(loop, another_each_time ? random_glitch(random) : same);
        fault = fault || loop.mode() == Mode::kFault;
        check(loop.last.commanding || fault, "%s, seed %u: %s", law, seed, loop.last.report.message);
      }
      check(loop.run_until(Mode::kTrack, 1.0), "%s, seed %u: %s", law, seed, loop.last.report.message);
      loop.run(0.2);
      check_stream(loop);
      faults += fault;
    }
    check(faults > 10 && faults < 190, "%s: %d faults", law, faults);
  }
}

/// As a silent arm: brakes after 30 ms, fault after 100 ms, commands again after 0.5 s.
void an_arm_that_stays_out_of_reach_is_braked_from_the_last_command(void**) {
  for (const char* law : kLaws) {
    ClosedLoop loop = test::tracking(law);
    Glitch elsewhere{JointVector::Zero(7), JointVector::Zero(7)};
    elsewhere.position_rad[2] = 1.0;
    const auto run = [&](double duration_s) {
      for (int cycles = static_cast<int>(std::lround(duration_s / 0.01)); cycles > 0; --cycles) cycle(loop, elsewhere);
    };
    run(0.03);
    check(loop.mode() == Mode::kTrack, "%s: %s", law, loop.last.report.message);
    run(0.01);
    check(loop.mode() == Mode::kBrake && loop.last.commanding, "%s: %s", law, loop.last.report.message);
    run(0.07);
    check(loop.mode() == Mode::kFault && loop.last.report.fault == Fault::kArmStateInconsistent, "%s: %s", law,
          loop.last.report.message);
    run(0.3);
    check(loop.mode() == Mode::kFault && !loop.last.commanding, "%s: %s", law, loop.last.report.message);
    check_stream(loop);
    run(0.25);
    check(loop.mode() == Mode::kTrack && loop.last.commanding, "%s: %s", law, loop.last.report.message);
    check_near(loop.last.command.position_rad[2], loop.arm.position_rad[2] + 1.0, 0.02);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(one_wrong_arm_state_is_bridged_without_leaving_track),
      cmocka_unit_test(wrong_arm_states_in_a_row_never_make_the_commands_jump),
      cmocka_unit_test(an_arm_that_stays_out_of_reach_is_braked_from_the_last_command),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
