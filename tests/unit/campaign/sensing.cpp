#include "host/campaign/sensing.h"

#include <algorithm>

#include "host/campaign/decoys.h"
#include "host/campaign/scene_maker.h"
#include "tests/support/check.h"

using namespace sidestep::campaign;

namespace {

void exact_sensing_reports_the_truth_in_every_cycle(void**) {
  const Scene scene = make_scene(family_named("erratic"), 1);
  Sensing sensing(scene);
  for (int k = 0; k < 300; ++k) {
    const ObstacleMeasurement& measured = sensing.newest_at(1'000'000 + k * kPeriod_us, k * kPeriod_s);
    check(measured.count == k + 1 && measured.received_us == 1'000'000 + k * kPeriod_us, "cycle %d", k);
    check(measured.obstacles.size() == scene.spheres.size(), "cycle %d", k);
    for (size_t i = 0; i < measured.obstacles.size(); ++i) {
      check_near(measured.obstacles[i].capsule.start, scene.spheres[i].at(k * kPeriod_s).position_m, 0.0);
      check_near(measured.obstacles[i].velocity_mps, scene.spheres[i].at(k * kPeriod_s).velocity_mps, 0.0);
    }
  }
}

/// Statistics of the measurements of one sphere in a scene of the family real.
struct Statistics {
  int received = 0;
  double noise_sum_m = 0.0, noise_squares_m2 = 0.0;
  int64_t oldest_us = 0;
};

Statistics watch(double duration_s) {
  const Scene scene = make_scene(family_named("real"), 2);
  Sensing sensing(scene);
  Statistics statistics;
  const int64_t start_us = 1'000'000;
  int64_t count = sensing.newest_at(start_us, 0.0).count;
  for (int64_t now_us = start_us; now_us < start_us + static_cast<int64_t>(duration_s * 1e6); now_us += kPeriod_us) {
    const ObstacleMeasurement& measured = sensing.newest_at(now_us, static_cast<double>(now_us - start_us) / 1e6);
    check(measured.received_us <= now_us, "received %ld us ahead of time",
          static_cast<long>(measured.received_us - now_us));
    statistics.oldest_us = std::max(statistics.oldest_us, now_us - measured.received_us);
    if (measured.count == count) continue;
    check(measured.count == count + 1, "two sets were received in one cycle");
    count = measured.count;
    ++statistics.received;
    const double captured_s = static_cast<double>(measured.received_us - 40'000 - start_us) / 1e6;
    const PointMotion truth = scene.spheres[0].at(captured_s);
    check_near(measured.obstacles[0].velocity_mps, truth.velocity_mps, 0.0);
    const double noise_m = (measured.obstacles[0].capsule.start - truth.position_m).x();
    statistics.noise_sum_m += noise_m;
    statistics.noise_squares_m2 += noise_m * noise_m;
  }
  return statistics;
}

void real_sensing_is_late_noisy_and_incomplete(void**) {
  const Statistics measured = watch(200.0);
  check(std::abs(measured.received - 0.9 * 30 * 200) < 100, "%d received", measured.received);
  check_near(measured.noise_sum_m / measured.received, 0.0, 3e-4);
  check_near(std::sqrt(measured.noise_squares_m2 / measured.received), 0.005, 2e-4);
  check(measured.oldest_us > 60'000 && measured.oldest_us < 300'000, "%ld us", static_cast<long>(measured.oldest_us));
}

void obstacles_are_measured_at_rest_while_the_scene_is_frozen(void**) {
  const Scene scene = make_scene(family_named("real"), 2);
  Sensing sensing(scene);
  for (int k = 0; k < 100; ++k)
    check_near(sensing.newest_at(1'000'000 + k * kPeriod_us, 0.0).obstacles[0].capsule.start,
               scene.spheres[0].at(0.0).position_m, 0.03);
}

void obstacles_are_reported_as_they_will_be(void**) {
  for (const char* name : {"erratic", "gesture", "gesture@camera"}) {
    const Scene scene = make_scene(family_named(name), 3);
    Scene known = scene;
    known.ahead_s = 0.2;
    Sensing sensing(scene), knowing(known);
    for (int k = 0; k < 300; ++k) {
      const int64_t now_us = 1'000'000 + k * kPeriod_us;
      const ObstacleMeasurement& later = sensing.newest_at(now_us, k * kPeriod_s + 0.2);
      const ObstacleMeasurement& now = knowing.newest_at(now_us, k * kPeriod_s);
      check(now.received_us == later.received_us && now.count == later.count, "%s, cycle %d", name, k);
      check(!now.obstacles.empty() && now.obstacles.size() == later.obstacles.size(), "%s, cycle %d", name, k);
      for (size_t i = 0; i < now.obstacles.size(); ++i) {
        check_near(now.obstacles[i].capsule.end, later.obstacles[i].capsule.end, 1e-9);
        check_near(now.obstacles[i].velocity_mps, later.obstacles[i].velocity_mps, 1e-9);
      }
    }
  }
}

void decoys_are_harmless_and_come_in_a_new_order_in_every_set(void**) {
  Scene scene = make_scene(family_named("dodge@1"), 3);
  add_decoys(scene, 40);
  const ArmPose pose = scene.arm->pose(scene.start_rad);
  for (const sidestep::sim::Obstacle& decoy : scene.furniture) {
    const double clearance_m = scene.arm->clearance(pose, decoy.motion.position_m, decoy.solid.size_m.x());
    check(clearance_m >= 0.25 && clearance_m <= 0.5, "%g m", clearance_m);
  }
  Sensing sensing(scene);
  const std::vector<size_t> first = sensing.newest_at(1'000'000, 0.0).order;
  const ObstacleMeasurement& second = sensing.newest_at(1'000'000 + kPeriod_us, kPeriod_s);
  check(second.obstacles.size() == 41 && second.order != first, "%zu obstacles", second.obstacles.size());
  check(std::is_permutation(first.begin(), first.end(), second.order.begin()), "not the same obstacles");
  check_near(second.obstacles[0].velocity_mps.norm(), 1.0, 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(exact_sensing_reports_the_truth_in_every_cycle),
      cmocka_unit_test(real_sensing_is_late_noisy_and_incomplete),
      cmocka_unit_test(obstacles_are_measured_at_rest_while_the_scene_is_frozen),
      cmocka_unit_test(obstacles_are_reported_as_they_will_be),
      cmocka_unit_test(decoys_are_harmless_and_come_in_a_new_order_in_every_set),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
