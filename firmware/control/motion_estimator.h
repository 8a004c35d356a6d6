#pragma once

#include <array>

#include "firmware/base/bounded_list.h"
#include "firmware/control/obstacle_order.h"

namespace sidestep {

/// Completes what senders tell about the motion of obstacles: estimates the velocities that they do not give, and what
/// the velocities will shortly be.
///
/// A linear or angular velocity that is reported as 0 becomes the slope of the last reported positions, or axes, if
/// these move.
///
/// - Slope: of the least-squares line through the report and up to three earlier ones, 25 ms or more apart and at most
///   0.35 s old.
/// - Noise: the standard deviation of a report, estimated from the deviations of reports from the line between their
///   neighbours.
/// - Rest: a point rests that has stayed within a radius of where it was for 0.4 s. The radius is 2 cm, or seven times
///   the point's noise. An obstacle at rest keeps the velocity 0, whatever the noise.
/// - A point that moves faster than 8 m/s between two reports is another obstacle under the same id: it begins anew.
///
/// A linear velocity v, reported or estimated, becomes v + 0.2 s a (the lead, at most 0.5 m/s, Obstacle::lead_mps):
/// whatever predicts at constant velocity thus follows an obstacle that turns or starts. The acceleration a is the
/// slope of the velocities. Of a only what stands out from the noise counts: a (1 - (5 s / |a|)^2), or 0, with the
/// standard deviation s of the slope. An obstacle at rest whose velocity is not reported has no lead, nor do the links
/// of other arms.
///
/// The mean velocity of a person is (p - m) / 0.5 s, where m is the exponential mean of the reported positions p with
/// this time constant; below 0.15 m/s it is 0. Limbs swing about a body that walks on.
///
/// The angular velocity is that of the axis, perpendicular to it; a sphere has none, and a box or cylinder that spins
/// about its axis is not noticed. Where the axis of a box turns by more than 45 degrees between two reports, another
/// edge of the box has become the longest, and the estimate begins anew. Obstacles are matched by id, also if sets in
/// between lack them; obstacles with the same id are matched in the order of the message. Large: lives on the heap,
/// like an ObstacleSet.
class MotionEstimator {
 public:
  /// leads: whether velocities get a lead.
  explicit MotionEstimator(bool leads = true) : leads_(leads) {}

  /// Sets the velocities of a new set. elapsed_s: since the set before. Work is bounded by n log n; nothing is
  /// allocated.
  void complete(ObstacleSet& set, double elapsed_s);

 private:
  /// A reported position or velocity.
  struct Report {
    double at_s;
    Vector3 value;
  };

  /// The last reports of a position or velocity, in the base frame.
  class History {
   public:
    struct Slope {
      Vector3 per_s;
      double variance_per_s2;  ///< of a coordinate, by the noise of the reports; infinite while that is unknown
    };
    bool is_empty() const { return earlier_.size() == 0; }
    const Report& newest() const { return earlier_[0]; }
    double noise2() const { return noise2_; }
    /// Forgets the reports, not the noise.
    void clear() { earlier_.clear(); }
    /// Keeps a report if the newest one is old enough, and learns the noise.
    void remember(const Report& now);
    Slope slope(const Report& now) const;

   private:
    BoundedList<Report, 3> earlier_;  ///< the newest first
    double noise2_ = 0.0;             ///< variance of a coordinate
    int learned_ = 0;                 ///< deviations that noise2_ is the mean of, up to kNoiseDeviations
  };

  /// One point of an obstacle: its centre, or the end of its half axis from the centre.
  class Point {
   public:
    /// Adds a report. Returns the velocity, m/s; 0 if the point rests.
    Vector3 velocity_mps(const Report& now);
    bool moves() const { return moves_; }
    /// Whether the last report was of another obstacle than the one before, or the first.
    bool began() const { return began_; }

   private:
    bool rests(const Report& now);

    History positions_;
    Report anchor_{0.0, Vector3::Zero()};  ///< where it was when it was last found to rest or to have moved
    bool moves_ = false;
    bool began_ = true;
  };

  struct Track {
    int32_t id = 0;
    Shape shape = Shape::kSphere;
    double reported_s = 0.0;
    Point centre, axis;
    History velocities;
    Vector3 mean_position_m = Vector3::Zero();  ///< of a person's centre: exponential, kMean_s
    Vector3 half_axis_m = Vector3::Zero();
  };

  static Vector3 lead_mps(const Report& velocity_mps, History& velocities);
  static Vector3 mean_velocity_mps(const Obstacle& obstacle, Track& track, double now_s);
  void complete(Obstacle& obstacle, Track& track) const;

  bool leads_;
  double now_s_ = 0.0;
  ObstacleOrder order_;                         ///< of the new set
  std::array<Track, kMaxObstacles> tracks_[2];  ///< sorted by id. Two buffers: the current list and the next one
  int count_ = 0, current_ = 0;
};

}  // namespace sidestep
