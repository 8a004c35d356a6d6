#include "firmware/base/text_file.h"

#include <fstream>

#include "firmware/base/fail.h"

namespace sidestep {

std::string read_text_file(const std::string& file) {
  constexpr size_t kLargest_bytes = 16 << 20, kPiece_bytes = 1 << 16;
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  size_t size = 0;
  while (stream && size <= kLargest_bytes) {
    text.resize(size + kPiece_bytes);
    stream.read(&text[size], kPiece_bytes);
    size += static_cast<size_t>(stream.gcount());
  }
  if (!stream.is_open() || stream.bad()) fail("{}: cannot be read", file);
  if (size > kLargest_bytes) fail("{}: larger than {} MB", file, kLargest_bytes >> 20);
  text.resize(size);
  return text;
}

}  // namespace sidestep
