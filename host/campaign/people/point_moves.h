#pragma once

#include <Eigen/Core>
#include <vector>

namespace sidestep::campaign {

/// A point that moves from rest to rest on straight lines with minimum jerk, as hands do (Flash and Hogan, 1985). The
/// largest speed of a move is kPeakSpeed length / duration, the largest acceleration kPeakAcceleration length /
/// duration^2.
class PointMoves {
 public:
  static constexpr double kPeakSpeed = 1.875, kPeakAcceleration = 5.7735;

  explicit PointMoves(const Eigen::Vector3d& start_m) : start_m_(start_m) {}

  void wait(double duration_s) { end_s_ += duration_s; }
  void move_to(const Eigen::Vector3d& point_m, double duration_s);

  Eigen::Vector3d at(double t_s) const;
  double end_s() const { return end_s_; }

 private:
  struct Move {
    double begin_s, duration_s;
    Eigen::Vector3d to_m;
  };

  Eigen::Vector3d start_m_;
  std::vector<Move> moves_;
  double end_s_ = 0.0;
};

}  // namespace sidestep::campaign
