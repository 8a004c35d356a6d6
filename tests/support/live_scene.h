#pragma once

#include "tests/support/live_arm.h"
#include "tests/support/process.h"

namespace sidestep::test {

/// A controller in real time on the LWA3, on this process's network. before: a program that starts it, with arguments.
Process start_controller(const std::string& law, std::vector<std::string> before = {});

/// Fails the test when a command was one that the arm cannot follow, or too many were lost to tell.
void check_stream(const LiveArm& arm);

/// A controller in real time that is moving the arm.
struct LiveScene {
  explicit LiveScene(const std::string& law);

  /// Gives the arm a new target now and then.
  void wander(double duration_s);

  Process controller;
  LiveArm arm;
};

}  // namespace sidestep::test
