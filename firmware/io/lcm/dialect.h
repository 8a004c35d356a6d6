#pragma once

#include <memory>
#include <string>
#include <vector>

#include "firmware/control/types/messages.h"
#include "firmware/io/lcm/packet.h"

namespace sidestep {

/// Decodes arm states and encodes commands in the layouts of one dialect. Does not allocate after the first call of
/// each.
class ArmCodec {
 public:
  virtual ~ArmCodec() = default;

  /// Fills `arm`, whose numbers are not checked, and returns null; or returns what is wrong with the bytes.
  virtual const char* decode(Packet packet, ArmState& arm) = 0;

  /// The packet is valid until the next call.
  virtual Packet encode(const Command& command, int64_t utime, int64_t seq) = 0;
};

/// How arm states and commands look on the wire, and what an arm with this wire requires; config key `dialect`. Each
/// dialect is one file, dialect_*.cpp; a new one is added to kDialects in dialect.cpp.
struct Dialect {
  const char* name;
  const char* arm_state_channel;    ///< default name
  const char* arm_command_channel;  ///< default name
  int joints;                       ///< number of joints of every such arm; 0: any
  double start_guard_s;             ///< after the first state of a driver no command may be sent for this time
  const char* no_lockstep;          ///< why --lockstep is not possible; null where it is
  std::unique_ptr<ArmCodec> (*make_codec)(int joints);
};

/// joint_state_t and joint_command_t.
extern const Dialect kSidestepDialect;

/// lcmt_iiwa_status and lcmt_iiwa_command: drake-iiwa-driver and Drake's simulated arm.
extern const Dialect kIiwaDialect;

std::vector<std::string> dialect_names();

/// The dialect of a name among dialect_names().
const Dialect& dialect_named(const std::string& name);

}  // namespace sidestep
