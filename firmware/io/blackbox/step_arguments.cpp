#include "firmware/io/blackbox/step_arguments.h"

#include <cstring>

namespace sidestep {
namespace {

/// FNV-1a.
uint64_t checksum_of(const uint8_t* bytes, size_t size) {
  uint64_t sum = 0xcbf29ce484222325;
  for (size_t i = 0; i < size; ++i) sum = (sum ^ bytes[i]) * 0x100000001b3;
  return sum;
}

}  // namespace

void to_image(const StepArguments& arguments, StepArgumentsImage& image) {
  std::memcpy(image.bytes, static_cast<const void*>(&arguments), sizeof(StepArguments));
  image.checksum = checksum_of(image.bytes, sizeof(StepArguments));
}

bool from_image(const void* bytes, size_t size, StepArguments& arguments) {
  StepArgumentsImage image;
  if (size != sizeof image) return false;
  std::memcpy(&image, bytes, size);
  if (image.checksum != checksum_of(image.bytes, sizeof(StepArguments))) return false;
  std::memcpy(static_cast<void*>(&arguments), image.bytes, sizeof(StepArguments));
  arguments.state.supervision.message = "";
  return true;
}

}  // namespace sidestep
