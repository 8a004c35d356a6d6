#pragma once

namespace sidestep {

/// The stages of a control cycle, in their order: input monitoring with forward kinematics; clearance; law; shield;
/// gate.
enum class Stage { kMonitor, kClearance, kLaw, kShield, kGate };
constexpr int kStages = 5;

/// Called at the end of each stage of step(). The cycle itself has no clock; the caller measures time here.
class StageProbe {
 public:
  virtual void passed(Stage stage) = 0;

 protected:
  ~StageProbe() = default;
};

}  // namespace sidestep
