#pragma once

#include <optional>
#include <vector>

#include "host/campaign/random.h"
#include "host/campaign/search/search_scene.h"

namespace sidestep::campaign {

/// A joint path from rest to rest that proves that a scene could be solved: it waits, moves to a knot with the profile
/// 3u^2 - 2u^3, waits, and so on.
struct EvasivePath {
  struct Segment {
    double begin_s, duration_s;
    Joints knot_rad;  ///< at the end
  };

  Joints start_rad;
  std::vector<Segment> segments;  ///< in the order of time

  Joints at(double t_s) const;
};

constexpr double kWayOutClearance_m = 0.01;

/// Whether the path keeps the position, velocity and acceleration limits.
bool keeps_limits(const EvasivePath& path, const Limits& limits);

/// Least clearance of the path over the whole scene, checked every step_s; -infinity if links come closer to each other
/// than kSearchSelfClearance_m. Stops at the first value below `enough_m` and returns it.
double path_clearance_m(const SearchScene& scene, const EvasivePath& path, double step_s,
                        double enough_m = -sim::kNothingNear);

/// Clearance of a path that proves that the scene has a way out: it begins at the scene's start, keeps the limits and
/// is measured every millisecond. -infinity for a path that is no proof.
double proven_clearance_m(const SearchScene& scene, const EvasivePath& path, const Limits& limits);

/// Draws paths of one or two knots until one keeps kWayOutClearance_m. Empty if none of `draws` does.
std::optional<EvasivePath> find_way_out(Random& random, const SearchScene& scene, const Limits& limits, int draws);

}  // namespace sidestep::campaign
