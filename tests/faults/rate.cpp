#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/live_arm.h"
#include "tests/support/lwa3.h"
#include "tests/support/process.h"
#include "tests/support/timing_subscriber.h"

using namespace sidestep;
using test::LiveArm;
using test::Process;
using test::TimingSubscriber;

namespace {

using Status = controller_status_t;

Process start_controller(const std::string& rate) {
  return Process({"build/controller", "--config", "firmware/config/lwa3.yaml", "--rate", rate, "--lcm-url",
                  test::private_lcm_url()});
}

/// Commands are 1 ms apart and within the limits.
void a_loop_at_1000_hz_moves_the_arm_within_its_limits(void**) {
  Process controller = start_controller("1000");
  LiveArm arm(test::lwa3().limits, test::home_rad(), 0.001);
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  check(arm.run_until(Status::TRACK, 10.0), "%s", controller.output().c_str());
  const Status first = arm.status();
  const size_t commands = arm.peer.commands.size();
  double fastest_radps = 0.0;
  for (int i = 0; i < 20; ++i) {
    arm.target_m = i % 8 < 4 ? Vector3(-0.4, 0.1, 0.9) : Vector3(0.1, 0.45, 0.7);
    arm.run(0.1);
    fastest_radps = std::max(fastest_radps, arm.speed_radps());
  }
  const Status last = arm.status();
  const double duration_s = static_cast<double>(last.utime - first.utime) * 1e-6;
  const auto periods = static_cast<double>(last.seq - first.seq + last.skipped_cycles - first.skipped_cycles);
  print_message("%.1f Hz with %ld skipped, up to %.2f rad/s\n", periods / duration_s,
                last.skipped_cycles - first.skipped_cycles, fastest_radps);
  check(std::abs(periods / duration_s - 1000.0) < 20.0, "%g Hz", periods / duration_s);
  check(arm.peer.commands.size() - commands > 1000, "%zu commands", arm.peer.commands.size() - commands);
  check(fastest_radps > 0.5, "%g rad/s", fastest_radps);
  check(arm.commands.violation().empty(), "%s", arm.commands.violation().c_str());
}

void one_cycle_integrates_over_the_configured_period(void**) {
  for (const char* law : {"paper", "sidestep"}) {
    Model model = test::lwa3_model(law);
    model.settings.rate_hz = 1000.0;
    test::ClosedLoop loop(model, test::home_rad());
    loop.target.position_m = Vector3(-0.2, 0.3, 0.8);
    loop.sends_target = true;
    loop.add_sphere(Vector3(0.2, 0.5, 0.8), Vector3(-0.1, 0, 0));
    assert_true(loop.run_until(Mode::kTrack, 1.0));
    loop.run(3.0);
    check_stream(loop);
    check(loop.last.report.target_distance_m < 0.02, "%s: %g m", law, loop.last.report.target_distance_m);
  }
}

void loop_timing_is_published_once_a_second(void**) {
  TimingSubscriber timing_subscriber;
  Process controller = start_controller("200");
  LiveArm arm(test::lwa3().limits, test::home_rad(), 0.005);
  arm.target_m = Vector3(0.1, 0.45, 0.7);
  check(arm.run_until(Status::TRACK, 10.0), "%s", controller.output().c_str());
  timing_subscriber.drain();
  timing_subscriber.received.clear();
  arm.run(3.0);
  timing_subscriber.drain();
  const auto count = static_cast<int>(timing_subscriber.received.size());
  check(count >= 2 && count <= 4, "%d messages in 3 s", count);
  const loop_timing_t& last = timing_subscriber.received.back();
  check_near(last.period, 0.005, 0.0);
  assert_true(last.cycles > timing_subscriber.received.front().cycles);
  for (const durations_t& d :
       {last.wake_latency, last.cycle, last.monitor, last.clearance, last.law, last.shield, last.gate})
    check(d.p50 > 0.0 && d.p50 <= d.p99 && d.p99 <= d.p999 && d.p999 <= d.worst && d.worst < 1.0, "%g %g %g %g", d.p50,
          d.p99, d.p999, d.worst);
  check(last.monitor.p50 + last.clearance.p50 + last.law.p50 + last.shield.p50 + last.gate.p50 < 2.0 * last.cycle.p50,
        "the stages take more than twice the cycle, %g s", last.cycle.p50);
}

void a_rate_out_of_range_is_refused(void**) {
  for (const char* rate : {"5", "5000", "-100", "nan", "fast"}) {
    Process controller = start_controller(rate);
    const int code = controller.wait(5.0);
    check(code == 2, "%s: code %d, %s", rate, code, controller.output().c_str());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_teardown(a_loop_at_1000_hz_moves_the_arm_within_its_limits, test::kill_processes),
      cmocka_unit_test(one_cycle_integrates_over_the_configured_period),
      cmocka_unit_test_teardown(loop_timing_is_published_once_a_second, test::kill_processes),
      cmocka_unit_test_teardown(a_rate_out_of_range_is_refused, test::kill_processes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
