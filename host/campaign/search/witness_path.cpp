#include "host/campaign/search/witness_path.h"

#include <algorithm>
#include <cmath>

namespace sidestep::campaign {
namespace {

constexpr double kCoarseStep_s = 0.05, kFineStep_s = 0.001;
constexpr double kLimitShare = 0.95;  // of velocity and acceleration, that the segments use
constexpr double kReaches_rad[] = {0.5, 1.2, 3.0};

/// The profile's largest velocity is 1.5 and its largest acceleration 6, for a unit step in unit time.
double shortest_s(const Joints& step_rad, const Limits& limits) {
  const Joints size_rad = step_rad.cwiseAbs();
  return std::max(1.5 * size_rad.cwiseQuotient(limits.velocity_radps).maxCoeff(),
                  std::sqrt(6.0 * size_rad.cwiseQuotient(limits.acceleration_radps2).maxCoeff()));
}

WitnessPath draw_path(Random& random, const SearchScene& scene, const Limits& limits) {
  WitnessPath path{scene.start_rad, {}};
  const int knots = random.uniform(0.0, 1.0) < 0.6 ? 1 : 2;
  const double reach_rad = kReaches_rad[random.integer(0, 2)];
  double t_s = 0.0;
  Joints from_rad = scene.start_rad;
  for (int k = 0; k < knots; ++k) {
    if (random.uniform(0.0, 1.0) < 0.5) t_s += random.uniform(0.0, 0.5 * scene.duration_s());
    Joints knot_rad = scene.start_rad;
    for (int i = 0; i < knot_rad.size(); ++i)
      knot_rad[i] =
          std::clamp(knot_rad[i] + random.uniform(-reach_rad, reach_rad), limits.lower_rad[i], limits.upper_rad[i]);
    const double duration_s = shortest_s(knot_rad - from_rad, limits) / kLimitShare;
    path.segments.push_back({t_s, duration_s, knot_rad});
    t_s += duration_s;
    from_rad = knot_rad;
  }
  return path;
}

}  // namespace

Joints WitnessPath::at(double t_s) const {
  Joints q_rad = start_rad;
  for (const Segment& segment : segments) {
    const double u = std::clamp((t_s - segment.begin_s) / segment.duration_s, 0.0, 1.0);
    q_rad += (3.0 - 2.0 * u) * u * u * (segment.knot_rad - q_rad);
  }
  return q_rad;
}

bool keeps_limits(const WitnessPath& path, const Limits& limits) {
  double free_s = 0.0;
  Joints from_rad = path.start_rad;
  for (const WitnessPath::Segment& segment : path.segments) {
    if (segment.begin_s < free_s || !(segment.duration_s > 0.0) ||
        shortest_s(segment.knot_rad - from_rad, limits) > segment.duration_s ||
        (segment.knot_rad - limits.lower_rad).minCoeff() < 0.0 ||
        (limits.upper_rad - segment.knot_rad).minCoeff() < 0.0)
      return false;
    free_s = segment.begin_s + segment.duration_s;
    from_rad = segment.knot_rad;
  }
  return true;
}

double path_clearance_m(const SearchScene& scene, const WitnessPath& path, double step_s, double enough_m) {
  double least_m = sim::kNothingNear;
  const int steps = static_cast<int>(std::ceil(scene.duration_s() / step_s));
  for (int k = 0; k <= steps && least_m >= enough_m; ++k) {
    const ArmPose pose = lwa3_arm().pose(path.at(k * step_s));
    if (lwa3_arm().self_clearance(pose) < kSearchSelfClearance_m) return -sim::kNothingNear;
    least_m = clearance_m(scene, pose, k * step_s, least_m);
  }
  return least_m;
}

double proven_clearance_m(const SearchScene& scene, const WitnessPath& path, const Limits& limits) {
  if (path.start_rad != scene.start_rad || !keeps_limits(path, limits)) return -sim::kNothingNear;
  return path_clearance_m(scene, path, kFineStep_s);
}

std::optional<WitnessPath> find_witness(Random& random, const SearchScene& scene, const Limits& limits, int draws) {
  for (int draw = 0; draw < draws; ++draw) {
    WitnessPath path = draw_path(random, scene, limits);
    if (path_clearance_m(scene, path, kCoarseStep_s, kWitnessPathClearance_m) < kWitnessPathClearance_m) continue;
    if (proven_clearance_m(scene, path, limits) >= kWitnessPathClearance_m) return path;
  }
  return std::nullopt;
}

}  // namespace sidestep::campaign
