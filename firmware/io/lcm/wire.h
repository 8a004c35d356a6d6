#pragma once

#include <functional>
#include <memory>
#include <string>

#include "firmware/io/config/config.h"
#include "firmware/io/lcm/encoder.h"

namespace sidestep {

/// Bytes of a message, valid during the call.
using ByteHandler = std::function<void(const void* bytes, size_t size)>;

/// The LCM network: raw bytes in, commands and reports out.
class Wire {
 public:
  /// url empty: LCM's own default. Throws std::runtime_error when the network cannot be used.
  Wire(const std::string& url, const Config& config);
  ~Wire();

  /// Handlers run inside receive(), in the order of arrival, and must not throw. Call before the first receive().
  void on_arm_state(ByteHandler handler);
  void on_target(ByteHandler handler);
  void on_obstacles(ByteHandler handler);
  /// Links of the k-th neighbour, k from 0.
  void on_neighbour(size_t k, ByteHandler handler);
  /// Commands on our own command channel that this Wire has not sent. In lockstep all controllers of an arm answer with
  /// the same utime: there the second one with it is foreign.
  void on_foreign_command(bool lockstep, std::function<void()> handler);

  /// Handles one message, or waits for one for at most timeout_ms. Returns whether one was handled.
  bool receive(int timeout_ms);

  /// Send without allocating; may be called from another thread than receive().
  void publish(const Command& command, int64_t utime, int64_t seq);
  void publish(const Report& report, const CycleRecord& record);
  /// Our own links, if anybody is to be told.
  void publish(const ArmState& arm, int64_t utime);
  void publish(const Timing& timing, int64_t utime);

 private:
  struct Network;
  std::unique_ptr<Network> network_;
};

}  // namespace sidestep
