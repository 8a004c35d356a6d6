#pragma once

#include "tests/support/live_arm.h"
#include "tests/support/process.h"

namespace sidestep::test {

/// Starts a real-time controller for the LWA3 on this process's network. before: a program that starts it, with
/// arguments.
Process start_controller(const std::string& law, std::vector<std::string> before = {});

/// Whether at most 5 % of the commands were lost.
bool lost_few(const LiveArm& arm);

/// Fails the test if the arm could not have followed one of the commands, or if more than 5 % of them were lost.
void check_stream(const LiveArm& arm);

/// A real-time controller that is moving the arm.
struct LiveScene {
  explicit LiveScene(const std::string& law);

  /// Sends a new target every 0.4 s.
  void wander(double duration_s);

  Process controller;
  LiveArm arm;
};

}  // namespace sidestep::test
