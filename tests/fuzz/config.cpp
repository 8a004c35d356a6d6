// Fuzzes the configuration loader. Runs in the repository's root, because the loader reads the URDF.
#include "firmware/io/config/config.h"
#include "tests/fuzz/file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const sidestep::fuzz::File file(data, size);
  sidestep::fuzz::load_or_refuse([&] { sidestep::load_config(file.name(), {}); });
  return 0;
}
