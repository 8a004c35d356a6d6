#include "firmware/model/load/srdf.h"

#include <filesystem>
#include <regex>

#include "firmware/base/fail.h"
#include "firmware/base/find_file.h"
#include "firmware/base/text_file.h"
#include "firmware/model/load/xml_comments.h"

namespace sidestep {
namespace {

/// The value of an attribute in the text of an element's tag.
std::string attribute(const std::string& tag, const std::string& name) {
  std::smatch found;
  const std::regex pattern("\\s" + name + "\\s*=\\s*[\"']([^\"']*)[\"']");
  return std::regex_search(tag, found, pattern) ? found[1].str() : "";
}

}  // namespace

std::string srdf_beside(const std::string& urdf_file) {
  const std::string file = std::filesystem::path(urdf_file).replace_extension(".srdf").string();
  return file != urdf_file && is_file(file) ? file : "";
}

std::vector<LinkPair> disabled_collisions(const std::string& srdf_file) {
  const std::string text = without_comments(read_text_file(srdf_file)), element = "<disable_collisions";
  if (text.find("<robot") == std::string::npos) fail("{}: not an SRDF: no <robot>", srdf_file);
  std::vector<LinkPair> pairs;
  for (size_t start = text.find(element); start != std::string::npos; start = text.find(element, start + 1)) {
    const std::string tag = text.substr(start, text.find('>', start) - start);
    const LinkPair pair(attribute(tag, "link1"), attribute(tag, "link2"));
    if (pair.first.empty() || pair.second.empty()) fail("{}: a disable_collisions without link1 or link2", srdf_file);
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace sidestep
