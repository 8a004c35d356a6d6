#include "host/campaign/people/camera.h"

#include "host/campaign/scene_maker.h"
#include "host/campaign/sensing.h"
#include "host/people/body.h"
#include "tests/support/check.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

void ideal_families_report_persons_exactly_in_every_cycle(void**) {
  const Scene scene = make_scene(family_named("walk-by"), 1);
  Sensing sensing(scene);
  for (int k = 0; k < 300; ++k) {
    const ObstacleMeasurement& measured = sensing.newest_at(1'000'000 + k * kPeriod_us, k * kPeriod_s);
    check(measured.obstacles.size() == kBodyParts && measured.count == k + 1, "cycle %d", k);
    for (size_t i = 0; i < measured.obstacles.size(); ++i) {
      const Obstacle& obstacle = measured.obstacles[i];
      const CapsuleMotion truth = scene.capsules[i].at(k * kPeriod_s);
      check(obstacle.kind == Kind::kPerson && obstacle.shape == Shape::kCapsule, "part %zu", i);
      check_near(obstacle.capsule.start, truth.capsule.start, 0.0);
      check_near(velocity_at(obstacle, truth.capsule.end), truth.end_mps, 0.02);
    }
  }
}

/// What the camera made of a long sequence of pictures of one scene.
struct Statistics {
  int pictures = 0, received = 0, confused = 0;
  double noise_squares_m2 = 0.0, velocity_squares = 0.0;
  int coordinates = 0;
};

Statistics watch(const Scene& scene) {
  Camera camera(scene);
  Statistics statistics;
  std::vector<Obstacle> obstacles;
  for (int k = 0; k < 20'000; ++k) {
    const double clock_s = k / 30.0, t_s = std::fmod(clock_s, 10.0);
    ++statistics.pictures;
    if (!camera.capture(clock_s, t_s, obstacles)) continue;
    ++statistics.received;
    const CapsuleMotion torso = scene.capsules[kTorso].at(t_s), hand = scene.capsules[kHandLeft].at(t_s);
    const Vector3 noise_m = obstacles[kTorso].capsule.start - torso.capsule.start;
    statistics.noise_squares_m2 += noise_m.squaredNorm();
    if (t_s > 0.3) statistics.velocity_squares += (obstacles[kTorso].velocity_mps - torso.centre_mps()).squaredNorm();
    statistics.coordinates += 3;
    statistics.confused += (obstacles[kHandLeft].capsule.centre() - hand.capsule.centre()).norm() > 0.1;
  }
  return statistics;
}

void the_camera_is_noisy_incomplete_and_takes_hands_for_each_other(void**) {
  double least_m = 1.0, most_m = 0.0;
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const Statistics statistics = watch(make_scene(family_named("walk-by@camera"), seed));
    const double noise_m = std::sqrt(statistics.noise_squares_m2 / statistics.coordinates);
    check(noise_m > 0.0049 && noise_m < 0.0102, "%g m", noise_m);
    check_near(static_cast<double>(statistics.received) / statistics.pictures, 0.9, 0.01);
    const double velocity_mps = std::sqrt(statistics.velocity_squares / statistics.coordinates);
    check(velocity_mps > 0.03 && velocity_mps < 0.3, "%g m/s", velocity_mps);
    const double confused = static_cast<double>(statistics.confused) / statistics.received;
    check(confused > 0.002 && confused < 0.02, "%g", confused);  // 0.5 % / 5 pairs, for 0.2 s = 6 sets
    least_m = std::min(least_m, noise_m);
    most_m = std::max(most_m, noise_m);
  }
  check(most_m - least_m > 5e-4, "%g to %g m", least_m, most_m);
}

void a_picture_is_received_50_ms_late_and_30_times_a_second(void**) {
  const Scene scene = make_scene(family_named("reach-in@camera"), 1);
  Sensing sensing(scene);
  int64_t count = 0, last_us = 0;
  for (int64_t now_us = 1'000'000; now_us < 11'000'000; now_us += kPeriod_us) {
    const ObstacleMeasurement& measured = sensing.newest_at(now_us, static_cast<double>(now_us - 1'000'000) / 1e6);
    check(measured.received_us <= now_us, "received ahead of time");
    if (measured.received_us != last_us && last_us != 0) {
      const int64_t apart_us = measured.received_us - last_us;
      check(apart_us % 33'333 < 7, "%ld us", static_cast<long>(apart_us));
      const double captured_s = static_cast<double>(measured.received_us - 50'000 - 1'000'000) / 1e6;
      check_near(measured.obstacles[kHead].capsule.centre(), scene.capsules[kHead].at(captured_s).capsule.centre(),
                 0.06);
    }
    last_us = measured.received_us;
    count = measured.count;
  }
  check(count > 250 && count < 310, "%ld sets", static_cast<long>(count));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(ideal_families_report_persons_exactly_in_every_cycle),
      cmocka_unit_test(the_camera_is_noisy_incomplete_and_takes_hands_for_each_other),
      cmocka_unit_test(a_picture_is_received_50_ms_late_and_30_times_a_second),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
