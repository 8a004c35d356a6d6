#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace sidestep {

/// LCM channel names; config section `channels:`.
struct Channels {
  std::string target = "TARGET";
  std::string joint_target = "JOINT_TARGET";
  std::string obstacles = "OBSTACLES";
  std::string arm_state = "ARM_STATE";
  std::string other_joints = "OTHER_JOINTS";
  std::string control = "CONTROL";
  std::string attachments = "ATTACHMENTS";
  std::string arm_command = "ARM_COMMAND";
  std::string controller_status = "CONTROLLER_STATUS";
  std::string loop_timing = "LOOP_TIMING";
};

constexpr size_t kMaxNeighbours = 16;

/// Other arms in the same workspace; config section `neighbours:`. All arms publish their links in one world frame.
struct Neighbours {
  std::string publish;              ///< channel of this arm's links; empty: they are not published
  std::vector<std::string> listen;  ///< channels of the other arms' links
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
};

}  // namespace sidestep
