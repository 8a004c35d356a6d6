#pragma once

#include <deque>
#include <vector>

#include "firmware/model/obstacle.h"
#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// A person's capsule as the controller receives it, exact.
Obstacle person_obstacle(const CapsuleMotion& motion);

/// A tracker of persons: it measures the ends of the capsules' axes with noise and estimates velocities by finite
/// differences over its last four sets, 0.1 s. Now and then it takes two neighbours of one person for each other for a
/// while, such as the hands.
class Camera {
 public:
  static constexpr int64_t kRate_hz = 30, kDelay_us = 50'000;
  static constexpr double kLoss = 0.10;      ///< share of the sets that are lost
  static constexpr double kSwap = 0.005;     ///< share of the sets with which such a confusion begins
  static constexpr double kSwapped_s = 0.2;  ///< its duration

  /// The noise of a coordinate is drawn for the scene: 5 to 10 mm standard deviation.
  explicit Camera(const Scene& scene);

  /// The obstacles from a picture taken at this time of the camera's clock and of the scene; false if the set is lost.
  bool capture(double clock_s, double t_s, std::vector<Obstacle>& obstacles);

 private:
  struct Set {
    double clock_s;
    std::vector<CapsulePath::Ends> ends;
  };

  void draw_swap(double clock_s);

  const Scene& scene_;
  Random random_;
  double noise_m_;
  std::deque<Set> sets_;
  size_t swapped_ = 0;  ///< index of the first of the two
  double swapped_until_s_ = -1.0;
};

}  // namespace sidestep::campaign
