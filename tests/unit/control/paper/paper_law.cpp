#include "firmware/control/paper/paper_law.h"

#include <cstdio>
#include <map>
#include <memory>
#include <sstream>
#include <vector>

#include "tests/support/check.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::home_rad;
using test::lwa3;

namespace {

constexpr double kPeriod_s = 0.01;

/// One row of `paper_law.py cases`, by column name.
class Case {
 public:
  Case(const std::vector<std::string>& names, const std::string& line) {
    std::istringstream fields(line);
    std::string field;
    for (const std::string& name : names)
      if (std::getline(fields, field, ',')) text_[name] = field;
  }

  std::string word(const std::string& name) const {
    const auto at = text_.find(name);
    check(at != text_.end(), "no column '%s'", name.c_str());
    return at->second;
  }
  double number(const std::string& name) const { return std::strtod(word(name).c_str(), nullptr); }
  JointVector joints(const std::string& prefix) const {
    JointVector values(7);
    for (int i = 0; i < 7; ++i) values[i] = number(prefix + std::to_string(i + 1));
    return values;
  }
  Vector3 vector(const std::string& prefix) const {
    return Vector3(number(prefix + "x"), number(prefix + "y"), number(prefix + "z"));
  }

 private:
  std::map<std::string, std::string> text_;
};

/// Random cases with the results of an independent NumPy program.
std::vector<Case> numpy_cases(const std::string& arguments) {
  const std::string command = "build/venv/bin/python tests/support/paper_law.py cases " + arguments;
  FILE* output = popen(command.c_str(), "r");
  check(output != nullptr, "%s", command.c_str());
  std::string text;
  char buffer[65536];
  while (const size_t length = fread(buffer, 1, sizeof buffer, output)) text.append(buffer, length);
  check(pclose(output) == 0, "%s failed", command.c_str());

  std::istringstream lines(text);
  std::string line, name;
  std::getline(lines, line);
  std::istringstream header(line);
  std::vector<std::string> names;
  while (std::getline(header, name, ',')) names.push_back(name);
  std::vector<Case> cases;
  while (std::getline(lines, line)) cases.emplace_back(names, line);
  return cases;
}

/// The inputs of the law; nominal() evaluates it.
class Scene {
 public:
  Scene() : obstacles_(std::make_unique<ObstacleSet>()) {}

  JointVector q_rad = home_rad(), qd_radps = JointVector::Zero(7);
  Target target;
  PaperGains gains;
  Proximity nearest_axis;

  void add_sphere(const Vector3& position_m, const Vector3& velocity_mps) {
    Obstacle& obstacle = obstacles_->obstacles[static_cast<size_t>(obstacles_->count++)];
    obstacle.capsule = {position_m, position_m, 0.05};
    obstacle.velocity_mps = velocity_mps;
  }

  NominalCommand nominal(const std::optional<Vector3>& planned_mps = {}) {
    const LinkPoses poses = forward_kinematics(lwa3(), q_rad);
    const ObstacleView view{obstacles_->count > 0 ? obstacles_.get() : nullptr, 0.0, 0.0};
    const Clearance clearance = measure_clearance(lwa3(), poses, view, {0.4, 0.0});
    nearest_axis = clearance.nearest_axis;
    const TaskJacobian jacobian = tool_jacobian(poses, target.tracks_orientation ? 6 : 3);
    return paper_law(gains, kPeriod_s,
                     {lwa3(), poses, jacobian, q_rad, qd_radps, target, view, clearance, test::any_velocity()},
                     planned_mps);
  }

 private:
  std::unique_ptr<ObstacleSet> obstacles_;
};

void law_agrees_with_the_numpy_program(void**) {
  const std::vector<Case> cases = numpy_cases("--seed 20240 --count 1600");
  assert_int_equal(cases.size(), 1600);
  std::map<std::string, int> kinds;
  double worst = 0.0;
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    Scene scene;
    scene.q_rad = one.joints("q");
    scene.qd_radps = one.joints("qd");
    scene.target.position_m = one.vector("target_");
    scene.target.velocity_mps = one.vector("target_v");
    scene.target.tracks_orientation = one.number("tracks_orientation") != 0;
    scene.target.orientation =
        Quaternion(one.number("target_qw"), one.number("target_qx"), one.number("target_qy"), one.number("target_qz"));
    scene.target.angular_velocity_radps = one.vector("target_w");
    for (int o = 1; o <= static_cast<int>(one.number("obstacles")); ++o) {
      const std::string prefix = "o" + std::to_string(o) + "_";
      scene.add_sphere(one.vector(prefix), one.vector(prefix + "v"));
    }
    const bool planned = one.number("planned") != 0;
    scene.gains.tool_velocity = planned ? ToolVelocity::kPlanned : ToolVelocity::kMeasured;
    const Vector3 planned_mps = one.vector("planned_v");

    const NominalCommand command = scene.nominal(planned ? std::optional<Vector3>(planned_mps) : std::nullopt);
    const std::string kind = one.word("kind");
    const JointVector expected = one.joints("expect_qd");
    const double tolerance = 1e-9 * std::max(1.0, expected.norm());
    check_near_because(command.velocity_radps, expected, tolerance, "case %zu, %s", i, kind.c_str());
    check_near_because(command.tool_velocity_mps, one.vector("expect_v"), 1e-10, "case %zu, %s", i, kind.c_str());
    check_near_because(command.beta, one.number("expect_beta"), 1e-10, "case %zu, %s", i, kind.c_str());
    check_near_because(command.damping, one.number("expect_damping"), 1e-9, "case %zu, %s", i, kind.c_str());
    const double d_0_m = one.number("expect_axis_distance");
    if (d_0_m >= 0)
      check_near_because(scene.nearest_axis.axis_distance_m, d_0_m, 1e-12, "case %zu, %s", i, kind.c_str());
    worst = std::max(worst, test::gap(command.velocity_radps, expected));
    ++kinds[kind];
  }
  check(kinds.size() >= 16, "%zu kinds of case", kinds.size());
  print_message("largest difference of %zu cases: %.1e rad/s\n", cases.size(), worst);
}

void at_the_target_without_obstacles_the_arm_rests(void**) {
  Scene scene;
  scene.target.position_m = forward_kinematics(lwa3(), home_rad()).tool_position;
  const NominalCommand command = scene.nominal();
  check_near(command.velocity_radps, JointVector::Zero(7), 0);
  check_near(command.beta, 0.0, 0);
  assert_false(command.task_speed_limited);
}

/// X = V + F T: in the first cycle from rest a target 0.1 m away gives k_pos * 0.1 * T.
void force_becomes_velocity_over_one_period(void**) {
  Scene scene;
  scene.q_rad[0] = 0.3;
  const Vector3 tool_m = forward_kinematics(lwa3(), scene.q_rad).tool_position;
  scene.target.position_m = tool_m + Vector3(0, 0.1, 0);
  check_near(scene.nominal().tool_velocity_mps, Vector3(0, 20.0 * 0.1 * kPeriod_s, 0), 1e-12);
}

void planned_velocity_replaces_only_the_first_term(void**) {
  Scene scene;
  scene.target.position_m = forward_kinematics(lwa3(), home_rad()).tool_position + Vector3(0.05, 0, 0);
  scene.qd_radps = JointVector::Constant(7, 0.1);
  const Vector3 v_tool = tool_jacobian(forward_kinematics(lwa3(), home_rad()), 3) * scene.qd_radps;
  const Vector3 planned_mps(0.1, -0.2, 0.3);
  const NominalCommand measured = scene.nominal(planned_mps);  // tool_velocity is measured: planned_mps is not used
  scene.gains.tool_velocity = ToolVelocity::kPlanned;
  const NominalCommand planned = scene.nominal(planned_mps), first = scene.nominal();
  check_near(planned.tool_velocity_mps - planned_mps, measured.tool_velocity_mps - v_tool, 1e-12);
  check_near(first.tool_velocity_mps, measured.tool_velocity_mps, 0);
}

void tool_speed_is_clipped_and_keeps_its_direction(void**) {
  Scene scene;
  const Vector3 tool_m = forward_kinematics(lwa3(), home_rad()).tool_position, away(2, 3, 6);
  scene.target.position_m = tool_m + 100 * away;
  const NominalCommand command = scene.nominal();
  assert_true(command.task_speed_limited);
  check_near(command.tool_velocity_mps, Vector3(away.normalized() * scene.gains.v_max_mps), 1e-9);
}

void velocity_is_finite_where_the_formulas_are_zero_over_zero(void**) {
  const LinkPoses home = forward_kinematics(lwa3(), home_rad());
  const Vector3 centres[] = {home.tool_position, home.origin[3], home.origin[5],
                             0.5 * (home.origin[5] + home.tool_position)};
  for (const Vector3& centre : centres) {
    for (const bool with_orientation : {false, true}) {
      for (const Vector3& velocity : {Vector3(0, 0, 0), Vector3(0.3, 0, 0), Vector3(0, 0, -0.5)}) {
        Scene scene;
        scene.target.position_m = home.tool_position;
        scene.target.tracks_orientation = with_orientation;
        scene.add_sphere(centre, velocity);
        const NominalCommand command = scene.nominal();
        check(command.velocity_radps.allFinite(), "obstacle at %g %g %g", centre.x(), centre.y(), centre.z());
        check(command.velocity_radps.norm() < 20.0, "%g rad/s", command.velocity_radps.norm());
        check_near(command.beta, 1.0, 0);
      }
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(law_agrees_with_the_numpy_program),
      cmocka_unit_test(at_the_target_without_obstacles_the_arm_rests),
      cmocka_unit_test(force_becomes_velocity_over_one_period),
      cmocka_unit_test(planned_velocity_replaces_only_the_first_term),
      cmocka_unit_test(tool_speed_is_clipped_and_keeps_its_direction),
      cmocka_unit_test(velocity_is_finite_where_the_formulas_are_zero_over_zero),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
