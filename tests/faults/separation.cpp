#include <algorithm>
#include <deque>
#include <memory>

#include "firmware/model/clearance.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

constexpr int kLatePeriods = 8;
constexpr double kNoise_m = 0.03;
constexpr int kRuns = 60;

/// A sensor that reports obstacles late and with random errors of position.
class Sensor {
 public:
  const ObstacleSet& measure(const ObstacleSet& now, Random& random) {
    auto seen = std::make_unique<ObstacleSet>();
    seen->count = now.count;
    for (size_t i = 0; i < static_cast<size_t>(now.count); ++i) {
      Obstacle& obstacle = seen->obstacles[i] = now.obstacles[i];
      const Vector3 error_m = random.uniform(0, kNoise_m) * random.direction();
      obstacle.capsule.start += error_m;
      obstacle.capsule.end += error_m;
    }
    seen_.push_back(std::move(seen));
    if (seen_.size() > kLatePeriods + 1) seen_.pop_front();
    return *seen_.front();
  }

 private:
  std::deque<std::unique_ptr<ObstacleSet>> seen_;
};

double true_clearance_m(const ClosedLoop& loop) {
  const ObstacleView truth{loop.obstacles.get(), 0.0, 0.0};
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  return measure_clearance(loop.model.arm, poses, truth, {0.4, 0.0}).nearest.distance_m;
}

/// Least distance between the arm, which keeps its tool at a target, and a sphere that crosses its workspace.
double least_clearance_m(const ObstacleTrust& trust, unsigned seed) {
  Random random(seed);
  ClosedLoop loop = test::tracking("sidestep");
  loop.model.settings.obstacle_trust = trust;
  const Vector3 near_tool_m = Vector3(-0.328, 0.0, 0.8) + random.inside(-0.1, 0.1);
  const double speed_mps = random.uniform(0.3, 0.6);
  const Vector3 from = (random.direction() + Vector3(-0.5, 0, 0.5)).normalized();
  loop.add_sphere(near_tool_m + 1.0 * from, -speed_mps * from, 0.08);
  Sensor sensor;
  double least_m = 1.0;
  for (int64_t n = 1; n < 250; ++n) {
    Inputs inputs = loop.receive();
    inputs.obstacles = {&sensor.measure(*loop.obstacles, random), loop.now_s(), inputs.obstacles.count};
    loop.follow(step(loop.model, loop.state, inputs, loop.now_s()));
    least_m = std::min(least_m, true_clearance_m(loop));
  }
  check_stream(loop);
  return least_m;
}

struct Clearances {
  int contacts = 0, below_hard = 0;
  double worst_m = 1.0, mean_m = 0.0;
};

Clearances play(const char* name, const ObstacleTrust& trust) {
  Clearances clearances;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const double least_m = least_clearance_m(trust, seed);
    clearances.contacts += least_m <= 0.0;
    clearances.below_hard += least_m < ShieldSettings().hard_clearance_m;
    clearances.worst_m = std::min(clearances.worst_m, least_m);
    clearances.mean_m += least_m / kRuns;
  }
  print_message("%-24s least clearance %.3f m, mean of the least %.3f m, %d contacts, %d below the hard clearance\n",
                name, clearances.worst_m, clearances.mean_m, clearances.contacts, clearances.below_hard);
  return clearances;
}

/// The sensor is 80 ms late and wrong by up to 3 cm. The configured errors are added to the clearance.
void configured_latency_and_uncertainty_increase_the_clearance(void**) {
  const Clearances unconfigured = play("nothing configured", {});
  play("latency", {0.08, 0.0, 0.0});
  play("uncertainty", {0.0, kNoise_m, 0.0});
  const Clearances configured = play("latency, uncertainty", {0.08, kNoise_m, 0.0});
  check(configured.below_hard <= unconfigured.below_hard, "%d below, %d before", configured.below_hard,
        unconfigured.below_hard);
  check(configured.worst_m > unconfigured.worst_m && configured.mean_m > unconfigured.mean_m + 0.01, "%g m",
        configured.worst_m);
}

void an_obstacle_grows_by_its_uncertainty_and_with_its_age(void**) {
  ClosedLoop loop = test::at_home("sidestep");
  loop.model.settings.obstacle_trust = {0.05, 0.02, 4.0};
  loop.add_sphere(Vector3(1.5, 0, 0.5), Vector3(0.3, 0, 0));
  loop.run(0.1);
  const double truth_m = true_clearance_m(loop), seen_m = loop.last.report.clearance_m;
  check_near(truth_m - seen_m, 0.02 + 0.5 * 4.0 * 0.05 * 0.05, 0.02);
  loop.sends_obstacles = false;
  loop.run(0.05);
  const double later_m = loop.last.report.clearance_m;
  check_near(seen_m - later_m, 0.5 * 4.0 * (0.1 * 0.1 - 0.05 * 0.05), 0.02);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(configured_latency_and_uncertainty_increase_the_clearance),
      cmocka_unit_test(an_obstacle_grows_by_its_uncertainty_and_with_its_age),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
