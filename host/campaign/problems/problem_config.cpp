#include "host/campaign/problems/problem_config.h"

#include "host/campaign/trial_controller.h"

namespace sidestep::campaign {

Config config_for(const Problem& problem, const Config& config) {
  Config placed = config;
  placed.model = model_for(config.model, config.model.arm.limits);
  Arm& arm = placed.model.arm;
  for (size_t i = 0; i < arm.other_joints.size(); ++i) {
    const auto found = problem.other_positions.find(arm.other_joints[i].name);
    if (found != problem.other_positions.end()) arm.other_positions.position[i] = found->second;
  }
  arm.other_frames = place_other_joints(arm, arm.other_positions);
  for (const auto& [joint, position] : problem.other_positions) placed.robot.joint_positions[joint] = position;
  return placed;
}

}  // namespace sidestep::campaign
