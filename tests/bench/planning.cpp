#include "tests/bench/planning.h"

#include <limits>
#include <memory>

#include "firmware/base/realtime.h"
#include "firmware/foresight/tree_planner.h"
#include "firmware/io/config/config.h"
#include "host/campaign/scene_maker.h"
#include "host/campaign/sensing.h"
#include "host/campaign/trial_controller.h"

namespace sidestep::bench {
namespace {

constexpr uint64_t kFirstScene = 1000000;
constexpr int kMostSlices = 2000;

/// The arm rests at the start, and all furniture is known.
void take(const campaign::Scene& scene, Snapshot& snapshot) {
  snapshot.moves = snapshot.tracking = true;
  snapshot.arm.position_rad = scene.start_rad;
  snapshot.arm.velocity_radps = JointVector::Zero(scene.start_rad.size());
  snapshot.target.position_m = campaign::target_at(scene, 0.0).position_m;
  const auto orientation = campaign::orientation_target_at(scene, 0.0);
  snapshot.target.tracks_orientation = orientation.has_value();
  if (orientation) snapshot.target.orientation = orientation->orientation;
  campaign::Sensing sensing(scene);
  for (const Obstacle& obstacle : sensing.newest_at(0, 0.0).obstacles)
    snapshot.nearby.obstacles.at(static_cast<size_t>(snapshot.nearby.count++)) = obstacle;
}

double first_guide_ms(const Model& model, const Snapshot& snapshot) {
  const auto planner = std::make_unique<TreePlanner>(model);  // large
  const double begin_s = thread_cpu_s();
  for (int slice = 0; slice < kMostSlices; ++slice)
    if (planner->plan(snapshot).knots > 0) return 1e3 * (thread_cpu_s() - begin_s);
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<double> first_guides_ms(const std::string& config_path, int scenes) {
  const Config config = load_config(config_path, {});
  const std::unique_ptr<campaign::JudgeArm> arm = campaign::judge_arm_of(config);
  std::vector<double> times_ms;
  for (const char* name : {"shelf", "box", "cage", "table", "under-table"}) {
    const campaign::Family& family = campaign::family_named(name);
    const Model model = campaign::model_for(config.model, arm->limits(family));
    for (int i = 0; i < scenes; ++i) {
      const auto snapshot = std::make_unique<Snapshot>();
      take(campaign::make_scene(family, kFirstScene + static_cast<uint64_t>(i), *arm), *snapshot);
      times_ms.push_back(first_guide_ms(model, *snapshot));
    }
  }
  return times_ms;
}

}  // namespace sidestep::bench
