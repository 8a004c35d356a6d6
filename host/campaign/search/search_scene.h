#pragma once

#include <string>
#include <vector>

#include "firmware/model/capsule.h"
#include "host/campaign/lwa3_arm.h"

namespace sidestep::campaign {

/// A capsule (a sphere if its half axis is zero) that moves on a straight line at constant velocity. Base frame.
struct MovingCapsule {
  double radius_m;
  Vector3 half_axis_m;  ///< from the centre to the centre of a cap
  Vector3 crossing_m;   ///< the centre at the time crossing_s
  double crossing_s;
  Vector3 velocity_mps;

  Capsule at(double t_s) const;
};

/// What the arm does in the scenes of the search.
enum class SearchFamily {
  kRest,   ///< at rest, without a target
  kTrack,  ///< at rest, with a target that stays where the tool is
};

/// "rest" or "track".
const char* name_of(SearchFamily family);
/// Throws std::runtime_error.
SearchFamily search_family_named(const std::string& name);

/// The LWA3 at rest, and obstacles that move towards it from t = 0 until all have passed.
struct SearchScene {
  SearchFamily family = SearchFamily::kRest;
  Joints start_rad;
  std::vector<MovingCapsule> obstacles;

  double duration_s() const;  ///< a whole number of periods
  int periods() const;
};

constexpr double kSeenAt_m = 0.5;  ///< least clearance at t = 0
constexpr double kPassed_m = 0.8;  ///< an obstacle has passed this far after its crossing
constexpr double kLongestSearchScene_s = 8.0;
constexpr double kColumnClearance_m = 0.15;  ///< of the lowest link, which cannot evade
constexpr double kSearchSelfClearance_m = 0.02;
constexpr double kLeastSpeed_mps = 0.1;

/// Least distance between the surfaces of the arm and of the obstacles at time t; negative if they overlap. Computed
/// from the corners of the judge's arm, independently of the controller. Returns within_m if it is not less.
double clearance_m(const SearchScene& scene, const ArmPose& pose, double t_s, double within_m = sim::kNothingNear);

/// Whether the scene keeps the rules of the search: the start is within the limits and free of self-collision, no
/// obstacle is faster than fastest_mps, nearer than kSeenAt_m at t = 0 or passes the lowest link within
/// kColumnClearance_m, and all have passed within kLongestSearchScene_s.
bool is_valid(const SearchScene& scene, const Limits& limits, double fastest_mps);

}  // namespace sidestep::campaign
