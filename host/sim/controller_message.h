#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>

namespace sidestep::sim {

/// Values as in controller_status_t.
enum class Mode { kWait = 0, kHold = 1, kTrack = 2, kBrake = 3, kFault = 4 };

/// The fields of joint_command_t that the simulator uses.
struct Command {
  int64_t utime = 0;
  int64_t seq = 0;           ///< number of the controller's cycle
  Eigen::VectorXd qd_radps;  ///< unchecked: any size, any value
  Eigen::VectorXd q_rad{};   ///< as many, unchecked as well
};

/// The fields of controller_status_t that the simulator uses.
struct Status {
  Mode mode = Mode::kWait;
  double cycle_time_s = 0.0;
  double beta = 0.0;
  double damping = 0.0;
  int64_t skipped_cycles = 0;
  int64_t rejected_messages = 0;
  std::string message;
  int foresight = 0;  ///< 0 direct, 1 guided, 2 waiting
  double guide_horizon_s = 0.0;
  Eigen::Matrix<double, 3, 8> guide_tool_m = Eigen::Matrix<double, 3, 8>::Zero();  ///< as in controller_status_t
};

/// One message from the controller.
using ControllerMessage = std::variant<Command, Status>;

}  // namespace sidestep::sim
