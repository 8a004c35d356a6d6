#pragma once

#include <deque>
#include <vector>

#include "firmware/model/obstacle.h"
#include "host/campaign/people/camera.h"
#include "host/campaign/random.h"
#include "host/campaign/scene.h"

namespace sidestep::campaign {

/// An obstacle set as the controller receives it.
struct ObstacleMeasurement {
  int64_t received_us = 0;
  int64_t count = 0;                ///< number of sets received so far, this one included
  std::vector<Obstacle> obstacles;  ///< base frame; the id of each is its index
  std::vector<size_t> order;        ///< of the indices in the message; empty: as above
};

/// Model of the obstacle sensor. Family real: 30 sets a second, 40 ms old, positions with noise, one set in ten is
/// lost. Families with a camera: people/camera.h. Other families: the exact set in every cycle. Velocities only if the
/// scene reports them, and in the same order in all sets unless the scene shuffles them.
class Sensing {
 public:
  explicit Sensing(const Scene& scene);

  /// The newest set at `now_us` of the controller's clock, when the scene's time is `t_s`; its contents are those of
  /// Scene::ahead_s later. To be called with times that never decrease.
  const ObstacleMeasurement& newest_at(int64_t now_us, double t_s);

 private:
  ObstacleMeasurement exact(int64_t now_us, double t_s) const;
  void capture(int64_t at_us, double t_s);
  void receive(ObstacleMeasurement measurement);
  void shuffle(ObstacleMeasurement& measurement);
  void capture_spheres(int64_t at_us, double t_s);
  void capture_people(int64_t at_us, double t_s);

  const Scene& scene_;
  Random random_;
  Camera camera_;
  int64_t next_capture_ = 0;  ///< number of the next capture; not with exact sets
  std::deque<ObstacleMeasurement> in_transit_;
  ObstacleMeasurement newest_;
};

}  // namespace sidestep::campaign
