#pragma once

#include <memory>

#include "firmware/control/cycle.h"
#include "host/campaign/sensing.h"

namespace sidestep::campaign {

/// Inputs of one control cycle.
struct ControllerInput {
  int64_t now_us;
  const Joints& q_rad;
  const Joints& qd_radps;
  const PointMotion* target;  ///< null: none, the controller holds
  const std::optional<OrientationTarget>& orientation_target;
  const ObstacleMeasurement& obstacles;
  const Joints* posture_rad = nullptr;  ///< the goal in place of the target; null: none
};

struct ControllerOutput {
  bool ready = false;     ///< the controller tracks the target, or holds if there is none
  bool guided = false;    ///< foresight has a guide
  Joints velocity_radps;  ///< command
  double cpu_s = 0.0;     ///< CPU time of the cycle
  const char* message = "";
};

/// Controls the arm in one trial.
class TrialController {
 public:
  virtual ~TrialController() = default;
  virtual ControllerOutput cycle(const ControllerInput& input) = 0;
};

/// step() with `model`, called in process, and foresight. The model must outlive it.
std::unique_ptr<TrialController> make_controller(const Model& model);

/// The controller under test: step() with `model`, called in process, or plain tracking of the arm if `model` is null.
/// Model and arm must outlive it.
std::unique_ptr<TrialController> make_controller(const Model* model, const JudgeArm& arm, const Limits& limits);

/// The controller's model with the limits of a family. Throws std::runtime_error unless the control period is the
/// benchmark's.
Model model_for(const Model& configured, const Limits& limits);

}  // namespace sidestep::campaign
