#include "firmware/model/load/urdf_file.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>

#include "firmware/base/fail.h"
#include "firmware/base/text_file.h"

namespace sidestep {
namespace {

// The parsers go into what stands within what by recursion, which has to end before the stack does.
constexpr int kMostTags = 20000;

/// Keeps the first complaint of the URDF parser, which would print several and drop the elements it complains about.
class Complaints : public console_bridge::OutputHandler {
 public:
  Complaints() { console_bridge::useOutputHandler(this); }
  ~Complaints() override { console_bridge::restorePreviousOutputHandler(); }
  Complaints(const Complaints&) = delete;
  Complaints& operator=(const Complaints&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text.substr(0, text.find('\n'));
  }
  const std::string& first() const { return first_; }

 private:
  std::string first_;
};

}  // namespace

urdf::ModelInterfaceSharedPtr read_urdf(const std::string& file) {
  const std::string text = read_text_file(file);
  if (std::count(text.begin(), text.end(), '<') > kMostTags) fail("{}: more than {} tags", file, kMostTags);
  const Complaints complaints;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!complaints.first().empty()) fail("{}: not a valid URDF: {}", file, complaints.first());
  if (!model || !model->getRoot()) fail("{}: not a valid URDF", file);
  return model;
}

bool is_fixed(const urdf::Link& link) {
  return link.parent_joint && link.parent_joint->type == urdf::Joint::FIXED;
}

}  // namespace sidestep
