#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/types.h"

namespace sidestep {

/// What foresight predicts for the coming seconds; values as in controller_status_t.
enum class ForesightStatus : int8_t {
  kDirect = 0,   ///< no guide: the law alone
  kGuided = 1,   ///< the arm follows a guide, because the law alone would collide, be late or not arrive
  kWaiting = 2,  ///< the target cannot be reached at present: with knots the arm retreats to the last knot, without
                 ///< knots the law continues alone
};

/// What foresight has found out about the goal itself.
enum class GoalFinding : int8_t {
  kNone,            ///< nothing against it
  kOutOfReach,      ///< no configuration with the tool at the target was found, however often it was tried
  kPostureBlocked,  ///< in this posture the arm is too near to an obstacle at rest, or to itself
};

constexpr int kMaxKnots = 32;

/// A timed path in joint space, given by its knots. Between two knots every joint moves on the cubic that has the
/// positions and velocities of both (Hermite); from rest to rest that is a straight line with the profile 3u^2 - 2u^3.
/// At the last knot the velocity is 0, at the first one too unless the guide starts while the arm moves. After the last
/// knot the law holds the tool at the target and keeps the joints near that knot as far as the tool's task leaves
/// freedom; with kWaiting the arm stays at the last knot instead.
struct Guide {
  ForesightStatus foresight_status = ForesightStatus::kDirect;
  GoalFinding goal = GoalFinding::kNone;   ///< for the report; the law disregards it
  int knots = 0;                           ///< 0: no path to follow
  std::array<double, kMaxKnots> time_s{};  ///< increasing, on the clock of the cycle
  std::array<JointVector, kMaxKnots> position_rad;
  std::array<JointVector, kMaxKnots> velocity_radps;

  /// Appends a knot; there must be room.
  void add(double at_s, const JointVector& q_rad, const JointVector& qd_radps);
  /// The same at rest.
  void add(double at_s, const JointVector& q_rad) { add(at_s, q_rad, JointVector::Zero(q_rad.size())); }

  /// Whether the path leads to safety and not to a target.
  bool is_retreat() const { return knots > 0 && foresight_status == ForesightStatus::kWaiting; }
  double end_s() const { return knots > 0 ? time_s[knots - 1] : 0.0; }
};

/// Position and velocity of a guide at one instant, n x 1 each.
struct GuidePoint {
  JointVector position_rad;
  JointVector velocity_radps;
};

/// The guide at time now_s: at rest at the first knot before the first knot's time, at rest at the last one after its
/// time. The guide must have at least one knot.
GuidePoint point_of(const Guide& guide, double now_s);

}  // namespace sidestep
