#pragma once

#include <deque>
#include <vector>

#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// A set of obstacles as it reaches the controller.
struct Sighting {
  int64_t received_us = 0;
  int64_t count = 0;  ///< of sightings received so far
  std::vector<Moving> spheres;
};

/// How the controller sees the obstacles. Exact: as they are, in every cycle. Real: 30 times a second, 40 ms old, with
/// noise on the position, and one in ten is lost.
class Sensing {
 public:
  explicit Sensing(const Scene& scene);

  /// The newest sighting at `now_us` of the controller's clock, when the scene's time is `t_s`. To be called in the
  /// order of time.
  const Sighting& look(int64_t now_us, double t_s);

 private:
  void capture(int64_t at_us, double t_s);

  const Scene& scene_;
  Random random_;
  int64_t next_capture_ = 0;  ///< number of the next one, real only
  std::deque<Sighting> on_the_way_;
  Sighting newest_;
};

}  // namespace sidestep::campaign
