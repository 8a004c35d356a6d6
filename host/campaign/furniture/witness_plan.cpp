#include "host/campaign/furniture/witness_plan.h"

#include "host/campaign/furniture/path_planner.h"

namespace sidestep::campaign {
namespace {

constexpr double kShare = 0.8;           // of the limits
constexpr double kLinksApart_m = 0.005;  // by the judge's surfaces, where the controller asks for less
constexpr int kMostChecks = 20'000;      // of the planner
constexpr int kChecksPerPeriod = 2;      // of the finished witness

/// Whether the timed witness keeps clear everywhere; the planner has looked at coarser steps.
bool witness_keeps_clear(const Scene& scene, double clearance_m) {
  const double step_s = kPeriod_s / kChecksPerPeriod;
  for (int k = 0; k * step_s < scene.witness_s + step_s; ++k)
    if (!keeps_clear(scene, scene.witness_path.position_rad(k * step_s), clearance_m)) return false;
  return true;
}

}  // namespace

bool keeps_clear(const Scene& scene, const Joints& q_rad, double clearance_m) {
  const JudgeArm& arm = *scene.arm;
  const ArmPose pose = arm.pose(q_rad);
  return arm.keeps_clear_of_itself(pose) &&  // the cheapest first
         arm.solid_clearance(pose, scene.furniture, clearance_m) >= clearance_m &&
         arm.self_clearance(pose, kLinksApart_m) >= kLinksApart_m;
}

bool plan_witness(Random& random, Scene& scene, double clearance_m) {
  const PlanningProblem problem{scene.start_rad,
                                scene.goal_rad,
                                scene.arm->range(),
                                [&](const Joints& q_rad) { return keeps_clear(scene, q_rad, clearance_m); },
                                static_cast<uint32_t>(random.integer(1, 1'000'000'000)),
                                kMostChecks};
  std::vector<Joints> knots_rad = plan_path(problem);
  if (knots_rad.empty()) return false;
  scene.witness_path = TimedPath(std::move(knots_rad), scene.arm->limits(*scene.family), kShare);
  scene.witness_s = scene.witness_path.duration_s();
  return witness_keeps_clear(scene, clearance_m);
}

}  // namespace sidestep::campaign
