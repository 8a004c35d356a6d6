#pragma once

#include <vector>

#include "host/campaign/judge_arm.h"

namespace sidestep::campaign {

/// A joint path over time: straight in joint space from one knot to the next with the profile 3u^2 - 2u^3, so that the
/// arm stops at every knot. Before the first knot and after the last one it rests.
class TimedPath {
 public:
  TimedPath() = default;

  /// Through these postures, two or more, as fast as the share of the velocity and acceleration limits permits.
  TimedPath(std::vector<Joints> knots_rad, const Limits& limits, double share);

  bool empty() const { return knots_rad_.empty(); }
  const std::vector<Joints>& knots_rad() const { return knots_rad_; }
  double duration_s() const { return times_s_.back(); }
  /// Euclidean, in joint space.
  double length_rad() const;

  Joints position_rad(double t_s) const;
  Joints velocity_radps(double t_s) const;

 private:
  /// Index of the knot that ends the segment at this time, which is between the first and the last knot's.
  size_t segment_end(double t_s) const;

  std::vector<Joints> knots_rad_;
  std::vector<double> times_s_;  ///< of each knot, from 0
};

}  // namespace sidestep::campaign
