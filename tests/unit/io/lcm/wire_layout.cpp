#include <sidestep/attachments_t.hpp>
#include <sidestep/control_t.hpp>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <sidestep/joint_state_t.hpp>
#include <sidestep/joint_target_t.hpp>
#include <sidestep/named_joints_t.hpp>
#include <sidestep/obstacles_t.hpp>
#include <sidestep/target_t.hpp>
#include <vector>

#include "firmware/control/types/messages.h"
#include "tests/support/check.h"

namespace {

/// LCM's fingerprint of a layout, computed after LCM's definition from each member's name, the name of its type if that
/// is a primitive one, and its dimensions.
class Fingerprint {
 public:
  Fingerprint& add(const std::string& name, const std::string& type, const std::vector<std::string>& sizes = {}) {
    text(name);
    if (type.size() < 2 || type.substr(type.size() - 2) != "_t" || type.rfind("int", 0) == 0) text(type);
    byte(static_cast<char>(sizes.size()));
    for (const std::string& size : sizes) {
      const bool counted = !std::isdigit(static_cast<unsigned char>(size[0]));
      byte(counted ? 1 : 0);
      text(size);
    }
    return *this;
  }
  /// Adds the fingerprint of a nested layout.
  Fingerprint& nest(uint64_t inner) {
    nested_ += inner;
    return *this;
  }
  uint64_t value() const {
    const uint64_t sum = static_cast<uint64_t>(value_) + nested_;
    return (sum << 1) + (sum >> 63);
  }

 private:
  void byte(char c) {
    value_ = static_cast<int64_t>((static_cast<uint64_t>(value_) << 8) ^ static_cast<uint64_t>(value_ >> 55)) + c;
  }
  void text(const std::string& s) {
    byte(static_cast<char>(s.size()));
    for (char c : s) byte(c);
  }

  int64_t value_ = 0x12345678;
  uint64_t nested_ = 0;
};

Fingerprint target() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("position", "double", {"3"})
      .add("velocity", "double", {"3"})
      .add("tracks_orientation", "boolean")
      .add("quaternion", "double", {"4"})
      .add("angular_velocity", "double", {"3"});
}

Fingerprint obstacle() {
  return Fingerprint()
      .add("id", "int32_t")
      .add("shape", "int8_t")
      .add("position", "double", {"3"})
      .add("quaternion", "double", {"4"})
      .add("size", "double", {"3"})
      .add("velocity", "double", {"3"})
      .add("angular_velocity", "double", {"3"})
      .add("kind", "int8_t");
}

Fingerprint obstacles() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("num_obstacles", "int32_t")
      .add("obstacles", "obstacle_t", {"num_obstacles"})
      .nest(obstacle().value());
}

Fingerprint attachments() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("num_shapes", "int32_t")
      .add("shapes", "obstacle_t", {"num_shapes"})
      .add("num_allowed", "int32_t")
      .add("allowed", "int32_t", {"num_allowed"})
      .nest(obstacle().value());
}

Fingerprint joint_state() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("num_joints", "int32_t")
      .add("joint_position", "double", {"num_joints"})
      .add("joint_velocity", "double", {"num_joints"});
}

Fingerprint named_joints() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("num_joints", "int32_t")
      .add("joint_name", "string", {"num_joints"})
      .add("joint_position", "double", {"num_joints"});
}

Fingerprint joint_command() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("seq", "int64_t")
      .add("num_joints", "int32_t")
      .add("joint_position", "double", {"num_joints"})
      .add("joint_velocity", "double", {"num_joints"});
}

Fingerprint joint_target() {
  return Fingerprint()
      .add("utime", "int64_t")
      .add("num_joints", "int32_t")
      .add("joint_position", "double", {"num_joints"});
}

Fingerprint control() {
  return Fingerprint().add("utime", "int64_t").add("command", "int8_t").add("speed_scale", "double");
}

Fingerprint controller_status() {
  Fingerprint f;
  f.add("utime", "int64_t")
      .add("seq", "int64_t")
      .add("mode", "int8_t")
      .add("fault", "int32_t")
      .add("limiting", "int32_t");
  f.add("tool_position", "double", {"3"}).add("tool_velocity", "double", {"3"});
  f.add("target_distance", "double").add("clearance", "double");
  f.add("nearest_obstacle", "int32_t").add("nearest_link", "string");
  f.add("beta", "double").add("damping", "double").add("shield_correction", "double");
  f.add("cycle_time", "double").add("wake_latency", "double");
  f.add("skipped_cycles", "int64_t").add("rejected_messages", "int64_t").add("message", "string");
  f.add("foresight", "int8_t").add("guide_horizon", "double").add("guide_tool", "double", {"8", "3"});
  f.add("self_clearance", "double").add("self_links", "string", {"2"}).add("speed_scale", "double");
  return f;
}

/// The literals are the fingerprints of the last release that changed the layout. A changed layout breaks every peer
/// that is not rebuilt.
void layouts_have_the_published_fingerprints(void**) {
  const struct {
    const char* type;
    int64_t generated;
    uint64_t derived;
    uint64_t published;
  } types[] = {
      {"target_t", sidestep::target_t::getHash(), target().value(), 0x635ec8698d1164cd},
      {"obstacle_t", sidestep::obstacle_t::getHash(), obstacle().value(), 0x0067ceede37a7f5f},
      {"obstacles_t", sidestep::obstacles_t::getHash(), obstacles().value(), 0x8fdb94b310501552},
      {"joint_state_t", sidestep::joint_state_t::getHash(), joint_state().value(), 0x1806be37545e7d3f},
      {"named_joints_t", sidestep::named_joints_t::getHash(), named_joints().value(), 0xb369b291b5836948},
      {"joint_command_t", sidestep::joint_command_t::getHash(), joint_command().value(), 0xbc0ffe2927412bea},
      {"attachments_t", sidestep::attachments_t::getHash(), attachments().value(), 0xe5286cfa7e9c4ff3},
      {"joint_target_t", sidestep::joint_target_t::getHash(), joint_target().value(), 0xbf12364895a6d4ae},
      {"control_t", sidestep::control_t::getHash(), control().value(), 0x7686d491d38e67bc},
      {"controller_status_t", sidestep::controller_status_t::getHash(), controller_status().value(),
       0xef5f88d512318560},
  };
  for (const auto& type : types) {
    const auto generated = static_cast<uint64_t>(type.generated);
    check(generated == type.derived, "%s: %016lx, derived %016lx", type.type, generated, type.derived);
    check(generated == type.published, "%s: %016lx, published %016lx", type.type, generated, type.published);
  }
}

void constants_on_the_wire_equal_those_of_the_firmware(void**) {
  using Status = sidestep::controller_status_t;
  using sidestep::Fault;
  using sidestep::Mode;
  assert_int_equal(Status::WAIT, Mode::kWait);
  assert_int_equal(Status::HOLD, Mode::kHold);
  assert_int_equal(Status::TRACK, Mode::kTrack);
  assert_int_equal(Status::BRAKE, Mode::kBrake);
  assert_int_equal(Status::FAULT, Mode::kFault);
  assert_int_equal(Status::FAULT_NONE, Fault::kNone);
  assert_int_equal(Status::FAULT_ARM_STATE_LOST, Fault::kArmStateLost);
  assert_int_equal(Status::FAULT_ARM_STATE_INCONSISTENT, Fault::kArmStateInconsistent);
  assert_int_equal(Status::FAULT_NOT_FINITE, Fault::kNotFinite);
  assert_int_equal(Status::LIMITING_VELOCITY, sidestep::kLimitingVelocity);
  assert_int_equal(Status::LIMITING_ACCELERATION, sidestep::kLimitingAcceleration);
  assert_int_equal(Status::LIMITING_POSITION, sidestep::kLimitingPosition);
  assert_int_equal(Status::LIMITING_TASK_SPEED, sidestep::kLimitingTaskSpeed);
  assert_int_equal(Status::LIMITING_SHIELD, sidestep::kLimitingShield);
  assert_int_equal(Status::LIMITING_NOT_REALTIME, sidestep::kLimitingNotRealtime);
  assert_int_equal(Status::LIMITING_LATE, sidestep::kLimitingLate);
  assert_int_equal(Status::LIMITING_SHIELD_FAILED, sidestep::kLimitingShieldFailed);
  assert_int_equal(Status::LIMITING_SELF, sidestep::kLimitingSelf);
  assert_int_equal(sidestep::obstacle_t::SPHERE, 0);
  assert_int_equal(sidestep::obstacle_t::CAPSULE, 1);
  assert_int_equal(sidestep::obstacle_t::BOX, 2);
  assert_int_equal(sidestep::obstacle_t::CYLINDER, 3);
  assert_int_equal(sidestep::obstacle_t::THING, 0);
  assert_int_equal(sidestep::obstacle_t::PERSON, 1);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(layouts_have_the_published_fingerprints),
      cmocka_unit_test(constants_on_the_wire_equal_those_of_the_firmware),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
