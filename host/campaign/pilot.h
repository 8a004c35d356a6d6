#pragma once

#include <memory>

#include "firmware/control/cycle.h"
#include "host/campaign/sensing.h"

namespace sidestep::campaign {

/// What a pilot is told in one cycle.
struct Seen {
  int64_t now_us;
  const Joints& q_rad;
  const Joints& qd_radps;
  const Moving& target;
  const std::optional<Turning>& turning;
  const Sighting& obstacles;
};

struct Steering {
  bool tracking = false;  ///< false: still getting ready
  Joints velocity_radps;
  double cpu_s = 0.0;
  const char* message = "";
};

/// Steers the arm through one trial.
class Pilot {
 public:
  virtual ~Pilot() = default;
  virtual Steering cycle(const Seen& seen) = 0;
};

/// `model` steers, its step() called in process; null: plain tracking of the arm. Model and arm must outlive the pilot.
std::unique_ptr<Pilot> make_pilot(const Model* model, const JudgeArm& arm, const Limits& limits);

/// The controller's model with the limits of a family. Throws std::runtime_error unless its cycle is the benchmark's.
Model model_for(const Model& configured, const Limits& limits);

}  // namespace sidestep::campaign
