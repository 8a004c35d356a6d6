#include <algorithm>
#include <functional>

#include "firmware/control/obstacle_memory.h"
#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

/// What a message reports instead of the obstacle, by its number.
using Report = std::function<void(int message, Obstacle& obstacle)>;

/// The tool moves to a target behind an obstacle at rest, which messages report wrongly. Returns the least true
/// clearance; infinity where the obstacle is not between start and target, or starts near the arm or its base.
double least_clearance_m(const Model& model, unsigned seed, const Obstacle& shape, const Report& report) {
  Random random(seed);
  const JointVector from_rad = random.configuration(model.arm, 0.6), to_rad = random.configuration(model.arm, 0.6);
  ClosedLoop loop(model, from_rad);
  const auto tool_at = [&](const JointVector& q_rad) { return forward_kinematics(model.arm, q_rad).tool_position; };
  const Vector3 between = tool_at(0.5 * (from_rad + to_rad));
  Obstacle& obstacle = loop.obstacles->obstacles[0];
  obstacle = extrapolated(shape, 0.0);
  obstacle.capsule.start += between;
  obstacle.capsule.end += between;
  loop.obstacles->count = 1;
  const auto clearance_m = [&] {
    const LinkPoses poses = forward_kinematics(model.arm, loop.arm.position_rad);
    return clearance_after(model.arm, poses, &obstacle, 1, 0.0, 1.0);
  };
  if (between.head<2>().norm() < 0.3 || clearance_m() < 0.1) return HUGE_VAL;
  loop.target.position_m = tool_at(from_rad);
  loop.sends_target = true;
  loop.run(0.6);
  loop.target.position_m = tool_at(to_rad);

  const auto memory =
      std::make_unique<ObstacleMemory>(model.settings.obstacle_speed_bound_mps, model.settings.timeouts.coast_s);
  const auto reported = std::make_unique<ObstacleSet>();
  double least_m = HUGE_VAL;
  for (int message = 0; message < 400; ++message) {
    Inputs inputs = loop.receive();
    reported->count = 1;
    reported->obstacles[0] = obstacle;
    report(message, reported->obstacles[0]);
    memory->add_remembered(*reported, model.settings.period_s(), loop.now_s());
    inputs.obstacles.message = reported.get();
    loop.follow(step(model, loop.state, inputs, loop.now_s()));
    least_m = std::min(least_m, clearance_m());
  }
  test::check_stream(loop);
  return least_m;
}

void an_obstacle_whose_size_flickers_is_not_touched(void**) {
  const Model model = test::lwa3_model("sidestep");
  const Obstacle sphere = sphere_obstacle(Vector3::Zero(), 0.08);
  const Obstacle box = box_obstacle(Vector3::Zero(), Matrix3::Identity(), Vector3(0.2, 0.15, 0.1));
  const auto shrinks = [](int message, Obstacle& obstacle) {
    if (message % 10 != 0) obstacle = sphere_obstacle(obstacle.capsule.centre(), 0.001);
  };
  for (const Obstacle& shape : {sphere, box}) {
    int scenes = 0;
    for (unsigned seed = 1; seed <= 250; ++seed) {
      const double least_m = least_clearance_m(model, seed, shape, shrinks);
      if (std::isinf(least_m)) continue;
      check(least_m > 0.0, "seed %u: %g m", seed, least_m);
      ++scenes;
    }
    check(scenes > 100, "only %d scenes", scenes);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(an_obstacle_whose_size_flickers_is_not_touched)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
