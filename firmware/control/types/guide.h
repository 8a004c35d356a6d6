#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/types.h"

namespace sidestep {

/// What foresight expects; values as in controller_status_t.
enum class ForesightStatus : int8_t {
  kDirect = 0,   ///< the law alone will do
  kGuided = 1,   ///< there is a way that the law alone would not find
  kWaiting = 2,  ///< no way is known at present
};

constexpr int kMaxKnots = 4;

/// A way in joint space and time. Between two knots every joint moves on a straight line with the profile 3u^2 - 2u^3.
/// Behind the last the law keeps the tool at the target, with the joints near that knot as far as the tool allows;
/// unless the outlook is kWaiting: then the arm stays there.
struct Guide {
  ForesightStatus foresight_status = ForesightStatus::kDirect;
  int knots = 0;  ///< 0: nothing to follow
  std::array<double, kMaxKnots> time_s{};
  std::array<JointVector, kMaxKnots> position_rad;

  double end_s() const { return knots > 0 ? time_s[knots - 1] : 0.0; }
};

/// Where a guide is at one instant.
struct GuidePoint {
  JointVector position_rad;
  JointVector velocity_radps;
};

/// At rest in the first knot before its time and in the last one after. The guide has at least one knot.
GuidePoint point_of(const Guide& guide, double now_s);

}  // namespace sidestep
