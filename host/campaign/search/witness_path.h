#pragma once

#include <optional>
#include <vector>

#include "host/campaign/random.h"
#include "host/campaign/search/search_scene.h"

namespace sidestep::campaign {

/// A joint path from rest to rest: it waits, moves to a knot with the profile 3u^2 - 2u^3, waits, and so on. A path
/// without contact is a witness: it proves that the arm could have evaded.
struct WitnessPath {
  struct Segment {
    double begin_s, duration_s;
    Joints knot_rad;  ///< at the end
  };

  Joints start_rad;
  std::vector<Segment> segments;  ///< in the order of time

  Joints at(double t_s) const;
};

constexpr double kWitnessPathClearance_m = 0.01;

/// Whether the path keeps the position, velocity and acceleration limits.
bool keeps_limits(const WitnessPath& path, const Limits& limits);

/// Least clearance of the path over the whole scene, checked every step_s; -infinity if links come closer to each other
/// than kSearchSelfClearance_m. Stops at the first value below `enough_m` and returns it.
double path_clearance_m(const SearchScene& scene, const WitnessPath& path, double step_s,
                        double enough_m = -sim::kNothingNear);

/// Clearance of a path that proves that the scene has a witness: it begins at the scene's start, keeps the limits and
/// is measured every millisecond. -infinity for a path that is no proof.
double proven_clearance_m(const SearchScene& scene, const WitnessPath& path, const Limits& limits);

/// Draws paths of one or two knots until one keeps kWitnessPathClearance_m. Empty if none of `draws` does.
std::optional<WitnessPath> find_witness(Random& random, const SearchScene& scene, const Limits& limits, int draws);

}  // namespace sidestep::campaign
