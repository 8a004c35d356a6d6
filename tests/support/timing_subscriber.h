#pragma once

#include <lcm/lcm-cpp.hpp>
#include <sidestep/loop_timing_t.hpp>
#include <string>
#include <vector>

#include "tests/support/lcm_peer.h"

namespace sidestep::test {

/// Stores the messages of LOOP_TIMING.
struct TimingSubscriber {
  lcm::LCM lcm{private_lcm_url()};
  std::vector<loop_timing_t> received;

  TimingSubscriber() { lcm.subscribe("LOOP_TIMING", &TimingSubscriber::on_timing, this); }
  void on_timing(const lcm::ReceiveBuffer*, const std::string&, const loop_timing_t* timing) {
    received.push_back(*timing);
  }
  void drain() {
    while (lcm.handleTimeout(0) > 0) {
    }
  }
};

}  // namespace sidestep::test
