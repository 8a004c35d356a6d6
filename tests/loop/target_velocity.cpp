#include <algorithm>

#include "firmware/model/nearest_points.h"
#include "firmware/model/prediction.h"
#include "tests/support/check.h"
#include "tests/support/closed_loop.h"
#include "tests/support/random.h"

using namespace sidestep;
using test::ClosedLoop;
using test::Random;

namespace {

constexpr double kWay_m = 0.9;  // from the sphere's start to the link that it would hit
constexpr double kRadius_m = 0.05;

double clearance_m(const ClosedLoop& loop) {
  const LinkPoses poses = forward_kinematics(loop.model.arm, loop.arm.position_rad);
  return clearance_after(loop.model.arm, poses, loop.obstacles->obstacles.data(), loop.obstacles->count, 0.0, 1.0);
}

/// A sphere flies at 1 m/s toward a random link of an arm at rest at its target, which claims velocities of these norms
/// in random directions. Returns the least clearance; infinity for a scene without a fair chance: the sphere starts
/// near the arm or passes the base.
double least_clearance_m(const Model& model, unsigned seed, const Target& claimed) {
  Random random(seed);
  ClosedLoop loop(model, random.configuration(model.arm, 0.7));
  const LinkPoses poses = forward_kinematics(model.arm, loop.arm.position_rad);
  const LinkShape& shape = model.arm.shapes[static_cast<size_t>(1 + random.index(3))];
  const Capsule link = transformed(poses, shape);
  const Vector3 hit = link.start + random.uniform(0, 1) * (link.end - link.start), direction = random.direction();
  loop.target.position_m = poses.tool_position;
  loop.target.tracks_orientation = claimed.tracks_orientation;
  loop.target.orientation = Quaternion(poses.tool_rotation);
  loop.sends_target = true;
  loop.run(0.6);
  loop.add_sphere(hit - direction * kWay_m, direction, kRadius_m);
  const Vector3 past = hit + 2.0 * direction, base_top(0, 0, 0.3);
  const Vector3 nearest = nearest_on_segment((hit - direction * kWay_m).eval(), past, (0.5 * base_top).eval());
  if (clearance_m(loop) < 0.05 || (nearest - 0.5 * base_top).norm() < 0.4) return HUGE_VAL;
  const Vector3 lie = random.direction(), turning_lie = random.direction();
  double least_m = HUGE_VAL;
  const Vector3 rests = loop.target.position_m;
  for (int cycle = 0; cycle < 190; ++cycle) {
    loop.target.position_m = rests;
    loop.target.orientation = Quaternion(poses.tool_rotation);
    loop.target.velocity_mps = claimed.velocity_mps.norm() * lie;
    loop.target.angular_velocity_radps = claimed.angular_velocity_radps.norm() * turning_lie;
    loop.cycle();
    least_m = std::min(least_m, clearance_m(loop));
  }
  test::check_stream(loop);
  return least_m;
}

void a_target_that_claims_any_velocity_does_not_outweigh_evading(void**) {
  const Model model = test::lwa3_model("sidestep");
  for (const bool pose : {false, true}) {
    Target claimed;
    claimed.tracks_orientation = pose;
    claimed.velocity_mps = Vector3(100, 0, 0);
    if (pose) claimed.angular_velocity_radps = Vector3(100, 0, 0);
    int scenes = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      const double least_m = least_clearance_m(model, seed, claimed);
      if (std::isinf(least_m)) continue;
      check(least_m > 0.0, "seed %u, pose %d: %g m", seed, pose, least_m);
      ++scenes;
    }
    check(scenes > 80, "only %d scenes", scenes);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(a_target_that_claims_any_velocity_does_not_outweigh_evading)};
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
