#pragma once

namespace sidestep {

/// The parts of a control cycle, in their order: what is known of arm, obstacles and target; distances; the wish; the
/// wish made safe; the last word.
enum class Stage { kObserve, kClearance, kLaw, kShield, kGate };
constexpr int kStages = 5;

/// Hears when a stage of step() has ended. A cycle knows no clock; who runs it may have one.
class StageProbe {
 public:
  virtual void passed(Stage stage) = 0;

 protected:
  ~StageProbe() = default;
};

}  // namespace sidestep
