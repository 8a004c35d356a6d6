#include "firmware/model/self_pairs.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/model/kinematics.h"

namespace sidestep {
namespace {

constexpr int kSamples = 200;
constexpr double kBuiltThatWay = 0.5;  // share of postures in which such a pair touches

bool neighbours(const Arm& arm, int a, int b) {
  const auto [low, high] = std::minmax(arm.shapes[a].body, arm.shapes[b].body);
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

}  // namespace

std::vector<std::pair<int, int>> find_self_pairs(const Arm& arm) {
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a < static_cast<int>(arm.shapes.size()); ++a)
    for (int b = 0; b < a; ++b)
      if (!neighbours(arm, a, b)) pairs.emplace_back(b, a);

  std::vector<int> touching(pairs.size(), 0);
  std::mt19937 random(1);
  for (int i = 0; i < kSamples; ++i) {
    const Posture posture = forward(arm, sample(arm, random));
    for (size_t p = 0; p < pairs.size(); ++p) {
      const Capsule a = placed(posture, arm.shapes[pairs[p].first]), b = placed(posture, arm.shapes[pairs[p].second]);
      const NearestPoints points = nearest_on_axes(a, b);
      if ((points.a - points.b).norm() < a.radius_m + b.radius_m) ++touching[p];
    }
  }
  for (size_t p = pairs.size(); p-- > 0;)
    if (touching[p] > kBuiltThatWay * kSamples) pairs.erase(pairs.begin() + static_cast<std::ptrdiff_t>(p));
  return pairs;
}

}  // namespace sidestep
