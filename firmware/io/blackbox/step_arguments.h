#pragma once

#include "firmware/control/cycle.h"

namespace sidestep {

/// Everything that a cycle is given beyond the model, and what names its command. A blackbox keeps it as it lies in
/// memory: bit for bit, and nothing added to a state can be forgotten. Its pointers mean nothing to another process.
struct StepArguments {
  int64_t utime = 0;
  int64_t seq = 0;
  double now_s = 0.0;
  Inputs inputs;
  State state;
  Guide guide;  ///< what inputs.guide points at, if anything
};

/// How a moment stands in a log: behind a checksum.
struct StepArgumentsImage {
  uint64_t checksum;
  uint8_t bytes[sizeof(StepArguments)];
};

void to_image(const StepArguments& arguments, StepArgumentsImage& image);

/// Returns false, and leaves the moment alone, when these bytes are no image of one.
bool from_image(const void* bytes, size_t size, StepArguments& arguments);

}  // namespace sidestep
