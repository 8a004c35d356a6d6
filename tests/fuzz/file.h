#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>

namespace sidestep::fuzz {

/// Bytes as a file that lives in memory, for loaders that want a name.
class File {
 public:
  File(const uint8_t* data, size_t size) : descriptor_(memfd_create("fuzz", 0)) {
    if (descriptor_ < 0 || write(descriptor_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::string name() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// Loads, which may be refused: with one line that has words.
template <typename Load>
void load_or_refuse(Load&& load) {
  try {
    load();
  } catch (const std::exception& error) {
    if (!*error.what() || std::strchr(error.what(), '\n')) std::abort();
  }
}

}  // namespace sidestep::fuzz
