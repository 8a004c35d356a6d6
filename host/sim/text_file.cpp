#include "host/sim/text_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace sidestep::sim {

std::string read_text_file(const std::string& file) {
  std::error_code ignored;  // what cannot be asked for is not regular
  std::ifstream in;
  if (std::filesystem::is_regular_file(file, ignored)) in.open(file, std::ios::binary);
  std::string text;
  if (in.is_open()) text.assign(std::istreambuf_iterator<char>(in), {});
  if (!in.is_open() || in.bad()) throw std::runtime_error(file + ": cannot be read");
  return text;
}

}  // namespace sidestep::sim
