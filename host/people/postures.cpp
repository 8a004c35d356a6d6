#include "host/people/postures.h"

#include <algorithm>
#include <cmath>

namespace sidestep {
namespace {

constexpr double kSample_s = 0.01;

// The length of a step, and its largest angles.
constexpr double kStep_m = 0.55, kStepHip_rad = 0.3, kStepKnee_rad = 0.5;

/// Adds whole steps over the way to hips and knees; `share` of it is done.
void step(double way_m, double share, Posture& posture) {
  const double steps = std::ceil(way_m / kStep_m), phase = M_PI * steps * share;
  for (const size_t side : {0u, 1u}) {
    const double swing = sign_of(side) * std::sin(phase);
    posture.hip_rad[side] += kStepHip_rad * swing;
    posture.knee_rad[side] += kStepKnee_rad * swing * swing;
  }
}

Posture between(const Posture& from, const Posture& to, double share) {
  const auto blend = [share](const auto& a, const auto& b) { return a + share * (b - a); };
  Posture posture;
  posture.floor_m = blend(from.floor_m, to.floor_m);
  posture.heading_rad = blend(from.heading_rad, to.heading_rad);
  posture.rise_m = blend(from.rise_m, to.rise_m);
  posture.lean_rad = blend(from.lean_rad, to.lean_rad);
  for (const size_t side : {0u, 1u}) {
    posture.hand_m[side] = blend(from.hand_m[side], to.hand_m[side]);
    posture.hip_rad[side] = blend(from.hip_rad[side], to.hip_rad[side]);
    posture.knee_rad[side] = blend(from.knee_rad[side], to.knee_rad[side]);
  }
  step((to.floor_m - from.floor_m).norm(), share, posture);
  return posture;
}

}  // namespace

Posture standing(const Anatomy& anatomy, const Vector3& floor_m, double heading_rad) {
  Posture posture;
  posture.floor_m = floor_m;
  posture.heading_rad = heading_rad;
  for (const size_t side : {0u, 1u}) posture.hand_m[side] = hanging_hand_m(anatomy, side);
  return posture;
}

double minimum_jerk(double u) {
  return u * u * u * (10.0 + u * (-15.0 + u * 6.0));
}

Posture posture_at(const std::vector<TimedPosture>& postures, double t_s) {
  const auto next =
      std::find_if(postures.begin(), postures.end(), [t_s](const TimedPosture& p) { return p.at_s > t_s; });
  if (next == postures.begin()) return postures.front().posture;
  if (next == postures.end()) return postures.back().posture;
  const TimedPosture &from = *(next - 1), &to = *next;
  return between(from.posture, to.posture, minimum_jerk((t_s - from.at_s) / (to.at_s - from.at_s)));
}

std::vector<CapsulePath> record(const Anatomy& anatomy, const std::function<Posture(double t_s)>& posture,
                                double duration_s) {
  std::array<std::vector<CapsulePath::Ends>, kBodyParts> samples;
  std::array<double, kBodyParts> radius_m{};
  const int last = static_cast<int>(std::ceil(duration_s / kSample_s)) + 1;
  for (int k = 0; k <= last; ++k) {
    const auto body = capsules_of(anatomy, posture(k * kSample_s));
    for (size_t part = 0; part < body.size(); ++part) {
      samples[part].push_back({body[part].start, body[part].end});
      radius_m[part] = body[part].radius_m;
    }
  }
  std::vector<CapsulePath> paths;
  for (size_t part = 0; part < samples.size(); ++part)
    paths.emplace_back(radius_m[part], kSample_s, std::move(samples[part]));
  return paths;
}

}  // namespace sidestep
