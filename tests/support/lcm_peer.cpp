#include "tests/support/lcm_peer.h"

#include <unistd.h>

#include <chrono>

#include "tests/support/check.h"

namespace sidestep::test {

std::string private_lcm_url(int number) {
  // Below the ephemeral ports of the system, as sockets on those cannot be shared, and below those of scripts.
  const int port = 10000 + 2 * (getpid() % 5000) + number;
  return "udpm://239.255.76." + std::to_string(67 + number) + ":" + std::to_string(port) + "?ttl=0";
}

LcmPeer::LcmPeer(const std::string& suffix) : lcm_(private_lcm_url()) {
  send_to(private_lcm_url());
  check(lcm_.good(), "no LCM at %s", private_lcm_url().c_str());
  lcm_.subscribe("ARM_COMMAND" + suffix, &LcmPeer::on_command, this)->setQueueCapacity(10000);
  lcm_.subscribe("CONTROLLER_STATUS" + suffix, &LcmPeer::on_status, this)->setQueueCapacity(10000);
}

void LcmPeer::send_bytes(const std::string& channel, const Bytes& bytes) {
  out_->publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
}

void LcmPeer::send_to(const std::string& url) {
  out_ = std::make_unique<lcm::LCM>(url);
  check(out_->good(), "no LCM at %s", url.c_str());
}

bool LcmPeer::await(const std::function<bool()>& condition, double limit_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (!condition()) {
    const auto left = std::chrono::duration<double, std::milli>(end - std::chrono::steady_clock::now()).count();
    if (left <= 0) return false;
    lcm_.handleTimeout(static_cast<int>(left) + 1);
  }
  return true;
}

void LcmPeer::listen(double duration_s) {
  await([] { return false; }, duration_s);
}

void LcmPeer::drain() {
  while (lcm_.handleTimeout(0) > 0) continue;
}

void LcmPeer::on_command(const lcm::ReceiveBuffer* buffer, const std::string&, const joint_command_t* message) {
  const auto* bytes = static_cast<const uint8_t*>(buffer->data);
  commands.push_back(*message);
  command_bytes.emplace_back(bytes, bytes + buffer->data_size);
  order += 'c';
}

void LcmPeer::on_status(const lcm::ReceiveBuffer*, const std::string&, const controller_status_t* message) {
  statuses.push_back(*message);
  order += 's';
}

}  // namespace sidestep::test
