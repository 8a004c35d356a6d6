#include "firmware/io/config/yaml_document.h"

#include <yaml-cpp/eventhandler.h>

#include <sstream>

namespace sidestep {
namespace {

/// Hears where a document starts and nothing else.
class StartOfDocument : public YAML::EventHandler {
 public:
  YAML::Mark mark;

  void OnDocumentStart(const YAML::Mark& start) override { mark = start; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

}  // namespace

YAML::Node only_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  StartOfDocument document;
  // Two steps and no more: a parser never comes to the end of a lone comma, nor does LoadAll().
  if (parser.HandleNextDocument(document) && parser.HandleNextDocument(document))
    throw YAML::ParserException(document.mark, "a second document starts here, of which nothing would be read");
  return YAML::Load(text);
}

}  // namespace sidestep
