#include "host/sim/self_distance.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <utility>

namespace sidestep::sim {
namespace {

// Half the edges of the box around a solid, in the frame of its part.
Eigen::Vector3d half_edges_m(const Solid& solid) {
  const Eigen::Vector3d& size = solid.size_m;
  switch (solid.shape) {
    case Shape::kBox:
    case Shape::kMesh:
      return size / 2.0;
    case Shape::kCapsule:
      return {size.x(), size.x(), size.x() + size.y() / 2.0};
    case Shape::kCylinder:
      return {size.x(), size.x(), size.y() / 2.0};
    case Shape::kSphere:
      break;
  }
  return Eigen::Vector3d::Constant(size.x());
}

// From the box around one part to the sphere around the other.
double box_to_sphere_m(const ArmPart& box, const ArmPart& sphere) {
  const Eigen::Vector3d offset_m = sphere.base_from_part.translation() - box.base_from_part.translation();
  const Eigen::Vector3d in_box_m = box.base_from_part.linear().transpose() * offset_m;
  return (in_box_m.cwiseAbs() - half_edges_m(box.solid)).cwiseMax(0.0).norm() - bounding_radius_m(sphere.solid);
}

// Lower bound of the distance between the surfaces.
double lower_bound_m(const ArmPart& a, const ArmPart& b) {
  return std::max(box_to_sphere_m(a, b), box_to_sphere_m(b, a));
}

double distance_m(const ArmPart& a, const ArmPart& b, double within_m) {
  return signed_distance_m(a.solid, a.base_from_part, b.solid, b.base_from_part, within_m);
}

bool touch(const ArmPart& a, const ArmPart& b) {
  return lower_bound_m(a, b) <= 0.0 && distance_m(a, b, 0.0) <= 0.0;
}

JointVector random_posture(const Arm& arm, std::mt19937_64& engine) {
  JointVector q = arm.lower();
  for (int i = 0; i < q.size(); ++i) q[i] += (arm.upper()[i] - q[i]) * 0x1p-53 * static_cast<double>(engine() >> 11);
  return q;
}

}  // namespace

SelfDistance::SelfDistance(Arm arm) {
  struct Links {
    std::vector<Pair> pairs;
    int touches = 0;
  };
  std::map<std::pair<std::string, std::string>, Links> candidates;
  const std::vector<ArmPart>& parts = arm.parts();
  for (size_t i = 0; i < parts.size(); ++i) {
    for (size_t j = i + 1; j < parts.size(); ++j) {
      if (std::abs(parts[i].body - parts[j].body) < 2) continue;
      candidates[std::minmax(parts[i].link, parts[j].link)].pairs.push_back({i, j});
    }
  }
  std::mt19937_64 engine(1);
  for (int posture = 0; posture < kPostures; ++posture) {
    arm.place(random_posture(arm, engine));
    for (auto& [names, links] : candidates) {
      if (links.touches > kPostures / 2) continue;
      links.touches += std::any_of(links.pairs.begin(), links.pairs.end(),
                                   [&](const Pair& pair) { return touch(parts[pair.first], parts[pair.second]); });
    }
  }
  for (const auto& [names, links] : candidates)
    if (links.touches <= kPostures / 2) pairs_.insert(pairs_.end(), links.pairs.begin(), links.pairs.end());
}

NearestLinks SelfDistance::nearest(const Arm& arm, double within_m) const {
  const std::vector<ArmPart>& parts = arm.parts();
  std::vector<std::pair<double, const Pair*>> candidates;  // smallest bound first
  for (const Pair& pair : pairs_) {
    const double bound_m = lower_bound_m(parts[pair.first], parts[pair.second]);
    if (bound_m < within_m) candidates.emplace_back(bound_m, &pair);
  }
  std::sort(candidates.begin(), candidates.end());
  NearestLinks best;
  for (const auto& [bound_m, pair] : candidates) {
    const double least_m = std::min(best.clearance_m, within_m);
    if (bound_m >= least_m) break;
    const ArmPart &first = parts[pair->first], &second = parts[pair->second];
    if (const double gap_m = distance_m(first, second, least_m); gap_m < least_m)
      best = {gap_m, first.link, second.link};
  }
  return best;
}

bool SelfDistance::judges(const Arm& arm, const std::string& first, const std::string& second) const {
  return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
    const std::string &a = arm.parts()[pair.first].link, &b = arm.parts()[pair.second].link;
    return std::minmax(a, b) == std::minmax(first, second);
  });
}

}  // namespace sidestep::sim
