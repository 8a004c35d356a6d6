#pragma once

namespace sidestep {

/// How arm states and commands look on the wire; config key `dialect`.
enum class Dialect {
  kSidestep,  ///< joint_state_t, joint_command_t
  kIiwa,      ///< lcmt_iiwa_status, lcmt_iiwa_command: drake-iiwa-driver and Drake's simulated arm
};

constexpr int kIiwaJoints = 7;
/// drake-iiwa-driver gives up when a command comes this soon after its first status.
constexpr double kIiwaStartGuard_s = 0.25;

}  // namespace sidestep
