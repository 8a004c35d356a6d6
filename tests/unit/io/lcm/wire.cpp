#include "firmware/io/lcm/wire.h"

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <vector>

#include "firmware/base/realtime.h"
#include "tests/support/check.h"
#include "tests/support/datagram_sender.h"
#include "tests/support/datagrams.h"
#include "tests/support/lcm_peer.h"
#include "tests/support/lwa3.h"

using namespace sidestep;
using test::Bytes;
using test::private_lcm_url;

namespace {

const Channels kChannels;
const Neighbours kNeighbours{"", {"LEFT"}, Eigen::Isometry3d::Identity()};

/// A wire whose handlers note what arrives.
struct NotingWire {
  Wire wire{private_lcm_url(), {kChannels, kNeighbours, kSidestepDialect, test::lwa3()}};
  std::string order;  ///< a letter for each message
  Bytes last;
  std::vector<double> received_s;

  NotingWire() {
    wire.on_arm_state(note('a'));
    wire.on_target(note('t'));
    wire.on_obstacles(note('o'));
    wire.on_neighbour(0, note('l'));
    wire.on_foreign_command(false, [this] { order += 'f'; });
  }
  PacketHandler note(char letter) {
    return [this, letter](Packet packet) {
      order += letter;
      last.assign(packet.bytes, packet.bytes + packet.size);
      received_s.push_back(wire.received_s());
    };
  }
  /// Receives until nothing has arrived for 200 ms.
  void drain() {
    for (int silent = 0; silent < 10;) silent = wire.receive(20) ? 0 : silent + 1;
  }
};

std::ptrdiff_t threads() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
}

/// The receiving thread of liblcm is what crafted datagrams end.
void a_wire_starts_no_thread(void**) {
  const std::ptrdiff_t before = threads();
  NotingWire noting;
  noting.wire.publish(LoopTiming(), 1);
  noting.drain();
  assert_int_equal(threads(), before);
}

void messages_arrive_whole_and_in_order(void**) {
  NotingWire noting;
  test::LcmPeer peer;
  Bytes full_set = test::encoded(test::obstacles_message(1, std::vector<obstacle_t>(kMaxObstacles)));
  for (size_t i = 0; i < full_set.size(); ++i) full_set[i] = static_cast<uint8_t>(i * i >> 7);
  peer.send_bytes("ARM_STATE", Bytes(50, 1));
  peer.send_bytes("NOTHING", Bytes(50, 2));
  peer.send_bytes("TARGET", Bytes(60000, 3));
  peer.send_bytes("LEFT", Bytes(50, 4));
  // Received piece by piece, for a kernel that grants little.
  test::DatagramSender sender(private_lcm_url());
  for (const test::Fragment& fragment : test::fragments(
           "OBSTACLES", 1, full_set, {60000, 120000, 180000, 240000, 300000, 360000, 420000, 480000, 540000})) {
    sender.send(fragment.datagram());
    noting.drain();
  }
  assert_string_equal(noting.order.c_str(), "atlo");
  assert_true(noting.last == full_set);
}

/// qemu's sockets give neither the time of a datagram nor the number of those that were lost.
void needs_a_real_kernel() {
  if (std::getenv("EMULATED")) _skip(__FILE__, __LINE__);
}

/// A process that was stopped reads all that has waited in one moment.
void a_message_has_the_time_when_it_reached_the_machine(void**) {
  needs_a_real_kernel();
  NotingWire noting;
  test::LcmPeer peer;
  double sent_s[3];
  for (double& s : sent_s) {
    s = monotonic_s();
    peer.send_bytes("TARGET", Bytes(50, 3));
    sleep_until(s + 0.2);
  }
  noting.drain();
  assert_int_equal(noting.received_s.size(), 3);
  for (size_t i = 0; i < 3; ++i) {
    const double late_s = noting.received_s[i] - sent_s[i];
    check(late_s > -0.001 && late_s < 0.1, "message %zu: %.4f s after it was sent", i, late_s);
  }
}

void a_message_that_is_too_large_is_handed_over_for_rejection(void**) {
  NotingWire noting;
  test::LcmPeer peer;
  peer.send_bytes("OBSTACLES", test::encoded(test::obstacles_message(1, std::vector<obstacle_t>(kMaxObstacles + 1))));
  noting.drain();
  assert_string_equal(noting.order.c_str(), "o");
  assert_true(noting.last.size() < 65536);
}

void own_commands_are_not_foreign(void**) {
  NotingWire noting;
  const Command command{JointVector::Zero(7), JointVector::Zero(7)};
  noting.wire.publish(command, 123, 1);
  noting.drain();
  assert_string_equal(noting.order.c_str(), "");
  test::LcmPeer peer;
  joint_command_t foreign{};
  foreign.utime = 124;
  peer.send("ARM_COMMAND", foreign);
  noting.drain();
  assert_string_equal(noting.order.c_str(), "f");
}

void what_is_malformed_or_incomplete_is_counted(void**) {
  NotingWire noting;
  test::DatagramSender sender(private_lcm_url());
  sender.send({1, 2, 3});
  for (uint32_t i = 0; i < 3; ++i) sender.send(test::fragments("TARGET", i, Bytes(100, 1), {50})[0].datagram());
  noting.drain();
  const Reception reception = noting.wire.reception();
  assert_int_equal(reception.malformed_datagrams, 1);
  assert_int_equal(reception.incomplete_messages, 1);  // the other two may still be completed
  assert_int_equal(reception.lost_datagrams, 0);
  assert_string_equal(noting.order.c_str(), "");
}

void what_the_receive_buffer_cannot_hold_is_counted(void**) {
  needs_a_real_kernel();
  NotingWire noting;
  test::DatagramSender sender(private_lcm_url());
  for (int i = 0; i < 2000; ++i) sender.send(Bytes(60000, 1));  // 120 MB
  noting.drain();
  const Reception reception = noting.wire.reception();
  assert_true(reception.lost_datagrams > 0);
  assert_int_equal(reception.lost_datagrams + reception.malformed_datagrams, 2000);
}

void a_network_that_cannot_be_used_is_named(void**) {
  const WireSetup setup{kChannels, kNeighbours, kSidestepDialect, test::lwa3()};
  for (const char* url : {"memq://", "udpm://239.255.76.67:7667?speed=9"}) {
    const std::string message = test::message_of([&] { Wire(url, setup); });
    check(test::one_line_with(message, {"LCM: cannot use the network '", url}), "%s", message.c_str());
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_wire_starts_no_thread),
      cmocka_unit_test(messages_arrive_whole_and_in_order),
      cmocka_unit_test(a_message_has_the_time_when_it_reached_the_machine),
      cmocka_unit_test(a_message_that_is_too_large_is_handed_over_for_rejection),
      cmocka_unit_test(own_commands_are_not_foreign),
      cmocka_unit_test(what_is_malformed_or_incomplete_is_counted),
      cmocka_unit_test(what_the_receive_buffer_cannot_hold_is_counted),
      cmocka_unit_test(a_network_that_cannot_be_used_is_named),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
