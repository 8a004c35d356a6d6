#include "firmware/control/validation.h"
#include "firmware/io/lcm/message_decoder.h"
#include "tests/support/check.h"
#include "tests/support/iiwa_driver.h"
#include "tests/support/lwa3.h"
#include "tests/support/messages.h"
#include "tests/support/random.h"
#include "tests/support/test_inputs.h"

using namespace sidestep;
using test::arm_state_message;
using test::Bytes;
using test::encoded;
using test::obstacles_message;
using test::Random;
using test::target_message;
using test::TestInputs;

namespace {

constexpr int kJoints = 7;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ArmState arm;
Target target;
ObstacleSet set;

/// A channel with a valid message, the decoder for it and a check of the decoded value.
struct Channel {
  const char* name;
  Bytes good;
  bool (*receive)(TestInputs&, const void*, size_t);
  bool (*plausible_value)();
  const Dialect* dialect = &kSidestepDialect;
};

target_t turning_target() {
  target_t message = target_message(7, Vector3(0.3, 0.2, 0.9), Vector3(0.1, 0, 0));
  message.tracks_orientation = 1;
  test::copy(Vector3(0.1, 0.2, 0.3), message.angular_velocity);
  return message;
}

obstacle_t capsule() {
  obstacle_t message = test::sphere(3, Vector3(0.5, 0.5, 0.5), 0.1, Vector3(0, 0, 0.1));
  message.shape = obstacle_t::CAPSULE;
  message.size[1] = 0.4;
  return message;
}

std::vector<Channel> channels() {
  const JointVector q_rad = JointVector::Constant(kJoints, 0.3), qd_radps = JointVector::Constant(kJoints, -0.2);
  const obstacle_t ball = test::sphere(4, Vector3(0.5, 0.5, 0.5), 0.1, Vector3(0, 0, 0.1));
  return {
      {"arm state", encoded(arm_state_message(7, q_rad, qd_radps)),
       [](TestInputs& inputs, const void* bytes, size_t size) { return inputs.receive(bytes, size, 0.0, arm); },
       [] { return plausible(arm, kJoints); }},
      {"target", encoded(turning_target()),
       [](TestInputs& inputs, const void* bytes, size_t size) { return inputs.receive(bytes, size, 0.0, target); },
       [] { return plausible(target); }},
      {"obstacles", encoded(obstacles_message(7, {capsule(), ball})),
       [](TestInputs& inputs, const void* bytes, size_t size) { return inputs.receive(bytes, size, 0.0, set); },
       [] {
         bool all = set.count >= 0 && set.count <= kMaxObstacles;
         for (int i = 0; all && i < set.count; ++i) all = plausible(set.obstacles[static_cast<size_t>(i)]);
         return all;
       }},
      {"iiwa status", encoded(test::iiwa_status(7, q_rad, qd_radps, q_rad)),
       [](TestInputs& inputs, const void* bytes, size_t size) { return inputs.receive(bytes, size, 0.0, arm); },
       [] { return plausible(arm, kJoints) && arm.held_rad.allFinite(); }, &kIiwaDialect},
  };
}

/// Whether the inputs, which have accepted nothing yet, accept this message. Each rejection counts and has a reason.
bool accepts(TestInputs& gate, const Channel& channel, const Bytes& bytes) {
  const int64_t before = gate.rejected();
  // On the heap with the exact size, so that a sanitizer detects a read beyond the end.
  const Bytes exact(bytes.begin(), bytes.end());
  const bool accepted = channel.receive(gate, exact.data(), exact.size());
  check(gate.rejected() == before + (accepted ? 0 : 1), "%s: %ld rejected", channel.name, gate.rejected());
  check(accepted ? before > 0 || *gate.last_reason() == '\0' : *gate.last_reason() != '\0', "%s: reason '%s'",
        channel.name, gate.last_reason());
  return accepted;
}

std::unique_ptr<TestInputs> inputs_of(const Channel& channel) {
  return std::make_unique<TestInputs>(kJoints, Settings(), *channel.dialect);
}

bool accepts(const Channel& channel, const Bytes& bytes) {
  return accepts(*inputs_of(channel), channel, bytes);
}

void put(Bytes& bytes, size_t at, uint64_t value, int width) {
  for (int i = 0; i < width; ++i)
    bytes[at + static_cast<size_t>(i)] = static_cast<uint8_t>(value >> 8 * (width - 1 - i));
}

void put_double(Bytes& bytes, size_t at, double value) {
  uint64_t bits;
  std::memcpy(&bits, &value, 8);
  put(bytes, at, bits, 8);
}

void valid_messages_are_accepted(void**) {
  for (const Channel& channel : channels()) check(accepts(channel, channel.good), "%s", channel.name);
}

void every_truncation_is_rejected(void**) {
  for (const Channel& channel : channels())
    for (size_t size = 0; size < channel.good.size(); ++size)
      check(!accepts(channel, Bytes(channel.good.begin(), channel.good.begin() + static_cast<std::ptrdiff_t>(size))),
            "%s, %zu bytes", channel.name, size);
}

void trailing_bytes_are_rejected(void**) {
  for (const Channel& channel : channels())
    for (const size_t extra : {1, 7, 8, 16, 134, 65536}) {
      Bytes bytes = channel.good;
      bytes.resize(bytes.size() + extra);
      check(!accepts(channel, bytes), "%s, %zu more", channel.name, extra);
    }
}

void every_flipped_bit_is_rejected_or_gives_a_plausible_value(void**) {
  int accepted = 0, rejected = 0;
  for (const Channel& channel : channels()) {
    for (size_t bit = 0; bit < 8 * channel.good.size(); ++bit) {
      Bytes bytes = channel.good;
      bytes[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
      const bool taken = accepts(channel, bytes);
      (taken ? accepted : rejected) += 1;
      if (bit < 64) check(!taken, "%s: a wrong fingerprint, bit %zu", channel.name, bit);
      if (taken) check(channel.plausible_value(), "%s: an implausible value was accepted, bit %zu", channel.name, bit);
      const bool counts = bit / 8 >= 16 && bit / 8 < 20 && std::string(channel.name) != "target";
      if (counts) check(!taken, "%s: a wrong count, bit %zu", channel.name, bit);
    }
  }
  check(accepted > 1000 && rejected > 300, "%d accepted, %d rejected", accepted, rejected);
}

void wrong_counts_are_rejected(void**) {
  for (const Channel& channel : channels()) {
    if (std::string(channel.name) == "target") continue;
    for (const int64_t count : {int64_t{-1}, int64_t{INT32_MIN}, int64_t{INT32_MAX}, int64_t{0}, int64_t{1}, int64_t{6},
                                int64_t{8}, int64_t{4096}, int64_t{4097}, int64_t{0x10000000}, int64_t{0x08000000}}) {
      Bytes bytes = channel.good;
      put(bytes, 16, static_cast<uint64_t>(count), 4);
      check(!accepts(channel, bytes), "%s: count %ld", channel.name, count);
      // Counts whose size in bytes overflows 32 bits to the right number.
      bytes.resize(20);
      check(!accepts(channel, bytes) || (count == 0 && std::string(channel.name) == "obstacles"),
            "%s: count %ld and no data", channel.name, count);
    }
  }
}

void a_message_on_the_wrong_channel_is_rejected(void**) {
  for (const Channel& channel : channels())
    for (const Channel& other : channels())
      if (channel.name != other.name && std::string(channel.name) != other.name)
        check(!accepts(channel, other.good), "%s on the channel of %s", other.name, channel.name);
}

/// Every double of every message in turn. Unused doubles are ignored: a sphere's quaternion, and all doubles of an iiwa
/// status behind the measured positions and velocities. The unused sizes of a sphere need only be finite, as does the
/// third size of a capsule, which this test skips.
void an_impossible_double_is_rejected_in_every_field(void**) {
  const size_t capsule_at = 20, sphere_at = capsule_at + 134, numbers = 5;
  const auto unused = [&](const Channel& channel, size_t at, double bad) {
    if (std::string(channel.name) == "iiwa status") return at >= 20 + 8 * 2 * kJoints;
    if (std::string(channel.name) != "obstacles" || at < sphere_at) return false;
    const size_t number = (at - sphere_at - numbers) / 8;  // position 3, quaternion 4, size 3, velocity 3, rotation 3
    return (number >= 3 && number < 7) || ((number == 8 || number == 9) && std::isfinite(bad));
  };
  int tried = 0, ignored = 0;
  for (const Channel& channel : channels()) {
    const std::string name = channel.name;
    for (size_t at = name == "target" ? 16 : 20; at + 8 <= channel.good.size(); at += 8) {
      if (name == "obstacles" && at == capsule_at + 77) continue;
      if (name == "target" && at == 64) ++at;                                           // tracks_orientation
      if (name == "obstacles" && at == capsule_at + 133) ++at;                          // kind
      if (name == "obstacles" && (at == capsule_at || at == sphere_at)) at += numbers;  // id and shape
      for (const double bad : {kNan, -kNan, kInfinity, -kInfinity, 1e300, -1e300}) {
        Bytes bytes = channel.good;
        put_double(bytes, at, bad);
        const bool taken = accepts(channel, bytes);
        check(taken == unused(channel, at, bad), "%s: %g at byte %zu", channel.name, bad, at);
        if (taken)
          check(channel.plausible_value(), "%s: %g at byte %zu gives an implausible value", channel.name, bad, at);
        ++tried;
        ignored += taken;
      }
    }
  }
  check(tried == 6 * (14 + 13 + 31 + 49), "%d doubles tried", tried);
  check(ignored == 6 * (4 + 35) + 2 * 2, "%d ignored", ignored);
}

void impossible_obstacles_are_rejected(void**) {
  const Channel channel = channels()[2];
  const auto accepted = [&](void (*spoil)(obstacle_t&)) {
    obstacle_t bad = capsule();
    spoil(bad);
    return accepts(channel, encoded(obstacles_message(7, {capsule(), bad})));
  };
  assert_true(accepted([](obstacle_t&) {}));
  assert_true(accepted([](obstacle_t& o) { o.size[0] = o.size[1] = 0.0; }));  // a point
  assert_true(accepted([](obstacle_t& o) { o.shape = obstacle_t::SPHERE, o.quaternion[0] = 0.0; }));
  assert_false(accepted([](obstacle_t& o) { o.size[0] = -0.1; }));
  assert_false(accepted([](obstacle_t& o) { o.size[1] = -0.1; }));
  assert_false(accepted([](obstacle_t& o) { o.shape = obstacle_t::SPHERE, o.size[0] = -0.1; }));
  assert_false(accepted([](obstacle_t& o) { o.shape = obstacle_t::BOX, o.size[2] = -0.1; }));
  assert_false(accepted([](obstacle_t& o) { o.shape = obstacle_t::BOX, o.size[0] = 1e200; }));
  for (const double w : {0.0, 0.9, 1.1, -2.0}) {
    obstacle_t bad = capsule();
    bad.quaternion[0] = w;
    check(!accepts(channel, encoded(obstacles_message(7, {bad}))), "quaternion of length %g", w);
  }
  for (const int shape : {-128, -1, 4, 5, 127}) {
    obstacle_t bad = capsule();
    bad.shape = static_cast<int8_t>(shape);
    check(!accepts(channel, encoded(obstacles_message(7, {bad}))), "shape %d", shape);
  }
  for (const int kind : {-128, -1, 2, 127}) {
    obstacle_t bad = capsule();
    bad.kind = static_cast<int8_t>(kind);
    check(!accepts(channel, encoded(obstacles_message(7, {bad}))), "kind %d", kind);
  }
  assert_true(accepted([](obstacle_t& o) { o.shape = obstacle_t::CYLINDER, o.kind = obstacle_t::PERSON; }));
  assert_false(accepted([](obstacle_t& o) { o.shape = obstacle_t::CYLINDER, o.size[1] = -0.1; }));
}

void obstacles_of_the_layout_without_a_kind_are_rejected_with_that_reason(void**) {
  MessageDecoder decoder(kSidestepDialect, test::lwa3());
  Bytes bytes = encoded(obstacles_message(7, {}));
  int64_t utime = 0;
  assert_null(decoder.decode(Packet{bytes.data(), bytes.size()}, set, utime));
  const Bytes fingerprint_of_0_1 = {0x71, 0xee, 0xab, 0x81, 0x30, 0x4e, 0x51, 0x3c};
  std::copy(fingerprint_of_0_1.begin(), fingerprint_of_0_1.end(), bytes.begin());
  const char* reason = decoder.decode(Packet{bytes.data(), bytes.size()}, set, utime);
  check(reason && std::string(reason).find("kind") != std::string::npos, "%s", reason ? reason : "accepted");
}

void random_bytes_after_a_valid_fingerprint_never_crash(void**) {
  Random random(1);
  int accepted = 0;
  for (const Channel& channel : channels()) {
    // Made anew only after a message that was accepted: each has several MB.
    std::unique_ptr<TestInputs> gate = inputs_of(channel);
    for (int trial = 0; trial < 20000; ++trial) {
      Bytes bytes = channel.good;
      if (random.chance(0.3)) bytes.resize(static_cast<size_t>(random.index(400)));
      const size_t from = random.chance(0.5) ? 8 : 20;
      for (size_t i = from; i < bytes.size(); ++i)
        if (random.chance(0.3)) bytes[i] = static_cast<uint8_t>(random.bits());
      const bool taken = accepts(*gate, channel, bytes);
      if (!taken) continue;
      check(channel.plausible_value(), "%s, trial %d", channel.name, trial);
      gate = inputs_of(channel);
      ++accepted;
    }
  }
  check(accepted > 1000 && accepted < 20000, "%d of 80000 accepted", accepted);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(valid_messages_are_accepted),
      cmocka_unit_test(every_truncation_is_rejected),
      cmocka_unit_test(trailing_bytes_are_rejected),
      cmocka_unit_test(every_flipped_bit_is_rejected_or_gives_a_plausible_value),
      cmocka_unit_test(wrong_counts_are_rejected),
      cmocka_unit_test(a_message_on_the_wrong_channel_is_rejected),
      cmocka_unit_test(an_impossible_double_is_rejected_in_every_field),
      cmocka_unit_test(impossible_obstacles_are_rejected),
      cmocka_unit_test(obstacles_of_the_layout_without_a_kind_are_rejected_with_that_reason),
      cmocka_unit_test(random_bytes_after_a_valid_fingerprint_never_crash),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
