#include "tests/support/allocation_count.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

/// Places random spheres and capsules around and inside the arm.
void surround(ClosedLoop& loop, int count, unsigned seed) {
  Random random(seed);
  loop.obstacles->count = 0;
  for (int i = 0; i < count; ++i) {
    Obstacle& obstacle = loop.add_sphere(random.inside(-0.8, 0.8) + Vector3(0, 0, 0.6), random.inside(-0.3, 0.3));
    if (i % 3 == 0) obstacle.capsule.end += random.inside(-0.2, 0.2);
    if (i % 3 == 0) obstacle.angular_velocity_radps = random.inside(-1, 1);
  }
}

/// Runs cycles and returns the number of heap allocations in step() alone.
int64_t allocations(ClosedLoop& loop, int cycles, int (&modes)[5]) {
  int64_t sum = 0;
  for (int i = 0; i < cycles; ++i) {
    const Inputs inputs = loop.receive();
    const int64_t before = test::allocation_count();
    const Result result = step(loop.model, loop.state, inputs, loop.now_s());
    sum += test::allocation_count() - before;
    ++modes[static_cast<int>(result.report.mode)];
    loop.follow(result);
  }
  return sum;
}

void the_counter_counts_allocations_by_new_and_by_eigen(void**) {
  const int64_t start = test::allocation_count();
  int* volatile one = new int(1);
  const int64_t after_new = test::allocation_count();
  delete one;
  volatile int size = 20;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(size, size);
  const int64_t after_eigen = test::allocation_count();
  assert_int_equal(after_new - start, 1);
  check(after_eigen - after_new == 1 && matrix.sum() > 0, "%ld", after_eigen - after_new);
}

void no_cycle_allocates_in_any_mode_law_or_number_of_obstacles(void**) {
  for (const char* law : {"paper", "sidestep"}) {
    const Model model = test::lwa3_model(law);
    for (const int obstacles : {0, 1, 64, kMaxObstacles}) {
      for (const bool with_orientation : {false, true}) {
        int modes[5] = {};
        ClosedLoop loop(model, test::home_rad());
        loop.target.position_m = Vector3(-0.1, 0.3, 0.8);
        loop.target.tracks_orientation = with_orientation;
        loop.target.angular_velocity_radps = Vector3(0, 0, 0.1);
        surround(loop, obstacles, 1);
        int64_t sum = allocations(loop, 55, modes);
        loop.sends_target = true;
        sum += allocations(loop, 30, modes);
        loop.sends_obstacles = false;
        sum += allocations(loop, 15, modes);
        loop.sends_obstacles = true;
        loop.sends_arm_state = false;
        sum += allocations(loop, 15, modes);
        loop.sends_arm_state = true;
        sum += allocations(loop, 60, modes);
        loop.target.position_m.x() = std::nan("");
        sum += allocations(loop, 2, modes);
        loop.stop = true;
        sum += allocations(loop, 60, modes);
        check(sum == 0, "%s, %d obstacles: %ld allocations", law, obstacles, sum);
        for (int mode = 0; mode < 5; ++mode)
          check(modes[mode] > 0, "%s, %d obstacles: mode %d was never reached", law, obstacles, mode);
      }
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_counter_counts_allocations_by_new_and_by_eigen),
      cmocka_unit_test(no_cycle_allocates_in_any_mode_law_or_number_of_obstacles),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
