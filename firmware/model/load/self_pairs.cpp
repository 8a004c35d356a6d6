#include "firmware/model/load/self_pairs.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/model/kinematics.h"
#include "firmware/model/nearest_points.h"

namespace sidestep {
namespace {

constexpr int kSamples = 200;
constexpr double kTouchingShare = 0.5;  // of the samples; a pair that touches in more overlaps by construction

bool neighbours(const Arm& arm, int a, int b) {
  const LinkShape &one = arm.shapes[a], &other = arm.shapes[b];
  if (one.body != other.body && (one.below_arm || other.below_arm)) return false;  // the base link lies between them
  const auto [low, high] = std::minmax(one.body, other.body);
  return std::none_of(arm.shapes.begin(), arm.shapes.end(),
                      [low = low, high = high](const LinkShape& s) { return s.body > low && s.body < high; });
}

JointVector sample(const Arm& arm, std::mt19937& random) {
  JointVector q_rad(arm.joints);
  for (int i = 0; i < arm.joints; ++i) {
    const double lower = std::max(arm.limits.lower_rad[i], -M_PI), upper = std::min(arm.limits.upper_rad[i], M_PI);
    q_rad[i] = std::uniform_real_distribution<double>(lower, std::max(lower, upper))(random);
  }
  return q_rad;
}

/// Every joint in the middle of its range, or at 0 without limits: a configuration in which no real arm touches itself.
JointVector at_rest(const Arm& arm) {
  const JointVector middle_rad = 0.5 * (arm.limits.lower_rad + arm.limits.upper_rad);
  return middle_rad.array().isFinite().select(middle_rad, 0.0);
}

bool nearer(const Arm& arm, const LinkPoses& poses, const std::pair<int, int>& pair, double distance_m) {
  const Capsule a = transformed(poses, arm.shapes[pair.first]), b = transformed(poses, arm.shapes[pair.second]);
  const NearestPoints points = nearest_on_axes(a, b);
  return (points.a - points.b).norm() < a.radius_m + b.radius_m + distance_m;
}

/// The pairs of shapes that are no neighbours, divided as find_self_pairs() describes.
struct Pairs {
  std::vector<std::pair<int, int>> free, overlaps;
};

Pairs sort_pairs(const Arm& arm, double clearance_m) {
  std::vector<std::pair<int, int>> all;
  for (int a = 0; a < static_cast<int>(arm.shapes.size()); ++a)
    for (int b = 0; b < a; ++b)
      if (!neighbours(arm, a, b)) all.emplace_back(b, a);

  std::vector<int> touching(all.size(), 0), near(all.size(), 0);
  std::mt19937 random(1);
  for (int i = 0; i < kSamples; ++i) {
    const LinkPoses poses = forward_kinematics(arm, sample(arm, random));
    for (size_t p = 0; p < all.size(); ++p) {
      touching[p] += nearer(arm, poses, all[p], 0.0);
      near[p] += nearer(arm, poses, all[p], clearance_m);
    }
  }
  const LinkPoses rest = forward_kinematics(arm, at_rest(arm));
  Pairs pairs;
  for (size_t p = 0; p < all.size(); ++p) {
    const bool overlaps =
        touching[p] > kTouchingShare * kSamples || near[p] == kSamples || nearer(arm, rest, all[p], 0.0);
    (overlaps ? pairs.overlaps : pairs.free).push_back(all[p]);
  }
  return pairs;
}

}  // namespace

std::vector<std::pair<int, int>> find_self_pairs(const Arm& arm, double clearance_m) {
  return sort_pairs(arm, clearance_m).free;
}

std::vector<std::pair<int, int>> find_overlaps(const Arm& arm, double clearance_m) {
  return sort_pairs(arm, clearance_m).overlaps;
}

}  // namespace sidestep
