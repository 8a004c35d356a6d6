#pragma once

#include <optional>
#include <random>

#include "host/sim/joints.h"
#include "host/sim/world.h"

namespace sidestep::sim {

/// What becomes of the truth on its way to the controller in real time; in lockstep it arrives as it is.
struct SensingSpec {
  double joint_noise_rad = 0.0;   ///< standard deviation, each joint
  double obstacle_noise_m = 0.0;  ///< likewise, each axis of an obstacle's position
  double lost_share = 0.0;        ///< of all messages
  int seed = 1;
};

class Sensing {
 public:
  explicit Sensing(const SensingSpec& spec) : spec_(spec), engine_(static_cast<unsigned>(spec.seed)) {}

  /// As the controller is told, or nothing for a message that is lost.
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
