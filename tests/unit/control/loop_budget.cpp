#include <time.h>

#include <algorithm>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

/// CPU time of this thread, s; the time of other processes is not included.
double cpu_s() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Times {
  double median_s, p99_s, worst_s;
};

enum class ObstacleType { kSpheres, kBoxes, kLimbs };

const char* name_of(ObstacleType type) {
  if (type == ObstacleType::kSpheres) return "spheres";
  return type == ObstacleType::kBoxes ? "boxes  " : "limbs  ";
}

void add(ObstacleType type, Random& random, ClosedLoop& loop) {
  const Vector3 centre_m = random.inside(-0.8, 0.8) + Vector3(0, 0, 0.6), velocity_mps = random.inside(-0.3, 0.3);
  Obstacle& added = loop.add_sphere(centre_m, velocity_mps);
  if (type == ObstacleType::kSpheres) return;
  const int32_t id = added.id;
  const Matrix3 rotation = random.turn().toRotationMatrix();
  if (type == ObstacleType::kBoxes) {
    added = box_obstacle(centre_m, rotation, random.inside(0.02, 0.2));
    added.velocity_mps = velocity_mps;
  } else {
    added = capsule_obstacle(centre_m, rotation, 0.05, 0.3);
    added.velocity_mps = 5.0 * velocity_mps;
    added.kind = Kind::kPerson;
  }
  added.id = id;
  added.angular_velocity_radps = random.inside(-1, 1);
}

/// Measures step() while the target moves on a curve and the obstacles move back and forth within the arm's reach.
Times measure(const char* law, ObstacleType type, int obstacles, int cycles, bool with_orientation) {
  Random random(1);
  ClosedLoop loop(test::lwa3_model(law), test::home_rad());
  loop.sends_target = true;
  loop.target.tracks_orientation = with_orientation;
  for (int i = 0; i < obstacles; ++i) add(type, random, loop);
  std::vector<double> times;
  while (static_cast<int>(times.size()) < cycles) {
    const double t = loop.now_s();
    loop.target.position_m = Vector3(0.4 * std::cos(0.7 * t), 0.4 * std::sin(0.7 * t), 0.7 + 0.2 * std::sin(t));
    for (int i = 0; i < obstacles; ++i) {
      Obstacle& obstacle = loop.obstacles->obstacles[static_cast<size_t>(i)];
      const Vector3 from_centre_m = obstacle.capsule.centre() - Vector3(0, 0, 0.6);
      for (int axis = 0; axis < 3; ++axis)
        if (from_centre_m[axis] * obstacle.velocity_mps[axis] > 0 && std::abs(from_centre_m[axis]) > 0.8)
          obstacle.velocity_mps[axis] *= -1;
    }
    const Inputs inputs = loop.receive();
    const double start_s = cpu_s();
    const Result result = step(loop.model, loop.state, inputs, loop.now_s());
    const double time_s = cpu_s() - start_s;
    if (result.report.mode == Mode::kTrack) times.push_back(time_s);
    loop.follow(result);
    check(loop.now_s() < 2 + 0.01 * cycles, "%s: %zu cycles tracked", law, times.size());
  }
  std::sort(times.begin(), times.end());
  const Times found{times[times.size() / 2], times[times.size() * 99 / 100], times.back()};
  print_message("%-8s %4d %s%s: median %6.1f us, 99 %% below %6.1f us, worst %6.1f us\n", law, obstacles, name_of(type),
                with_orientation ? ", pose" : "      ", found.median_s * 1e6, found.p99_s * 1e6, found.worst_s * 1e6);
  return found;
}

/// The slowest cycles have several obstacles inside the arm, so that the shield relaxes one clearance after the other.
void a_cycle_among_50_moving_obstacles_takes_a_fraction_of_the_period(void**) {
  for (const auto& [law, slowest_s] : {std::pair{"paper", 2e-3}, {"sidestep", 4e-3}}) {
    for (const bool with_orientation : {false, true}) {
      const Times times = measure(law, ObstacleType::kSpheres, 50, 3000, with_orientation);
      check(times.median_s < 500e-6, "%s: median %g s", law, times.median_s);
      check(times.p99_s < slowest_s, "%s: p99 %g s", law, times.p99_s);
    }
  }
}

void a_cycle_among_50_turning_boxes_takes_a_fraction_of_the_period(void**) {
  const Times times = measure("sidestep", ObstacleType::kBoxes, 50, 1000, false);
  check(times.median_s < 1e-3 && times.p99_s < 5e-3, "median %g s, p99 %g s", times.median_s, times.p99_s);
}

/// Capsules of persons, up to 2.6 m/s: the arm keeps separation from them, and evades.
void a_cycle_among_the_limbs_of_two_persons_takes_a_fraction_of_the_period(void**) {
  const Times times = measure("sidestep", ObstacleType::kLimbs, 26, 3000, false);
  check(times.median_s < 2e-3 && times.p99_s < 5e-3, "median %g s, p99 %g s", times.median_s, times.p99_s);
}

void the_median_cycle_among_the_largest_obstacle_set_fits_into_the_period(void**) {
  for (const char* law : {"paper", "sidestep"}) {
    for (const ObstacleType type : {ObstacleType::kSpheres, ObstacleType::kBoxes}) {
      const Times times = measure(law, type, kMaxObstacles, 200, false);
      check(times.median_s < 10e-3, "%s: median %g s", law, times.median_s);
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_cycle_among_50_moving_obstacles_takes_a_fraction_of_the_period),
      cmocka_unit_test(a_cycle_among_50_turning_boxes_takes_a_fraction_of_the_period),
      cmocka_unit_test(a_cycle_among_the_limbs_of_two_persons_takes_a_fraction_of_the_period),
      cmocka_unit_test(the_median_cycle_among_the_largest_obstacle_set_fits_into_the_period),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
