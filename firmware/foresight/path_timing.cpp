#include "firmware/foresight/path_timing.h"

#include <algorithm>
#include <cmath>

#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr double kLargestBlend_rad = 0.4;
constexpr double kLongestShare = 0.45;  // of a side
constexpr int kMostHalvings = 5;
constexpr int kMostPoints = 64;
constexpr int kPointsOfBlend = 16;
constexpr int kSpeedSamples = 16;     // of a side
constexpr double kNegligible = 1e-9;  // of a length, rad

/// A straight part of the path between two blended corners.
struct Straight {
  JointVector direction;  ///< of length 1
  double length_rad;      ///< of the whole side
  double fastest_radps;   ///< along the direction
  double acceleration_radps2;
};

/// The corner at the end of a straight part.
struct Corner {
  double blend_rad = 0.0;    ///< how far before and after it the parabola touches the sides; 0: the arm stops
  double speed_radps = 0.0;  ///< along the sides
};

/// The largest factor that keeps |factor * direction| within the bounds.
double largest_factor(const JointVector& bounds, const JointVector& direction) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < direction.size(); ++i)
    if (std::abs(direction[i]) > 0.0) least = std::min(least, bounds[i] / std::abs(direction[i]));
  return least;
}

/// The speed along `direction` at which the tool is as fast as fastest_mps at the fastest of the points sampled.
double speed_for_tool(const Arm& arm, const JointVector& from_rad, const JointVector& to_rad,
                      const JointVector& direction, double fastest_mps) {
  if (!std::isfinite(fastest_mps)) return fastest_mps;
  double tool_m = kNegligible;  // per length of the direction
  for (int i = 0; i <= kSpeedSamples; ++i) {
    const JointVector q_rad = from_rad + (to_rad - from_rad) * (static_cast<double>(i) / kSpeedSamples);
    tool_m = std::max(tool_m, (tool_jacobian(forward_kinematics(arm, q_rad), 3) * direction).norm());
  }
  return fastest_mps / tool_m;
}

class Timing {
 public:
  Timing(const Arm& arm, const JointPath& path_rad, double share, const IsFree& is_free, double fastest_mps)
      : path_rad_(path_rad), accelerations_(share * arm.limits.acceleration_radps2), is_free_(is_free) {
    const JointVector velocities = share * arm.limits.velocity_radps;
    for (int i = 1; i < path_rad.size(); ++i) {
      const JointVector way = path_rad[i] - path_rad[i - 1];
      const double length = euclidean_norm(way, arm.joint_scale);
      const JointVector direction = way / length;
      const double fastest = std::min(largest_factor(velocities, direction),
                                      speed_for_tool(arm, path_rad[i - 1], path_rad[i], direction, fastest_mps));
      straights_.add({direction, length, fastest, largest_factor(accelerations_, direction)});
    }
    for (int i = 0; i + 1 < straights_.size(); ++i) corners_.add(blended(i));
    limit_speeds();
  }

  Guide guide(double start_s) const {
    Guide guide;
    guide.foresight_status = ForesightStatus::kGuided;
    guide.add(start_s, path_rad_[0]);
    for (int i = 0; i < straights_.size(); ++i) {
      if (guide.knots + 4 > kMaxKnots) return {};
      add_straight(i, guide);
      if (i < corners_.size() && corners_[i].blend_rad > 0.0) add_blend(i, guide);
    }
    return guide;
  }

 private:
  Corner blended(int i) const {
    const Straight &before = straights_[i], &after = straights_[i + 1];
    Corner corner;
    corner.blend_rad = std::min(kLargestBlend_rad, kLongestShare * std::min(before.length_rad, after.length_rad));
    for (int halvings = 0; !is_blend_free(i, corner.blend_rad); ++halvings) {
      if (halvings == kMostHalvings) return {};
      corner.blend_rad *= 0.5;
    }
    // The acceleration of the parabola is speed^2 (after - before) / (2 blend).
    const double by_acceleration =
        2.0 * corner.blend_rad * largest_factor(accelerations_, after.direction - before.direction);
    corner.speed_radps = std::min({before.fastest_radps, after.fastest_radps, std::sqrt(by_acceleration)});
    return corner;
  }

  bool is_blend_free(int i, double blend_rad) const {
    const JointVector &before = straights_[i].direction, &after = straights_[i + 1].direction;
    for (int k = 1; k < kPointsOfBlend; ++k) {
      const double u = static_cast<double>(k) / kPointsOfBlend;
      if (!is_free_(path_rad_[i + 1] + blend_rad * (u * u * after - (1.0 - u) * (1.0 - u) * before))) return false;
    }
    return true;
  }

  double blend_rad(int corner) const { return corner < corners_.size() ? corners_[corner].blend_rad : 0.0; }
  double speed_radps(int corner) const { return corner < corners_.size() ? corners_[corner].speed_radps : 0.0; }
  /// Between its blends.
  double clear_length_rad(int i) const {
    return std::max(0.0, straights_[i].length_rad - blend_rad(i) - (i > 0 ? blend_rad(i - 1) : 0.0));
  }

  /// Lowers the speeds at corners to what the straight parts permit.
  void limit_speeds() {
    const auto reachable = [&](double from_radps, int straight) {
      return std::sqrt(from_radps * from_radps +
                       2.0 * straights_[straight].acceleration_radps2 * clear_length_rad(straight));
    };
    for (int i = 0; i < corners_.size(); ++i)
      corners_[i].speed_radps = std::min(corners_[i].speed_radps, reachable(i > 0 ? speed_radps(i - 1) : 0.0, i));
    for (int i = corners_.size() - 1; i >= 0; --i)
      corners_[i].speed_radps = std::min(corners_[i].speed_radps, reachable(speed_radps(i + 1), i + 1));
  }

  /// Accelerates, keeps the speed, and brakes.
  void add_straight(int i, Guide& guide) const {
    const Straight& straight = straights_[i];
    const double from = i > 0 ? speed_radps(i - 1) : 0.0, to = speed_radps(i), length = clear_length_rad(i);
    const double a = straight.acceleration_radps2;
    const double peak = std::min(straight.fastest_radps, std::sqrt(0.5 * (from * from + to * to) + a * length));
    const double rising = std::max(0.0, 0.5 * (peak * peak - from * from) / a);
    const double falling = std::max(0.0, 0.5 * (peak * peak - to * to) / a);
    add_part(straight, rising, from, peak, guide);
    add_part(straight, length - rising - falling, peak, peak, guide);
    add_part(straight, falling, peak, to, guide);
  }

  void add_part(const Straight& straight, double length, double from_radps, double to_radps, Guide& guide) const {
    if (length < kNegligible) return;
    const int last = guide.knots - 1;
    const double duration_s = 2.0 * length / (from_radps + to_radps);
    guide.add(guide.time_s[last] + duration_s, guide.position_rad[last] + length * straight.direction,
              to_radps * straight.direction);
  }

  void add_blend(int i, Guide& guide) const {
    const Corner& corner = corners_[i];
    const JointVector& after = straights_[i + 1].direction;
    guide.add(guide.end_s() + 2.0 * corner.blend_rad / corner.speed_radps, path_rad_[i + 1] + corner.blend_rad * after,
              corner.speed_radps * after);
  }

  const JointPath& path_rad_;
  const JointVector accelerations_;
  const IsFree& is_free_;
  BoundedList<Straight, kMostPoints> straights_;
  BoundedList<Corner, kMostPoints> corners_;
};

}  // namespace

Guide timed_guide(const Arm& arm, const JointPath& path_rad, double share, double start_s, const IsFree& is_free,
                  double fastest_mps) {
  return Timing(arm, path_rad, share, is_free, fastest_mps).guide(start_s);
}

}  // namespace sidestep
