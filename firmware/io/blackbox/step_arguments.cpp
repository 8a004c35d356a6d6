#include "firmware/io/blackbox/step_arguments.h"

#include <algorithm>
#include <cstring>

#include "firmware/base/hash.h"

namespace sidestep {

void to_image(const StepArguments& arguments, StepArgumentsImage& image) {
  std::copy_n(reinterpret_cast<const unsigned char*>(&arguments), sizeof(StepArguments), image.bytes);
  image.checksum = fnv1a(image.bytes, sizeof(StepArguments));
}

bool from_image(const void* bytes, size_t size, StepArguments& arguments) {
  StepArgumentsImage image;
  if (size != sizeof image) return false;
  std::memcpy(&image, bytes, size);
  if (image.checksum != fnv1a(image.bytes, sizeof(StepArguments))) return false;
  std::copy_n(image.bytes, sizeof(StepArguments), reinterpret_cast<unsigned char*>(&arguments));
  arguments.state.supervision.message = "";
  return true;
}

}  // namespace sidestep
