#include "host/people/capsule_path.h"

#include "tests/support/check.h"

using namespace sidestep;

namespace {

constexpr double kPeriod_s = 0.01;

/// A capsule that moves and turns about z.
CapsulePath swinging() {
  std::vector<CapsulePath::Ends> samples;
  for (int k = 0; k <= 200; ++k) {
    const double angle = 3.0 * k * kPeriod_s, x = 0.5 * std::sin(2.0 * k * kPeriod_s);
    const Vector3 centre(x, 0, 1), half(0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.02);
    samples.push_back({centre - half, centre + half});
  }
  return {0.05, kPeriod_s, samples};
}

void the_path_passes_through_its_samples(void**) {
  const CapsulePath path = swinging();
  const CapsuleMotion motion = path.at(0.5);
  check_near(motion.capsule.centre(), Vector3(0.5 * std::sin(1.0), 0, 1), 1e-12);
  check_near(motion.capsule.radius_m, 0.05, 0.0);
}

void velocities_are_the_derivatives_of_the_ends(void**) {
  const CapsulePath path = swinging();
  for (double t_s = 0.0131; t_s < 1.98; t_s += 0.0517) {
    const CapsuleMotion before = path.at(t_s - 1e-6), now = path.at(t_s), after = path.at(t_s + 1e-6);
    check_near(now.start_mps, Vector3((after.capsule.start - before.capsule.start) / 2e-6), 1e-6);
    check_near(now.end_mps, Vector3((after.capsule.end - before.capsule.end) / 2e-6), 1e-6);
  }
}

void linear_and_angular_velocity_are_those_of_the_motion(void**) {
  const CapsuleMotion motion = swinging().at(0.7);
  check_near(motion.centre_mps(), Vector3(std::cos(1.4), 0, 0), 1e-3);
  const Vector3 axis = (motion.capsule.end - motion.capsule.start).normalized(), turn(0, 0, 3.0);
  check_near(motion.angular_radps(), Vector3(turn - turn.dot(axis) * axis), 0.01);
}

void before_the_start_and_after_the_end_the_capsule_stays(void**) {
  const CapsulePath path = swinging();
  check_near(path.at(-1.0).capsule.start, path.at(0.0).capsule.start, 0.0);
  check_near(path.at(9.0).capsule.start, path.at(2.0).capsule.start, 0.0);
  check_near(path.at(9.0).end_mps, Vector3::Zero(), 0.0);
}

void a_transformed_path_has_the_transformed_capsules(void**) {
  const Eigen::Isometry3d pose = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.7, Vector3(1, 2, 2).normalized());
  const CapsuleMotion before = swinging().at(0.7), after = swinging().transformed(pose).at(0.7);
  check_near(after.capsule.start, Vector3(pose * before.capsule.start), 1e-12);
  check_near(after.capsule.end, Vector3(pose * before.capsule.end), 1e-12);
  check_near(after.end_mps, Vector3(pose.linear() * before.end_mps), 1e-12);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_path_passes_through_its_samples),
      cmocka_unit_test(velocities_are_the_derivatives_of_the_ends),
      cmocka_unit_test(linear_and_angular_velocity_are_those_of_the_motion),
      cmocka_unit_test(before_the_start_and_after_the_end_the_capsule_stays),
      cmocka_unit_test(a_transformed_path_has_the_transformed_capsules),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
