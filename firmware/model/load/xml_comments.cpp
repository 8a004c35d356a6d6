#include "firmware/model/load/xml_comments.h"

namespace sidestep {

std::string without_comments(std::string xml) {
  for (size_t start = xml.find("<!--"); start != std::string::npos; start = xml.find("<!--", start)) {
    const size_t end = xml.find("-->", start);
    xml.erase(start, end == std::string::npos ? end : end + 3 - start);
  }
  return xml;
}

}  // namespace sidestep
