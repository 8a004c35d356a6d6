#include "firmware/model/load/urdf_file.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>

#include "firmware/base/fail.h"
#include "firmware/base/text_file.h"
#include "firmware/model/load/xml_comments.h"

namespace sidestep {
namespace {

// The parsers descend into nested tags by recursion; this bounds its depth, so that the stack does not overflow.
constexpr int kMostTags = 20000;

/// Collects the first error line of the URDF parser, which would print its errors and skip the elements concerned.
class FirstError : public console_bridge::OutputHandler {
 public:
  FirstError() { console_bridge::useOutputHandler(this); }
  ~FirstError() override { console_bridge::restorePreviousOutputHandler(); }
  FirstError(const FirstError&) = delete;
  FirstError& operator=(const FirstError&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text.substr(0, text.find('\n'));
  }
  const std::string& text() const { return first_; }

 private:
  std::string first_;
};

}  // namespace

urdf::ModelInterfaceSharedPtr read_urdf(const std::string& file) {
  const std::string text = read_text_file(file);
  if (std::count(text.begin(), text.end(), '<') > kMostTags) fail("{}: more than {} tags", file, kMostTags);
  const bool is_xacro = without_comments(text).find("<xacro:") != std::string::npos;
  if (is_xacro) fail("{}: is a xacro file; make a URDF of it first: xacro {} > robot.urdf", file, file);
  const FirstError error;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!error.text().empty()) fail("{}: not a valid URDF: {}", file, error.text());
  if (!model || !model->getRoot()) fail("{}: not a valid URDF", file);
  return model;
}

bool is_fixed(const urdf::Link& link) {
  return link.parent_joint && link.parent_joint->type == urdf::Joint::FIXED;
}

}  // namespace sidestep
