#include "host/campaign/problems/problem_files.h"

#include <filesystem>
#include <fstream>

#include "tests/support/check.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using namespace sidestep::campaign;

namespace {

const Arm& panda() {
  static const Arm arm = load_arm("urdf/panda.urdf", "panda_link0", "panda_tool");
  return arm;
}

void objects_and_postures_are_read(void**) {
  const std::vector<Problem> problems = read_problems("tests/data/problems", panda());
  assert_int_equal(problems.size(), 1);
  const Problem& problem = problems[0];
  assert_string_equal(problem.kind.c_str(), "under-table");
  assert_string_equal(problem.name.c_str(), "0001");
  check_near(problem.start_rad[3], -1.6, 0.0);
  check_near(problem.goal_rad[5], 2.4, 0.0);
  check_near(problem.other_positions.at("panda_finger_joint1"), 0.04, 0.0);
  assert_int_equal(problem.obstacles.size(), 4);
  const sim::Obstacle &top = problem.obstacles[0], &can = problem.obstacles[2], &ball = problem.obstacles[3];
  assert_true(top.solid.shape == sim::Shape::kBox);
  check_near(top.solid.size_m, Vector3(0.7, 1.2, 0.03), 0.0);
  assert_true(can.solid.shape == sim::Shape::kCylinder);
  check_near(can.solid.size_m, Vector3(0.03, 0.12, 0.0), 0.0);  // radius, height
  assert_true(ball.solid.shape == sim::Shape::kSphere);
  check_near(ball.motion.position_m, Vector3(0.5, 0.3, 0.5), 1e-12);  // the object's own pose
}

/// A copy of the problem with one text replaced; returns the error.
std::string error_with(const std::string& file, const std::string& from, const std::string& to) {
  const std::filesystem::path folder = test::scratch_folder() + "/problems";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (const auto& entry : std::filesystem::directory_iterator("tests/data/problems/under-table")) {
    std::ifstream in(entry.path());
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (const size_t at = text.find(from); entry.path().filename() == file && at != std::string::npos)
      text.replace(at, from.size(), to);
    std::ofstream(folder / entry.path().filename()) << text;
  }
  return test::message_of([&] { read_problems(folder.string(), panda()); });
}

void what_cannot_be_played_is_named_with_its_file(void**) {
  const struct {
    std::string file, from, to, word;
  } cases[] = {
      {"scene0001.yaml", "type: box", "type: cone", "'cone'"},
      {"scene0001.yaml", "      primitives", "      meshes: [{}]\n      primitives", "'top' is a mesh"},
      {"scene0001.yaml", "[0.77, 0.0, 0.45]", "[0.77, oops, 0.45]", ""},
      {"request0001.yaml", "joint_name: panda_joint4", "joint_name: other", "panda_joint4"},
      {"request0001.yaml", "goal_constraints", "constraints", "goal"},
  };
  for (const auto& one : cases) {
    const std::string message = error_with(one.file, one.from, one.to);
    check(test::one_line_with(message, {one.file, one.word}), "%s -> %s: '%s'", one.from.c_str(), one.to.c_str(),
          message.c_str());
  }
  assert_true(test::one_line_with(test::message_of([] { read_problems("nowhere", panda()); }), {"nowhere"}));
  assert_true(test::one_line_with(test::message_of([] { read_problems("lcmtypes", panda()); }), {"scene<number>"}));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(objects_and_postures_are_read),
      cmocka_unit_test(what_cannot_be_played_is_named_with_its_file),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
