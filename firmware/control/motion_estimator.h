#pragma once

#include <array>

#include "firmware/base/bounded_list.h"
#include "firmware/control/obstacle_order.h"

namespace sidestep {

/// Estimates the velocities of obstacles whose sender gives none: a linear or angular velocity that is reported as 0
/// becomes the slope of the last reported positions, or axes, if these move.
///
/// - Slope: of the least-squares line through the report and up to three earlier ones, 25 ms or more apart and at most
///   0.35 s old.
/// - Rest: a point rests that has stayed within a radius of where it was for 0.4 s. The radius is 2 cm, or seven times
/// the
///   standard deviation of the point's noise, which is estimated from the deviations of reports from the line between
///   their neighbours. An obstacle at rest keeps the velocity 0, whatever the noise.
/// - A point that moves faster than 8 m/s between two reports is another obstacle under the same id: it begins anew.
///
/// The angular velocity is that of the axis, perpendicular to it; a sphere has none, and a box or cylinder that spins
/// about its axis is not noticed. Obstacles are matched by id, also if sets in between lack them; obstacles with the
/// same id are matched in the order of the message. Large: lives on the heap, like an ObstacleSet.
class MotionEstimator {
 public:
  /// Sets the velocities of a new set. elapsed_s: since the set before. Work is bounded by n log n; nothing is
  /// allocated.
  void complete(ObstacleSet& set, double elapsed_s);

 private:
  /// One point of an obstacle: its centre, or the end of its half axis from the centre. Base frame.
  class Point {
   public:
    /// Adds a report. Returns the velocity, m/s; 0 if the point rests.
    Vector3 velocity_mps(const Vector3& now_m, double now_s);

   private:
    struct Report {
      double at_s;
      Vector3 at_m;
    };
    void begin(const Report& now);
    void remember(const Report& now);
    bool rests(const Report& now);
    Vector3 slope_mps(const Report& now) const;

    BoundedList<Report, 3> earlier_;  ///< the newest first
    Report anchor_;                   ///< where it was when it was last found to rest or to have moved
    bool moves_ = false;
    double noise2_m2_ = 0.0;  ///< variance of a coordinate
  };

  struct Track {
    int32_t id = 0;
    Shape shape = Shape::kSphere;
    double reported_s = 0.0;
    Point centre, axis;
    Vector3 half_axis_m = Vector3::Zero();
  };

  static void complete(Obstacle& obstacle, Track& track, double now_s);

  double now_s_ = 0.0;
  ObstacleOrder order_;                         ///< of the new set
  std::array<Track, kMaxObstacles> tracks_[2];  ///< sorted by id. Two buffers: the current list and the next one
  int count_ = 0, current_ = 0;
};

}  // namespace sidestep
