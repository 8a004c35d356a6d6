#include "host/campaign/boxes/box_path.h"

#include "tests/support/check.h"

using namespace sidestep::campaign;

namespace {

const Vector3 kStart_m(0.2, -0.3, 0.5), kVelocity_mps(0.1, 0.2, -0.2);  // 0.3 m/s

/// Ends 0.6 m ahead of the start and 0.3 m behind it, reached after 2, 5, 8, ... s.
BoxPath path() {
  return {kStart_m, kVelocity_mps, 0.6, 0.3};
}

void a_box_goes_to_and_fro_between_the_ends_of_its_line(void**) {
  const Vector3 ahead_m = kStart_m + 2.0 * kVelocity_mps, behind_m = kStart_m - 1.0 * kVelocity_mps;
  check_near(path().at(0.0).position_m, kStart_m, 0.0);
  check_near(path().at(1.0).position_m, Vector3(kStart_m + kVelocity_mps), 1e-12);
  check_near(path().at(2.0).position_m, ahead_m, 1e-12);
  check_near(path().at(4.0).position_m, kStart_m, 1e-12);
  check_near(path().at(5.0).position_m, behind_m, 1e-12);
  check_near(path().at(8.0).position_m, ahead_m, 1e-12);
}

void the_velocity_is_the_slope_of_the_position(void**) {
  for (double t_s = 0.05; t_s < 20.0; t_s += 0.1) {  // no turn is within 0.05 s
    const Vector3 slope_mps = (path().at(t_s + 1e-4).position_m - path().at(t_s - 1e-4).position_m) / 2e-4;
    check_near_because(path().at(t_s).velocity_mps, slope_mps, 1e-9, "at %g s", t_s);
  }
}

void the_velocity_reverses_at_the_turns(void**) {
  const std::vector<double> turns_s = path().turns_s(10.0);
  check(turns_s.size() == 3, "%zu turns", turns_s.size());
  for (size_t i = 0; i < turns_s.size(); ++i) {
    check_near(turns_s[i], 2.0 + 3.0 * static_cast<double>(i), 1e-12);
    check_near(path().at(turns_s[i] - 1e-6).velocity_mps, Vector3(-path().at(turns_s[i] + 1e-6).velocity_mps), 0.0);
  }
}

void before_the_scene_a_box_is_at_its_start(void**) {
  check_near(path().at(-1.0).position_m, kStart_m, 0.0);
  check_near(path().at(-1.0).velocity_mps, kVelocity_mps, 0.0);
}

void a_box_without_speed_rests(void**) {
  const BoxPath rests(kStart_m, Vector3::Zero(), 0.6, 0.3);
  check_near(rests.at(7.0).position_m, kStart_m, 0.0);
  check_near(rests.at(7.0).velocity_mps, Vector3(Vector3::Zero()), 0.0);
  check(rests.turns_s(100.0).empty(), "it turns");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_box_goes_to_and_fro_between_the_ends_of_its_line),
      cmocka_unit_test(the_velocity_is_the_slope_of_the_position),
      cmocka_unit_test(the_velocity_reverses_at_the_turns),
      cmocka_unit_test(before_the_scene_a_box_is_at_its_start),
      cmocka_unit_test(a_box_without_speed_rests),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
