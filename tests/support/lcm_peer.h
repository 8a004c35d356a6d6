#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <sidestep/controller_status_t.hpp>
#include <sidestep/joint_command_t.hpp>
#include <string>
#include <vector>

#include "tests/support/messages.h"

namespace sidestep::test {

/// LCM networks private to this process: multicast that stays on this machine, on ports derived from the process id.
std::string private_lcm_url(int number = 0);

/// LCM peer of the controller: sends the messages of an arm and a world, stores all messages of the controller.
class LcmPeer {
 public:
  /// suffix: of the channels that it subscribes to.
  explicit LcmPeer(const std::string& suffix = "");

  template <typename Message>
  void send(const std::string& channel, const Message& message) {
    send_bytes(channel, encoded(message));
  }
  void send_bytes(const std::string& channel, const Bytes& bytes);
  /// From now on sends to another network; the subscriptions stay on the old one.
  void send_to(const std::string& url);

  /// Receives until the condition holds, for at most limit_s. Returns whether it does.
  bool await(const std::function<bool()>& condition, double limit_s);
  /// Receives all pending messages.
  void drain();
  /// Receives for a while.
  void listen(double duration_s);

  std::vector<joint_command_t> commands;
  std::vector<controller_status_t> statuses;
  std::vector<Bytes> command_bytes;
  std::string order;  ///< a letter for each message in order of arrival: c (command) or s (status)

 private:
  void on_command(const lcm::ReceiveBuffer* buffer, const std::string& channel, const joint_command_t* message);
  void on_status(const lcm::ReceiveBuffer* buffer, const std::string& channel, const controller_status_t* message);

  lcm::LCM lcm_;
  std::unique_ptr<lcm::LCM> out_;
};

}  // namespace sidestep::test
