// Braking in clutter: from many moments of tracking, does a stop for any reason touch what tracking on would not have
// touched? BRAKE_SCENES: how many scenes from the one with the number FIRST_SCENE on. Default: the five of kScenes.
#include <cstdlib>
#include <numeric>

#include "firmware/model/prediction.h"
#include "firmware/model/proximity.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

double true_clearance_m(const ClosedLoop& loop, const JointVector& q_rad, double after_s = 0.0) {
  const ObstacleSet& set = *loop.obstacles;
  return clearance_after(loop.model.arm, forward_kinematics(loop.model.arm, q_rad), set.obstacles.data(), set.count,
                         after_s, 0.5);
}

bool keeps_clear_of_itself(const Model& model, const JointVector& q_rad) {
  const LinkPoses poses = forward_kinematics(model.arm, q_rad);
  const auto link = [&](int shape) { return transformed(poses, model.arm.shapes[static_cast<size_t>(shape)]); };
  for (const SelfPair& pair : model.self_pairs)
    if (measure_pair(link(pair.first), link(pair.second)).distance_m < 0.03) return false;
  return true;
}

JointVector random_configuration(const Model& model, Random& random) {
  JointVector q_rad = random.configuration(model.arm, 0.8);
  while (!keeps_clear_of_itself(model, q_rad)) q_rad = random.configuration(model.arm, 0.8);
  return q_rad;
}

Obstacle random_obstacle(Random& random) {
  Vector3 centre = random.inside(-0.9, 0.9);
  while (centre.head<2>().norm() < 0.25) centre = random.inside(-0.9, 0.9);
  centre.z() = random.uniform(-0.2, 1.2);
  const Matrix3 rotation = random.turn().toRotationMatrix();
  if (random.chance(0.5)) return sphere_obstacle(centre, random.uniform(0.03, 0.12));
  if (random.chance(0.5)) return capsule_obstacle(centre, rotation, 0.04, random.uniform(0.1, 0.5));
  const Vector3 edges = random.inside(0.05, 0.4);
  return box_obstacle(centre, rotation, edges);
}

/// Clutter around a tracking arm. In every other scene the obstacles move, at up to 0.5 m/s.
ClosedLoop cluttered(const Model& model, int scene) {
  Random random(static_cast<unsigned>(scene));
  ClosedLoop loop(model, random_configuration(model, random));
  const int wanted = 3 + random.index(10);
  for (int tries = 0; loop.obstacles->count < wanted && tries < 5000; ++tries) {
    Obstacle& obstacle = loop.obstacles->obstacles[static_cast<size_t>(loop.obstacles->count)];
    obstacle = random_obstacle(random);
    obstacle.id = loop.obstacles->count;
    if (scene % 2) obstacle.velocity_mps = random.direction() * random.uniform(0.0, 0.5);
    ++loop.obstacles->count;
    if (true_clearance_m(loop, loop.arm.position_rad) < 0.06) --loop.obstacles->count;
  }
  loop.sends_target = true;
  loop.target.position_m = forward_kinematics(model.arm, loop.arm.position_rad).tool_position;
  loop.run(0.7);
  return loop;
}

void new_target(ClosedLoop& loop, Random& random) {
  const LinkPoses goal = forward_kinematics(loop.model.arm, random_configuration(loop.model, random));
  loop.target.position_m = goal.tool_position;
  loop.target.tracks_orientation = random.chance(0.3);
  loop.target.orientation = Quaternion(goal.tool_rotation);
}

/// What becomes of the arm from one moment on.
struct Course {
  const char* name;
  bool sends_arm_state, sends_target, sends_obstacles;
  bool stop;
  bool ends_at_rest;  ///< a resting arm without inputs cannot evade any more, and a stopped process ends
  int skipped;
  double foreign_command_after_s;
};
constexpr double kNever_s = 1e9;
constexpr Course kTrackOn{"tracking on", true, true, true, false, false, 0, kNever_s};
constexpr Course kStops[] = {
    {"asked to stop", true, true, true, true, true, 0, kNever_s},
    {"silent arm state", false, true, true, false, true, 0, kNever_s},
    {"silent obstacles", true, true, false, false, true, 0, kNever_s},
    {"silent target", true, false, true, false, false, 0, kNever_s},
    {"foreign command", true, true, true, false, false, 0, 0.0},
    {"skipped cycles", true, true, true, false, false, 3, kNever_s},
};

struct Outcome {
  double least_m = 0.5;
  double least_after_s = 0.0;
  double rest_s = kNever_s;  ///< until every joint rests
};

/// Least clearance on this course, in the next 1.5 s unless said otherwise. The arm is ideal; without commands it stops
/// at once.
Outcome follow(const ClosedLoop& loop, const Course& course, const ObstacleSet& reported, ObstacleSet& now,
               int cycles = 150) {
  const Model& model = loop.model;
  const double period_s = model.settings.period_s(), start_s = loop.now_s();
  State state = loop.state;
  ArmState arm = loop.arm, sent_arm = loop.arm;
  Inputs inputs{};
  inputs.arm = {&sent_arm, start_s, state.arm_monitor.count};
  inputs.target = {&loop.target, start_s, 1000000};
  inputs.obstacles = {&reported, start_s, 1000000};
  now.count = reported.count;
  Outcome outcome;
  for (int k = 1; k <= cycles; ++k) {
    const double after_s = k * period_s, now_s = start_s + after_s;
    if (course.sends_arm_state) {
      sent_arm = arm;
      sent_arm.utime = std::llround(now_s * 1e6);
      inputs.arm = {&sent_arm, now_s, state.arm_monitor.count + 1};
    }
    if (course.sends_target) inputs.target = {&loop.target, now_s, 1000000 + k};
    if (course.sends_obstacles) {
      for (int i = 0; i < now.count; ++i) {
        const auto index = static_cast<size_t>(i);
        now.obstacles[index] = extrapolated(reported.obstacles[index], after_s);
      }
      inputs.obstacles = {&now, now_s, 1000000 + k};
    }
    inputs.stop = course.stop;
    inputs.skipped_cycles = k == 1 ? course.skipped : course.skipped > 0 ? 1 : 0;
    if (course.foreign_command_after_s < kNever_s) inputs.foreign_command_s = start_s;
    const Result result = step(model, state, inputs, now_s);
    state = result.next;
    arm.velocity_radps = result.commanding ? result.command.velocity_radps : JointVector::Zero(model.arm.joints).eval();
    arm.position_rad += arm.velocity_radps * period_s;
    const double clear_m = true_clearance_m(loop, arm.position_rad, after_s);
    if (clear_m < outcome.least_m) outcome.least_after_s = after_s;
    outcome.least_m = std::min(outcome.least_m, clear_m);
    if (arm.velocity_radps.isZero(0.0)) outcome.rest_s = std::min(outcome.rest_s, after_s);
    if (course.ends_at_rest && outcome.rest_s < kNever_s) break;
  }
  return outcome;
}

/// Tracking on is followed 0.1 s longer than the stops: a collision at the end of a stop's 1.5 s is no other one where
/// tracking on has it a few cycles later.
constexpr int kTrackOnCycles = 160;

/// Braking each joint as fast as it can touches something in the second. In the third a link turns toward a box after
/// braking, which hard rows for the nearest points alone do not prevent. In the fourth a box falls through the place
/// where an arm that stops within 0.4 s rests. In the fifth a ball follows the arm to the limit of a joint, and only an
/// evasion with several joints at their bounds gets away.
constexpr int kScenes[] = {6173, 6174, 6201, 9103, 12241};

std::vector<int> scenes_to_run() {
  const char *first = std::getenv("FIRST_SCENE"), *count = std::getenv("BRAKE_SCENES");
  if (!first || !count) return {std::begin(kScenes), std::end(kScenes)};
  std::vector<int> scenes(static_cast<size_t>(std::atoi(count)));
  std::iota(scenes.begin(), scenes.end(), std::atoi(first));
  return scenes;
}

void a_stop_touches_nothing_that_tracking_on_would_not(void**) {
  Model model = test::lwa3_model("sidestep");
  const auto now = std::make_unique<ObstacleSet>();
  int starts = 0;
  std::array<int, std::size(kStops)> contacts{}, below{};
  std::array<double, std::size(kStops)> least_m{}, slowest_s{};
  least_m.fill(1.0);
  for (const int scene : scenes_to_run()) {
    ClosedLoop loop = cluttered(model, scene);
    Random random(static_cast<unsigned>(scene) + 1000000);
    for (int k = 0; k < 1200; ++k) {
      if (k % 60 == 0) new_target(loop, random);
      loop.cycle();
      if (loop.mode() != Mode::kTrack || loop.arm.velocity_radps.cwiseAbs().maxCoeff() < 0.5) continue;
      if (true_clearance_m(loop, loop.arm.position_rad) < 0.0) continue;
      ++starts;
      std::array<Outcome, std::size(kStops)> outcomes;
      bool touched = false;
      for (size_t i = 0; i < std::size(kStops); ++i) {
        outcomes[i] = follow(loop, kStops[i], *loop.obstacles, *now);
        least_m[i] = std::min(least_m[i], outcomes[i].least_m);
        if (outcomes[i].rest_s < kNever_s) slowest_s[i] = std::max(slowest_s[i], outcomes[i].rest_s);
        below[i] += outcomes[i].least_m < 0.01;
        touched |= outcomes[i].least_m < 0.0;
      }
      if (!touched || follow(loop, kTrackOn, *loop.obstacles, *now, kTrackOnCycles).least_m < 0.0) continue;
      for (size_t i = 0; i < std::size(kStops); ++i) {
        if (outcomes[i].least_m >= 0.0) continue;
        ++contacts[i];
        print_message("scene %d, cycle %d, %s: %.1f mm after %.2f s\n", scene, k, kStops[i].name,
                      1e3 * outcomes[i].least_m, outcomes[i].least_after_s);
      }
    }
  }
  int all = 0;
  for (size_t i = 0; i < std::size(kStops); ++i) {
    print_message("%-18s %d starts, %d contacts, %d below 10 mm, least %.1f mm, longest stop %.2f s\n", kStops[i].name,
                  starts, contacts[i], below[i], 1e3 * least_m[i], slowest_s[i]);
    all += contacts[i];
  }
  assert_true(starts > 0);
  assert_int_equal(all, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_stop_touches_nothing_that_tracking_on_would_not),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
