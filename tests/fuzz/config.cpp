// The loader of configurations; it runs in the repository's root, where it finds the URDF.
#include "firmware/io/config/config.h"
#include "tests/fuzz/file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const sidestep::fuzz::File file(data, size);
  sidestep::fuzz::load_or_refuse([&] { sidestep::load_config(file.name(), {}); });
  return 0;
}
