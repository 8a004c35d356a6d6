#include "host/campaign/search/search_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/campaign/scene.h"
#include "host/campaign/segment.h"

namespace sidestep::campaign {
namespace {

constexpr double kColumnStep_s = 0.02;

double link_clearance_m(const ArmPose& pose, size_t link, const Capsule& obstacle) {
  return segment_distance(pose.corners[link], pose.corners[link + 1], obstacle.start, obstacle.end) - kLinkRadius_m -
         obstacle.radius_m;
}

double passed_s(const MovingCapsule& obstacle) {
  return obstacle.crossing_s + kPassed_m / obstacle.velocity_mps.norm();
}

bool misses_column(const MovingCapsule& obstacle, const ArmPose& pose, double duration_s) {
  for (int k = 0; k * kColumnStep_s <= duration_s; ++k)
    if (link_clearance_m(pose, 0, obstacle.at(k * kColumnStep_s)) < kColumnClearance_m) return false;
  return true;
}

}  // namespace

const char* name_of(SearchFamily family) {
  return family == SearchFamily::kRest ? "rest" : "track";
}

SearchFamily search_family_named(const std::string& name) {
  for (const SearchFamily family : {SearchFamily::kRest, SearchFamily::kTrack})
    if (name == name_of(family)) return family;
  throw std::runtime_error(fmt::format("--search: no family '{}'; the families are rest, track", name));
}

Capsule MovingCapsule::at(double t_s) const {
  const Vector3 centre_m = crossing_m + (t_s - crossing_s) * velocity_mps;
  return {centre_m - half_axis_m, centre_m + half_axis_m, radius_m};
}

int SearchScene::periods() const {
  double end_s = 0.0;
  for (const MovingCapsule& obstacle : obstacles) end_s = std::max(end_s, passed_s(obstacle));
  return static_cast<int>(std::ceil(end_s / kPeriod_s));
}

double SearchScene::duration_s() const {
  return periods() * kPeriod_s;
}

double clearance_m(const SearchScene& scene, const ArmPose& pose, double t_s, double within_m) {
  double least_m = within_m;
  for (const MovingCapsule& obstacle : scene.obstacles) {
    const Capsule capsule = obstacle.at(t_s);
    for (size_t link = 0; link + 1 < pose.corners.size(); ++link)
      least_m = std::min(least_m, link_clearance_m(pose, link, capsule));
  }
  return least_m;
}

bool is_valid(const SearchScene& scene, const Limits& limits, double fastest_mps) {
  if ((scene.start_rad - limits.lower_rad).minCoeff() < 0.0 || (limits.upper_rad - scene.start_rad).minCoeff() < 0.0)
    return false;
  const ArmPose pose = lwa3_arm().pose(scene.start_rad);
  if (lwa3_arm().self_clearance(pose) < kSearchSelfClearance_m || clearance_m(scene, pose, 0.0) < kSeenAt_m)
    return false;
  return std::all_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const MovingCapsule& obstacle) {
    const double speed_mps = obstacle.velocity_mps.norm();
    return speed_mps >= kLeastSpeed_mps && speed_mps <= fastest_mps && obstacle.crossing_s >= 0.0 &&
           passed_s(obstacle) <= kLongestSearchScene_s && misses_column(obstacle, pose, kLongestSearchScene_s);
  });
}

}  // namespace sidestep::campaign
