#pragma once

#include "firmware/control/cycle.h"

namespace sidestep {

/// The arguments of one call of step() besides the model, and the numbers that its command was sent with. The blackbox
/// stores them as they lie in memory: bit for bit, and complete whatever is added to a state. The pointers in them are
/// not valid in another process.
struct StepArguments {
  int64_t utime = 0;
  int64_t seq = 0;
  double now_s = 0.0;
  Inputs inputs;
  State state;
  Guide guide;               ///< what inputs.guide points at, if anything
  Control control;           ///< what inputs.control.message points at, if anything
  Attachments attachments;   ///< what inputs.attachments.message points at, if anything
  OtherJoints other_joints;  ///< what inputs.other_joints.message points at, if anything
};

/// The arguments as stored in a log, after a checksum.
struct StepArgumentsImage {
  uint64_t checksum;
  uint8_t bytes[sizeof(StepArguments)];
};

void to_image(const StepArguments& arguments, StepArgumentsImage& image);

/// Returns false and leaves the arguments unchanged when these bytes are no valid image.
bool from_image(const void* bytes, size_t size, StepArguments& arguments);

}  // namespace sidestep
