#include "firmware/io/moment.h"

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

void to_image(const Moment& moment, MomentImage& image) {
  std::memcpy(image.bytes, static_cast<const void*>(&moment), sizeof(Moment));
  image.checksum = checksum_of(image.bytes, sizeof(Moment));
}

bool from_image(const void* bytes, size_t size, Moment& moment) {
  MomentImage image;
  if (size != sizeof image) return false;
  std::memcpy(&image, bytes, size);
  if (image.checksum != checksum_of(image.bytes, sizeof(Moment))) return false;
  std::memcpy(static_cast<void*>(&moment), image.bytes, sizeof(Moment));
  moment.state.supervision.message = "";
  return true;
}

}  // namespace sidestep
