#pragma once

#include <optional>
#include <random>

#include "host/sim/joints.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// Noise and loss of the messages to the controller in real time. In lockstep all messages arrive unchanged.
struct SensingSpec {
  double joint_noise_rad = 0.0;   ///< standard deviation, of each joint
  double obstacle_noise_m = 0.0;  ///< standard deviation, of each coordinate of an obstacle
  double lost_share = 0.0;        ///< share of the messages that are lost
  int seed = 1;
};

class Sensing {
 public:
  explicit Sensing(const SensingSpec& spec) : spec_(spec), engine_(static_cast<unsigned>(spec.seed)) {}

  /// The values with noise, as sent to the controller; nothing for a lost message.
  std::optional<JointVector> joints(JointVector q_rad);
  std::optional<Target> target(const Target& target);
  std::optional<std::vector<Obstacle>> obstacles(std::vector<Obstacle> obstacles);

 private:
  bool lost() { return std::uniform_real_distribution<double>()(engine_) < spec_.lost_share; }
  double noise(double deviation) { return deviation * std::normal_distribution<double>()(engine_); }

  SensingSpec spec_;
  std::mt19937_64 engine_;
};

}  // namespace sidestep::sim
