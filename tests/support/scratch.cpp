#include "tests/support/scratch.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/check.h"

namespace sidestep::test {
namespace {

namespace fs = std::filesystem;

struct Folder {
  std::string path;
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "sidestep-test-XXXXXX").string();
    path = mkdtemp(pattern.data()) ? pattern : "";
  }
  ~Folder() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
};

}  // namespace

const std::string& scratch_folder() {
  static const Folder folder;
  check(!folder.path.empty(), "no temporary folder");
  return folder.path;
}

std::string scratch_file(const std::string& name, const std::string& text) {
  const std::string file = scratch_folder() + "/" + name;
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  check(stream.good(), "%s cannot be written", file.c_str());
  return file;
}

std::string text_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  check(stream.good(), "%s cannot be read (tests run in the repository's root)", file.c_str());
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string replaced(const std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  check(at != std::string::npos, "there is no '%s' to replace", from.c_str());
  return text.substr(0, at) + to + text.substr(at + from.size());
}

}  // namespace sidestep::test
