// The loader of robot descriptions, for the chain from base_link to tool.
#include "firmware/model/load/load_arm.h"
#include "tests/fuzz/file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const sidestep::fuzz::File file(data, size);
  sidestep::fuzz::load_or_refuse([&] { sidestep::load_arm(file.name(), "base_link", "tool"); });
  return 0;
}
