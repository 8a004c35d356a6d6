#pragma once

#include "host/campaign/trial.h"

namespace sidestep::test {

/// Commands the same joint velocity in every cycle.
class ConstantController : public campaign::TrialController {
 public:
  explicit ConstantController(const campaign::Joints& velocity_radps) : velocity_radps_(velocity_radps) {}

  campaign::ControllerOutput cycle(const campaign::ControllerInput&) override {
    campaign::ControllerOutput output;
    output.ready = true;
    output.velocity_radps = velocity_radps_;
    return output;
  }

 private:
  campaign::Joints velocity_radps_;
};

}  // namespace sidestep::test
