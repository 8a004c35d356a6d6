#include "tests/support/live_scene.h"

#include "tests/support/check.h"
#include "tests/support/lwa3.h"

namespace sidestep::test {
namespace {

const Vector3 kHere(0.1, 0.45, 0.7), kThere(-0.4, 0.1, 0.9);

}  // namespace

Process start_controller(const std::string& law, std::vector<std::string> before) {
  const std::vector<std::string> command = {
      "build/controller", "--config", "firmware/config/lwa3.yaml", "--law", law, "--lcm-url", private_lcm_url()};
  before.insert(before.end(), command.begin(), command.end());
  return Process(before);
}

bool lost_few(const LiveArm& arm) {
  return 20 * arm.lost() <= static_cast<int64_t>(arm.peer.commands.size());
}

void check_stream(const LiveArm& arm) {
  const auto received = static_cast<int64_t>(arm.peer.commands.size());
  check(lost_few(arm), "%ld of %ld commands were lost: too many for a check", arm.lost(), arm.lost() + received);
  check(arm.commands.violation().empty(), "%s", arm.commands.violation().c_str());
}

LiveScene::LiveScene(const std::string& law) : controller(start_controller(law)), arm(lwa3().limits, home_rad()) {
  arm.target_m = kHere;
  check(arm.run_until(controller_status_t::TRACK, 10.0), "%s", controller.output().c_str());
  for (int i = 0; i < 100 && arm.speed_radps() < 0.3; ++i) arm.run(0.02);
  check(arm.speed_radps() >= 0.3, "%g rad/s: %s", arm.speed_radps(), arm.status().message.c_str());
}

void LiveScene::wander(double duration_s) {
  const double leg_s = 0.4;
  for (double t_s = 0.0; t_s < duration_s; t_s += leg_s) {
    arm.target_m = arm.target_m == kHere ? kThere : kHere;
    arm.run(leg_s);
  }
}

}  // namespace sidestep::test
