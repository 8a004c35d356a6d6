#include "firmware/io/blackbox/step_arguments.h"

#include <cstring>

#include "firmware/base/hash.h"

namespace sidestep {

void to_image(const StepArguments& arguments, StepArgumentsImage& image) {
  std::memcpy(image.bytes, static_cast<const void*>(&arguments), sizeof(StepArguments));
  image.checksum = fnv1a(image.bytes, sizeof(StepArguments));
}

bool from_image(const void* bytes, size_t size, StepArguments& arguments) {
  StepArgumentsImage image;
  if (size != sizeof image) return false;
  std::memcpy(&image, bytes, size);
  if (image.checksum != fnv1a(image.bytes, sizeof(StepArguments))) return false;
  std::memcpy(static_cast<void*>(&arguments), image.bytes, sizeof(StepArguments));
  arguments.state.supervision.message = "";
  return true;
}

}  // namespace sidestep
