#pragma once

#include <cstdint>
#include <memory>

#include "firmware/control/types/settings.h"
#include "firmware/io/lcm/channels.h"
#include "firmware/io/lcm/dialect.h"
#include "firmware/io/lcm/received.h"

namespace sidestep {

/// The inbound side of a loop: decodes each message (message_decoder.h), merges the obstacles of several senders
/// (obstacle_merger.h; without neighbours the set goes on unchanged), passes the value through the input gate
/// (input_gate.h) and counts rejected messages. Does not throw; its buffers grow to the largest message of each kind
/// seen so far. Large: lives on the heap.
///
/// Owners: the socket owns the bytes of a packet, which are valid during the call. The caller owns `received`. In real
/// time a receiving thread makes all calls; there `received` is the draft slot of a triple buffer, one for each kind of
/// message. The thread numbers an accepted message (Received::count) and publishes the slot; the loop's thread reads
/// the newest one. In lockstep the loop's thread does all of this.
class NetworkInputs {
 public:
  /// The arm outlives this.
  NetworkInputs(const Settings& settings, const Arm& arm, const Dialect& dialect, const Neighbours& neighbours,
                bool lockstep);
  ~NetworkInputs();

  /// Each returns whether the message was accepted. Then `received` holds its value, its bytes and its receipt time;
  /// otherwise its content is arbitrary. For a set merged from several senders the bytes are empty, and the receipt
  /// time is that of the oldest part. Received::count is not changed. now_s: local time of receipt.
  bool receive(Packet packet, double now_s, Received<ArmState>& received);
  bool receive(Packet packet, double now_s, Received<Target>& received);
  /// A message of JOINT_TARGET. Into the same slot as TARGET, so that the newest of both counts.
  bool receive_joint_target(Packet packet, double now_s, Received<Target>& received);
  bool receive(Packet packet, double now_s, Received<OtherJoints>& received);
  bool receive(Packet packet, double now_s, Received<Control>& received);
  bool receive(Packet packet, double now_s, Received<Attachments>& received);
  /// part 0: the own channel; part k: the k-th neighbour, from 1.
  bool receive_obstacles(size_t part, Packet packet, double now_s, Received<ObstacleSet>& received);

  int64_t rejected() const { return rejected_; }
  const char* last_reason() const { return reason_; }  ///< of the last rejection; "" before the first

 private:
  struct Parts;
  bool reject(const char* reason);
  template <typename Message>
  bool receive_value(Packet packet, double now_s, Received<Message>& received);
  template <typename Message>
  bool accept(Packet packet, double now_s, Received<Message>& received);

  std::unique_ptr<Parts> parts_;
  int64_t rejected_ = 0;
  const char* reason_ = "";
};

}  // namespace sidestep
