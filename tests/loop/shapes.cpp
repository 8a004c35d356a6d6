#include <memory>

#include "firmware/model/clearance.h"
#include "host/sim/truth.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/fcl_distance.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::ClosedLoop;

namespace {

/// The loop's obstacles and the model's surroundings as obstacles of the simulator.
std::vector<sim::Obstacle> solids(const ClosedLoop& loop) {
  std::vector<sim::Obstacle> solids;
  const ObstacleView all{loop.obstacles.get(), 0.0, 0.0, &loop.model.surroundings};
  for (int i = 0; i < all.count(); ++i) {
    const test::SolidAtPose placed = test::solid_at_pose(all.at(i));
    sim::Obstacle& obstacle = solids.emplace_back();
    obstacle.solid = placed.solid;
    obstacle.motion.position_m = placed.base_from_solid.translation();
    obstacle.motion.orientation = placed.base_from_solid.linear();
  }
  return solids;
}

/// True clearance of the arm as its URDF describes it, by FCL.
class TrueClearance {
 public:
  double measure_m(const ClosedLoop& loop) {
    truth_.place(loop.arm.position_rad);
    return truth_.nearest(solids(loop)).clearance_m;
  }

 private:
  sim::Truth truth_{sim::Arm("urdf/lwa3.urdf", "base_link", "tool")};
};

Obstacle& add(ClosedLoop& loop, const Obstacle& obstacle) {
  Obstacle& added = loop.obstacles->obstacles[static_cast<size_t>(loop.obstacles->count)] = obstacle;
  added.id = ++loop.obstacles->count;
  return added;
}

struct Figures {
  double least_m = HUGE_VAL;
  double final_distance_m = 0.0;
};

/// Runs the loop. move(t_s) updates obstacles that do not move on a straight line before every cycle.
template <typename Move>
Figures simulate(ClosedLoop& loop, double duration_s, const Move& move) {
  TrueClearance clearance;
  Figures figures;
  for (double t_s = 0.0; t_s < duration_s; t_s += loop.model.settings.period_s()) {
    move(t_s);
    loop.cycle();
    figures.least_m = std::min(figures.least_m, clearance.measure_m(loop));
  }
  test::check_stream(loop);
  figures.final_distance_m = loop.last.report.target_distance_m;
  return figures;
}

/// The leaf swings about its hinge through the arm's position and back.
void a_swinging_door_never_touches_the_arm(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  const Vector3 hinge(-0.75, -0.75, 0.75);
  const double width_m = 0.7, fastest_radps = 0.8;
  Obstacle& door =
      add(loop, box_obstacle(hinge + Vector3(-0.5 * width_m, 0, 0), Matrix3::Identity(), Vector3(width_m, 0.04, 1.5)));
  const Figures figures = simulate(loop, 8.0, [&](double t_s) {
    const double angle = -1.1 * (1.0 - std::cos(fastest_radps / 1.1 * t_s));
    const double rate_radps = -fastest_radps * std::sin(fastest_radps / 1.1 * t_s);
    const Matrix3 turn = Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
    const Vector3 arm = turn * Vector3(-0.5 * width_m, 0, 0);
    const int32_t id = door.id;
    door = box_obstacle(hinge + arm, turn, Vector3(width_m, 0.04, 1.5));
    door.id = id;
    door.angular_velocity_radps = Vector3(0, 0, rate_radps);
    door.velocity_mps = door.angular_velocity_radps.cross(arm);
  });
  print_message("door: %.1f mm, target missed by %.1f mm\n", figures.least_m * 1e3, figures.final_distance_m * 1e3);
  check(figures.least_m > 0.0, "%g m", figures.least_m);
}

/// The door has two leaves and revolves close to the arm.
void a_revolving_door_never_touches_the_arm(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  for (const double angle : {M_PI / 4, -M_PI / 4}) {
    const Matrix3 turn = Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
    add(loop, box_obstacle(Vector3(-0.75, 0, 1.0), turn, Vector3(1.0, 0.04, 1.2))).angular_velocity_radps =
        Vector3(0, 0, 0.7);
  }
  const Figures figures = simulate(loop, 9.0, [](double) {});
  print_message("revolving door: %.1f mm\n", figures.least_m * 1e3);
  check(figures.least_m > 0.0, "%g m", figures.least_m);
}

/// The person consists of trunk, head and two swinging arms.
void a_person_walking_past_is_never_touched(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  const Vector3 walk(0, 0.6, 0), start(-0.75, -2.0, 0);
  const auto limb = [&](const Vector3& place, double radius_m, double length_m) -> Obstacle& {
    Obstacle& added = add(loop, capsule_obstacle(start + place, Matrix3::Identity(), radius_m, length_m));
    added.velocity_mps = walk;
    return added;
  };
  limb(Vector3(0, 0, 1.0), 0.16, 0.5);
  limb(Vector3(0, 0, 1.55), 0.12, 0.05);
  Obstacle *left = &limb(Vector3(-0.25, 0, 1.0), 0.05, 0.55), *right = &limb(Vector3(0.25, 0, 1.0), 0.05, 0.55);
  const Figures figures = simulate(loop, 7.0, [&](double t_s) {
    const double rate_radps = 1.5 * std::cos(4.0 * t_s);
    left->angular_velocity_radps = Vector3(rate_radps, 0, 0);
    right->angular_velocity_radps = Vector3(-rate_radps, 0, 0);
  });
  print_message("person: %.1f mm, target missed by %.1f mm\n", figures.least_m * 1e3, figures.final_distance_m * 1e3);
  check(figures.least_m > 0.0, "%g m", figures.least_m);
  check(figures.final_distance_m < 0.01, "%g m from the target in the end", figures.final_distance_m);
}

/// No message contains the table. The target is inside it, and the arm comes near it.
void check_table(const char* name, const std::vector<Obstacle>& table) {
  Model model = test::lwa3_model("sidestep");
  model.surroundings = table;
  ClosedLoop loop(model, test::home_rad());
  loop.target.position_m = Vector3(-0.7, 0.1, 0.34);
  loop.sends_target = true;
  const Figures figures = simulate(loop, 6.0, [](double) {});
  print_message("%s: %.1f mm\n", name, figures.least_m * 1e3);
  check(figures.least_m > 0.0, "%g m", figures.least_m);
  check(figures.least_m < 0.03, "the arm never came near the table: %g m", figures.least_m);
}

void a_table_in_the_configuration_is_never_touched(void**) {
  check_table("table", {box_obstacle(Vector3(-0.8, 0, 0.35), Matrix3::Identity(), Vector3(0.7, 1.2, 0.04))});
}

/// A thick disc on a column: an enclosing capsule would keep the arm 0.3 m away from its flat top.
void a_round_table_is_never_touched(void**) {
  check_table("round table", {cylinder_obstacle(Vector3(-0.8, 0, 0.35), Matrix3::Identity(), 0.4, 0.06),
                              cylinder_obstacle(Vector3(-0.8, 0, 0.16), Matrix3::Identity(), 0.05, 0.32)});
}

/// A barrel rolls past on its side, turning about its own axis, and a plate tumbles.
void rolling_and_tumbling_cylinders_never_touch_the_arm(void**) {
  ClosedLoop loop = test::tracking("sidestep");
  const Matrix3 on_its_side = Eigen::AngleAxisd(M_PI / 2, Vector3::UnitY()).toRotationMatrix();
  Obstacle& barrel = add(loop, cylinder_obstacle(Vector3(-0.7, -1.8, 0.6), on_its_side, 0.15, 0.5));
  barrel.velocity_mps = Vector3(0, 0.5, 0);
  barrel.angular_velocity_radps = Vector3(-0.5 / 0.15, 0, 0);
  Obstacle& plate = add(loop, cylinder_obstacle(Vector3(-0.4, 1.6, 0.9), Matrix3::Identity(), 0.2, 0.02));
  plate.velocity_mps = Vector3(0, -0.4, 0);
  plate.angular_velocity_radps = Vector3(0, 1.5, 0);
  const Figures figures = simulate(loop, 8.0, [](double) {});
  print_message("barrel and plate: %.1f mm\n", figures.least_m * 1e3);
  check(figures.least_m > 0.0, "%g m", figures.least_m);
}

/// The arm keeps clear of surroundings from the start, but it does not track before the first obstacle set.
void surroundings_do_not_replace_the_first_obstacle_set(void**) {
  Model model = test::lwa3_model("sidestep");
  model.surroundings = {box_obstacle(Vector3(-0.8, 0, 0.35), Matrix3::Identity(), Vector3(0.7, 1.2, 0.04))};
  model.surroundings[0].id = -2;
  ClosedLoop loop(model, test::home_rad());
  loop.sends_target = true;
  loop.sends_obstacles = false;
  assert_false(loop.run_until(Mode::kTrack, 1.5));
  assert_true(loop.reports("obstacle"));
  assert_int_equal(loop.last.report.nearest_obstacle, -2);
  check(loop.last.report.clearance_m > 0.0 && loop.last.report.clearance_m < 0.2, "%g m", loop.last.report.clearance_m);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_swinging_door_never_touches_the_arm),
      cmocka_unit_test(a_revolving_door_never_touches_the_arm),
      cmocka_unit_test(a_person_walking_past_is_never_touched),
      cmocka_unit_test(a_table_in_the_configuration_is_never_touched),
      cmocka_unit_test(a_round_table_is_never_touched),
      cmocka_unit_test(rolling_and_tumbling_cylinders_never_touch_the_arm),
      cmocka_unit_test(surroundings_do_not_replace_the_first_obstacle_set),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
