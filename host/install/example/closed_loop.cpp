// A closed loop in one process: the controller, an arm that follows its commands without delay, a moving target and
// three obstacles.
#include <sidestep.h>

#include <cstdio>
#include <exception>
#include <vector>

using sidestep::Controller;

namespace {

constexpr int kCycles = 600;

// A sphere that crosses the tool's path, a post and a shelf.
std::vector<Controller::Obstacle> world_at(double t_s) {
  Controller::Obstacle sphere, post, shelf;
  sphere.id = 1;
  sphere.position_m = {0.3 - 0.1 * t_s, 0.2, 0.8};
  sphere.velocity_mps = {-0.1, 0.0, 0.0};
  sphere.size_m = {0.05};
  post.id = 2;
  post.shape = Controller::Shape::kCapsule;
  post.position_m = {0.5, 0.0, 0.5};
  post.size_m = {0.05, 0.8};
  shelf.id = 3;
  shelf.shape = Controller::Shape::kBox;
  shelf.position_m = {0.0, 0.8, 0.3};
  shelf.size_m = {1.0, 0.2, 0.04};
  return {sphere, post, shelf};
}

int run(const char* config) {
  Controller controller(config, Controller::Foresight::kWithinStep);
  const double dt_s = controller.period_s();
  Controller::ArmState arm;
  arm.position_rad = {0.0, 1.57, 0.0, -1.57, 0.0, 0.0, 0.0};
  Controller::Target target;
  target.position_m = {-0.1, 0.4, 0.7};
  target.velocity_mps = {0.02, 0.0, 0.0};

  double least_clearance_m = 1e9;
  Controller::Result result;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    const double t_s = cycle * dt_s;
    const std::vector<Controller::Obstacle> world = world_at(t_s);
    controller.set_obstacles(world.data(), static_cast<int>(world.size()), t_s);
    controller.set_target(target, t_s);
    result = controller.step(arm, t_s);
    if (result.clearance_m < least_clearance_m) least_clearance_m = result.clearance_m;

    for (int i = 0; i < controller.joints(); ++i) {
      arm.velocity_radps[i] = result.commanding ? result.velocity_radps[i] : 0.0;
      arm.position_rad[i] += arm.velocity_radps[i] * dt_s;
    }
    target.position_m[0] += target.velocity_mps[0] * dt_s;
  }
  std::printf("%s; target %.1f mm away, least clearance %.0f mm\n", result.message, 1e3 * result.target_distance_m,
              1e3 * least_clearance_m);
  return result.target_distance_m < 0.01 && least_clearance_m > 0.0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: closed_loop CONFIG, for example /usr/share/sidestep/config/lwa3.yaml\n");
    return 2;
  }
  try {
    return run(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "closed_loop: %s\n", error.what());
    return 2;
  }
}
