#pragma once

#include <memory>

#include "firmware/control/types/messages.h"
#include "firmware/io/lcm/dialect.h"

namespace sidestep {

/// Bytes to arm states, in the layout of a dialect. Does not allocate once it has read one.
class ArmReader {
 public:
  ArmReader(Dialect dialect, int joints);
  ~ArmReader();

  /// Fills `value`, whose numbers may yet be anything, and returns null; or says what is wrong with the bytes.
  const char* read(const void* bytes, size_t size, ArmState& value);

 private:
  struct Scratch;

  Dialect dialect_;
  int joints_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace sidestep
