// CPU time of step() among moving spheres, compared with the baseline and with distance only (baseline.h), and of a
// Panda with meshes, also with its hand in a shelf; and of the tree planner in furniture. The argument is the URDF of
// that Panda; without one it is left out.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numeric>

#include "firmware/base/realtime.h"
#include "firmware/io/config/config.h"
#include "tests/bench/baseline.h"
#include "tests/bench/planning.h"
#include "tests/support/closed_loop.h"
#include "tests/support/lwa3.h"
#include "tests/support/random.h"

using namespace sidestep;

namespace {

constexpr double kLargestSpeed_mps = 0.3;
constexpr double kTargetRate_radps = 0.5;
constexpr int kCalls = 5;         // between two readings of the clock, which take as long as a small cycle
constexpr int kRepeats = 2;       // of these calls; the least time counts
constexpr int kStartCycles = 60;  // until the controller tracks
constexpr int kPlanningScenes = 20;

struct Box {
  Vector3 lower, upper;
};
const Box kWorkspace{Vector3(-1, -1, 0), Vector3(1, 1, 1.3)};
const Box kRoom{Vector3(-5, -5, 0), Vector3(5, 5, 3)};

/// An arm in tracking, whose target moves on a vertical circle.
struct Bench {
  Model model;
  JointVector start_rad;
  Vector3 centre_m;
  double radius_m;
};

struct Scene {
  const char* place;
  int spheres;
  const Box& box;
  int cycles;
};

Bench lwa3(const char* law) {
  return {test::lwa3_model(law), test::home_rad(), Vector3(-0.35, 0.0, 0.8), 0.15};
}

/// In its start configuration the hand is between the boards of add_shelf(), and the target moves there.
Bench panda(const std::string& urdf) {
  Bench bench{load_config("firmware/config/panda.yaml", {"sidestep", urdf, "panda_link0", "panda_hand"}).model,
              JointVector(7), Vector3::Zero(), 0.02};
  bench.start_rad << 0.9145, 0.5576, -1.1004, -1.5147, 2.7787, 2.8490, -1.5134;
  bench.centre_m = forward_kinematics(bench.model.arm, bench.start_rad).tool_position;
  return bench;
}

double cpu_us() {
  return 1e6 * thread_cpu_s();
}

/// CPU time of one call.
template <typename Call>
double least_us(const Call& call) {
  double least = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const double before_us = cpu_us();
    for (int i = 0; i < kCalls; ++i) call();
    least = std::min(least, (cpu_us() - before_us) / kCalls);
  }
  return least;
}

/// Sums the CPU time of each stage of step(), without the time of reading the clock.
class StageTimes : public StageProbe {
 public:
  StageTimes() {
    for (int i = 0; i < 1000; ++i) clock_us_ = std::min(clock_us_, least_us(&cpu_us));
  }
  void start() { before_us_ = cpu_us(); }
  void passed(Stage stage) override {
    const double now_us = cpu_us();
    sum_us_[static_cast<size_t>(stage)] += now_us - before_us_ - clock_us_;
    before_us_ = now_us;
  }
  double share(Stage stage) const {
    return sum_us_[static_cast<size_t>(stage)] / std::accumulate(sum_us_.begin(), sum_us_.end(), 0.0);
  }

 private:
  double clock_us_ = std::numeric_limits<double>::infinity(), before_us_ = 0.0;
  std::array<double, kStages> sum_us_{};
};

/// One value for every cycle.
struct Values {
  std::vector<double> all;

  double at(double share) {
    std::sort(all.begin(), all.end());
    return all[static_cast<size_t>(share * static_cast<double>(all.size() - 1))];
  }
  double mean() const { return std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size()); }
};

void print(const Scene& scene, const char* computation, Values& us) {
  std::printf("%-11s %5d  %-13s %9.2f %9.2f %9.2f %9.2f", scene.place, scene.spheres, computation, us.at(0.5),
              us.mean(), us.at(0.99), us.at(1.0));
}

void scatter(const Scene& scene, test::ClosedLoop& loop) {
  test::Random random(static_cast<unsigned>(scene.spheres));
  const Vector3 size_m = scene.box.upper - scene.box.lower;
  for (int i = 0; i < scene.spheres; ++i) {
    const Vector3 position_m = scene.box.lower + size_m.cwiseProduct(random.inside(0, 1));
    loop.add_sphere(position_m, random.uniform(0, kLargestSpeed_mps) * random.direction());
  }
}

/// A shelf of seven boards with two cans, at rest.
void add_shelf(test::ClosedLoop& loop) {
  const auto add = [&loop](const Obstacle& obstacle) {
    loop.obstacles->obstacles[static_cast<size_t>(loop.obstacles->count)] = obstacle;
    loop.obstacles->obstacles[static_cast<size_t>(loop.obstacles->count)].id = loop.obstacles->count;
    ++loop.obstacles->count;
  };
  const auto add_board = [&add](const Vector3& centre_m, const Vector3& edges_m) {
    add(box_obstacle(centre_m, Matrix3::Identity(), edges_m));
  };
  for (const double height_m : {0.05, 0.35, 0.75, 1.05}) add_board({0.85, 0, height_m}, {0.4, 0.8, 0.02});
  for (const double side_m : {-0.41, 0.41}) add_board({0.85, side_m, 0.55}, {0.4, 0.02, 1.0});
  add_board({1.04, 0, 0.55}, {0.02, 0.8, 1.0});
  for (const double side_m : {-0.2, 0.2})
    add(cylinder_obstacle({0.84, side_m, 0.43}, Matrix3::Identity(), 0.035, 0.14));
}

void bounce(const Box& box, ObstacleSet& spheres) {
  for (int i = 0; i < spheres.count; ++i) {
    Obstacle& sphere = spheres.obstacles[static_cast<size_t>(i)];
    for (int axis = 0; axis < 3; ++axis) {
      double& speed_mps = sphere.velocity_mps[axis];
      if (sphere.capsule.start[axis] < box.lower[axis]) speed_mps = std::abs(speed_mps);
      if (sphere.capsule.start[axis] > box.upper[axis]) speed_mps = -std::abs(speed_mps);
    }
  }
}

void lead_target(const Bench& bench, double now_s, Target& target) {
  const double phase = kTargetRate_radps * now_s;
  target.position_m = bench.centre_m + bench.radius_m * Vector3(0, std::cos(phase), std::sin(phase));
  target.velocity_mps = bench.radius_m * kTargetRate_radps * Vector3(0, -std::sin(phase), std::cos(phase));
}

struct Measured {
  Values distance_only_us, baseline_us, step_us;
  Values times_distance_only, times_baseline;  ///< ratios within one cycle, in which the machine's speed is the same
  StageTimes stages;
};

/// Runs a closed loop with an ideal arm; every cycle has new messages. Without spheres the arm is in the shelf.
Measured measure(const Scene& scene, const Bench& bench) {
  test::ClosedLoop loop(bench.model, bench.start_rad);
  loop.sends_target = true;
  if (scene.spheres > 0)
    scatter(scene, loop);
  else
    add_shelf(loop);
  Measured measured;
  bench::DistanceOnlyCycle distance_only;
  bench::BaselineCycle baseline;
  for (int cycle = -kStartCycles; cycle < scene.cycles; ++cycle) {
    bounce(scene.box, *loop.obstacles);
    lead_target(bench, loop.now_s(), loop.target);
    const Inputs inputs = loop.receive();
    Result result;
    const auto time_us = [&](auto& computation) {
      return least_us([&] {
        computation.run(loop.model, loop.arm.position_rad, *inputs.obstacles.message, loop.target.position_m);
      });
    };
    const double distance_only_us = time_us(distance_only), baseline_us = time_us(baseline);
    const double step_us = least_us([&] { result = step(loop.model, loop.state, inputs, loop.now_s()); });
    if (cycle >= 0) {
      measured.distance_only_us.all.push_back(distance_only_us);
      measured.baseline_us.all.push_back(baseline_us);
      measured.step_us.all.push_back(step_us);
      measured.times_distance_only.all.push_back(step_us / distance_only_us);
      measured.times_baseline.all.push_back(step_us / baseline_us);
      measured.stages.start();
      step(loop.model, loop.state, inputs, loop.now_s(), &measured.stages);
    }
    loop.follow(result);
  }
  return measured;
}

void print_scene(const Scene& scene) {
  Measured paper = measure(scene, lwa3("paper")), sidestep = measure(scene, lwa3("sidestep"));
  print(scene, "distance only", sidestep.distance_only_us);
  std::printf("\n");
  print(scene, "baseline", sidestep.baseline_us);
  std::printf("\n");
  print(scene, "paper", paper.step_us);
  std::printf("\n");
  print(scene, "sidestep", sidestep.step_us);
  const auto percent = [&](Stage stage) { return 100.0 * sidestep.stages.share(stage); };
  std::printf("  %11.2f / %5.2f  %6.2f / %5.2f  %3.0f / %3.0f / %3.0f\n", sidestep.times_distance_only.at(0.5),
              sidestep.times_distance_only.mean(), sidestep.times_baseline.at(0.5), sidestep.times_baseline.mean(),
              percent(Stage::kClearance), percent(Stage::kLaw), percent(Stage::kShield));
  std::fflush(stdout);
}

/// Spheres cross the whole reach of the arm, also the base of it, and touch it there: what counts is the cost.
void print_panda(const std::string& urdf) {
  std::printf("Panda with meshes\n");
  const Bench bench = panda(urdf);
  for (const Scene& scene : {Scene{"in reach", 10, kWorkspace, 2000}, Scene{"in reach", 50, kWorkspace, 2000},
                             Scene{"in a shelf", 0, kWorkspace, 2000}}) {
    Measured measured = measure(scene, bench);
    print(scene, "sidestep", measured.step_us);
    std::printf("\n");
    std::fflush(stdout);
  }
}

void print_planning() {
  std::printf("CPU time of the first guide in furniture, %d scenes of each family, ms\n", kPlanningScenes);
  for (const std::string arm : {"lwa3", "panda"}) {
    Values ms{bench::first_guides_ms("firmware/config/" + arm + ".yaml", kPlanningScenes)};
    std::printf("%-17s  %-13s %9.2f %9.2f %9.2f %9.2f\n", arm.c_str(), "tree planner", ms.at(0.5), ms.mean(),
                ms.at(0.99), ms.at(1.0));
    std::fflush(stdout);
  }
}

int run(int argc, char** argv) {
  std::printf("CPU time of a hot step, us; ratios of step() as median / mean\n");
  std::printf("%-11s %5s  %-13s %9s %9s %9s %9s  %19s  %14s  %s\n", "spheres", "", "", "median", "mean", "p99", "max",
              "times distance only", "times baseline", "clearance / law / shield, %");
  for (const int spheres : {10, 50, 500, 4096}) {
    const int cycles = spheres <= 50 ? 4000 : 300;
    print_scene({"in the room", spheres, kRoom, cycles});
    print_scene({"in reach", spheres, kWorkspace, cycles});
  }
  if (argc > 1) print_panda(argv[1]);
  print_planning();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench: %s\n", error.what());
    return 2;
  }
}
