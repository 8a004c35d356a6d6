#include "firmware/model/load/self_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "firmware/base/hash.h"
#include "firmware/model/link_proximity.h"
#include "firmware/model/load/disk_cache.h"

namespace sidestep {
namespace {

constexpr std::uint64_t kVersion = 11;  // raise it whenever the result changes
constexpr int kSamples = 5000;
constexpr double kTouchingShare = 0.5;  // of the samples; two links that touch in more overlap by construction
constexpr double kForbiddenShare = 0.015;
// Pieces of meshes also touch in about 1 % of the samples in which the meshes do not.
constexpr double kForbiddenShareOfPieces = 0.012;
// Of the samples without contact; two links that are near in more are so by construction, as a UR's base and upper arm.
// No configuration keeps them apart by the clearance, so they are kept from coming nearer than in any sample.
constexpr double kNearShare = 0.9;
constexpr double kLeastClearance_m = 0.001;
// Of a chain of more joints several pairs close at once, and at full speed links come up to 2.6 mm nearer than their
// clearance (the campaign's boxes, ten joints).
constexpr double kLeastClearanceOfLongChain_m = 0.004;
constexpr int kLongChain = 9;  // joints
// Links that adjoin, as those of a humanoid's torso, may be nearer than the least clearance by construction. So may
// pieces, which are larger than their meshes. The least clearance of such a pair forbids at most this share of the
// samples without contact.
constexpr double kShareOfLeast = 0.005;
constexpr double kLeastOfAll_m = 0.0002;

/// Whether the chain connects the links of two shapes with no shape on a body between them.
bool adjoin(const Arm& arm, int a, int b) {
  const LinkShape &one = arm.shapes[a], &other = arm.shapes[b];
  if (one.below_arm || other.below_arm || one.other_joint >= 0 || other.other_joint >= 0) return false;
  const auto [low, high] = std::minmax(one.body, other.body);
  return std::none_of(arm.shapes.begin(), arm.shapes.end(),
                      [low = low, high = high](const LinkShape& s) { return s.body > low && s.body < high; });
}

bool neighbours(const Arm& arm, int a, int b) {
  const int apart = std::abs(arm.shapes[a].body - arm.shapes[b].body);
  return apart == 0 || (apart == 1 && adjoin(arm, a, b));
}

bool is_ignored(const Arm& arm, int a, int b, const std::vector<LinkPair>& ignored) {
  const std::string &one = arm.shapes[a].link, &other = arm.shapes[b].link;
  return std::any_of(ignored.begin(), ignored.end(), [&](const LinkPair& pair) {
    return pair == LinkPair(one, other) || pair == LinkPair(other, one);
  });
}

/// Within the position limits; of a joint that turns farther, one turn around the middle.
JointVector sample(const Arm& arm, std::mt19937& random) {
  JointVector q_rad(arm.joints);
  for (int i = 0; i < arm.joints; ++i) {
    const double middle = 0.5 * (arm.limits.lower_rad[i] + arm.limits.upper_rad[i]);
    const double around = std::isfinite(middle) ? middle : 0.0, turn_rad = arm.prismatic[i] ? HUGE_VAL : M_PI;
    const double lower = std::max(arm.limits.lower_rad[i], around - turn_rad);
    const double upper = std::min(arm.limits.upper_rad[i], around + turn_rad);
    q_rad[i] = std::uniform_real_distribution<double>(lower, std::max(lower, upper))(random);
  }
  return q_rad;
}

/// The distance of two shapes if it is below enough_m, else some value of at least enough_m.
double distance_m(const PosedShape& a, const PosedShape& b, double enough_m) {
  const Proximity capsules = measure_pair(a.capsule, b.capsule);
  if (capsules.distance_m >= enough_m || (a.shape.is_capsule && b.shape.is_capsule)) return capsules.distance_m;
  return distance_between_m(a.solid(), b.solid(), capsules.normal, enough_m);
}

/// A pair and its distances below the clearance, each with the index of its sample.
struct SampledPair {
  int first, second;
  bool adjoin;
  std::vector<std::pair<int, double>> near_m;
};

std::vector<SampledPair> sample_pairs(const Arm& arm, const std::vector<LinkPair>& ignored, double enough_m) {
  std::vector<SampledPair> pairs;
  for (int b = 0; b < static_cast<int>(arm.shapes.size()); ++b)
    for (int a = 0; a < b; ++a)
      if (!neighbours(arm, a, b) && !is_ignored(arm, a, b, ignored)) pairs.push_back({a, b, adjoin(arm, a, b), {}});
  std::mt19937 random(1);
  std::vector<Capsule> capsules(arm.shapes.size());
  for (int i = 0; i < kSamples; ++i) {
    const LinkPoses poses = forward_kinematics(arm, sample(arm, random));
    for (size_t s = 0; s < arm.shapes.size(); ++s) capsules[s] = transformed(poses, arm.shapes[s]);
    for (SampledPair& pair : pairs) {
      const auto posed = [&](int s) { return PosedShape{arm.shapes[s], poses, capsules[s]}; };
      const double found_m = distance_m(posed(pair.first), posed(pair.second), enough_m);
      if (found_m < enough_m) pair.near_m.emplace_back(i, found_m);
    }
  }
  return pairs;
}

LinkPair links_of(const Arm& arm, const SampledPair& pair) {
  return std::minmax(arm.shapes[static_cast<size_t>(pair.first)].link,
                     arm.shapes[static_cast<size_t>(pair.second)].link);
}

/// The samples in which no pair touches.
class FreeSamples {
 public:
  FreeSamples(const Arm& arm, const std::vector<SampledPair>& pairs, double clearance_m, bool has_pieces)
      : pairs_(pairs),
        clearance_m_(clearance_m),
        has_pieces_(has_pieces),
        least_m_(arm.joints < kLongChain ? kLeastClearance_m : kLeastClearanceOfLongChain_m),
        is_free_(kSamples, true) {
    for (const SampledPair& pair : pairs)
      for (const auto& [sample, distance_m] : pair.near_m)
        if (distance_m <= 0.0) is_free_[static_cast<size_t>(sample)] = false;
    count_ = std::count(is_free_.begin(), is_free_.end(), true);
    for (const SampledPair& pair : pairs) {
      std::vector<double>& sorted = sorted_m_.emplace_back();
      for (const auto& [sample, distance_m] : pair.near_m)
        if (is_free_[static_cast<size_t>(sample)]) sorted.push_back(distance_m);
      std::sort(sorted.begin(), sorted.end());
    }
    std::map<LinkPair, std::map<int, double>> near_m;  // the two links, and their distance in a sample
    for (const SampledPair& pair : pairs)
      for (const auto& [sample, distance_m] : pair.near_m)
        if (is_free_[static_cast<size_t>(sample)]) {
          const auto [found, is_new] = near_m[links_of(arm, pair)].try_emplace(sample, distance_m);
          if (!is_new) found->second = std::min(found->second, distance_m);
        }
    for (const SampledPair& pair : pairs) {
      const std::map<int, double>& links_m = near_m[links_of(arm, pair)];
      double least_m = HUGE_VAL;
      if (static_cast<double>(links_m.size()) > kNearShare * static_cast<double>(count_))
        for (const auto& [sample, distance_m] : links_m) least_m = std::min(least_m, distance_m);
      most_m_.push_back(least_m);
    }
  }
  /// Of every pair, with a quantile from 0 to 1.
  std::vector<double> clearances_m(double quantile) const {
    std::vector<double> clearances;
    for (const std::vector<double>& sorted : sorted_m_) {
      const auto at = [&](double share) {
        const auto index = static_cast<size_t>(share * static_cast<double>(std::max<std::ptrdiff_t>(count_ - 1, 0)));
        return index < sorted.size() ? sorted[index] : clearance_m_;
      };
      const double sampled_m = std::min(at(quantile), most_m_[clearances.size()]);
      const double few_m =
          has_pieces_ || pairs_[clearances.size()].adjoin ? std::max(at(kShareOfLeast), kLeastOfAll_m) : HUGE_VAL;
      clearances.push_back(std::max(sampled_m, std::min({least_m_, few_m, 0.5 * at(0.5)})));
    }
    return clearances;
  }
  double forbidden_share(const std::vector<double>& clearances_m) const {
    return forbidden_share(clearances_m, 0, pairs_.size());
  }
  /// By the pairs from `first` to before `last`.
  double forbidden_share(const std::vector<double>& clearances_m, size_t first, size_t last) const {
    std::vector<bool> is_forbidden(kSamples, false);
    for (size_t p = first; p < last; ++p)
      for (const auto& [sample, distance_m] : pairs_[p].near_m)
        if (distance_m < clearances_m[p] && is_free_[static_cast<size_t>(sample)])
          is_forbidden[static_cast<size_t>(sample)] = true;
    const auto forbidden = std::count(is_forbidden.begin(), is_forbidden.end(), true);
    return count_ > 0 ? static_cast<double>(forbidden) / static_cast<double>(count_) : 1.0;
  }

 private:
  const std::vector<SampledPair>& pairs_;
  const double clearance_m_;
  const bool has_pieces_;
  const double least_m_;
  std::vector<bool> is_free_;
  std::ptrdiff_t count_ = 0;
  std::vector<double> most_m_;  ///< of each pair: the least distance of two links that are near by construction
  std::vector<std::vector<double>> sorted_m_;  ///< of each pair, over the free samples, those below clearance_m_
};

/// The two links of each pair that touch in so many samples that they overlap by construction, whichever of their
/// shapes do.
std::set<LinkPair> overlapping_links(const Arm& arm, const std::vector<SampledPair>& pairs) {
  std::map<LinkPair, std::set<int>> touching;
  for (const SampledPair& pair : pairs)
    for (const auto& [sample, distance_m] : pair.near_m)
      if (distance_m <= 0.0) touching[links_of(arm, pair)].insert(sample);
  std::set<LinkPair> overlapping;
  for (const auto& [links, samples] : touching)
    if (static_cast<double>(samples.size()) > kTouchingShare * kSamples) overlapping.insert(links);
  return overlapping;
}

SelfPairs compute(const Arm& arm, double clearance_m, const std::vector<LinkPair>& ignored) {
  std::vector<SampledPair> pairs = sample_pairs(arm, ignored, clearance_m);
  SelfPairs result;
  const std::set<LinkPair> overlapping = overlapping_links(arm, pairs);
  const auto overlaps = [&](const SampledPair& pair) { return overlapping.count(links_of(arm, pair)) > 0; };
  for (const SampledPair& pair : pairs)
    if (overlaps(pair) && !pair.adjoin) result.overlaps.emplace_back(pair.first, pair.second);
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), overlaps), pairs.end());

  const bool has_pieces =
      std::any_of(arm.shapes.begin(), arm.shapes.end(), [](const LinkShape& s) { return s.polyhedron != nullptr; });
  const double most_share = has_pieces ? kForbiddenShareOfPieces : kForbiddenShare;
  const FreeSamples free(arm, pairs, clearance_m, has_pieces);
  double low = 0.0, high = 1.0;
  if (free.forbidden_share(free.clearances_m(high)) <= most_share) low = high;
  for (int i = 0; i < 20 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (free.forbidden_share(free.clearances_m(middle)) <= most_share ? low : high) = middle;
  }
  const std::vector<double> clearances = free.clearances_m(low);
  result.forbidden_share = free.forbidden_share(clearances);
  for (size_t p = 0; p < pairs.size(); ++p)
    if (const double share = free.forbidden_share(clearances, p, p + 1); share > result.worst_share) {
      result.worst = static_cast<int>(p);
      result.worst_share = share;
    }
  for (size_t p = 0; p < pairs.size(); ++p) result.kept.push_back({pairs[p].first, pairs[p].second, clearances[p]});
  return result;
}

/// A hash of everything that the result depends on.
std::uint64_t hash_of(const Arm& arm, double clearance_m, const std::vector<LinkPair>& ignored) {
  std::uint64_t value = fnv1a(&kVersion, sizeof(kVersion));
  const auto add = [&](const double* numbers, Eigen::Index count) {
    value = fnv1a(numbers, static_cast<size_t>(count) * sizeof(double), value);
  };
  const auto add_text = [&](const std::string& text) { value = fnv1a(text.data(), text.size() + 1, value); };
  add(&clearance_m, 1);
  for (const auto& [a, b] : ignored) add_text(a), add_text(b);
  for (int i = 1; i <= arm.joints; ++i) {
    add(arm.joint_placement[static_cast<size_t>(i)].data(), 16);
    add(&arm.limits.lower_rad[i - 1], 1);
    add(&arm.limits.upper_rad[i - 1], 1);
    const double prismatic = arm.prismatic[static_cast<size_t>(i) - 1];
    add(&prismatic, 1);
  }
  for (const OtherFrame& frame : arm.other_frames.joints) {
    add(frame.rotation.data(), 9);
    add(frame.origin.data(), 3);
  }
  for (const LinkShape& shape : arm.shapes) {
    add_text(shape.link);
    const double kind[] = {double(shape.body),       double(shape.below_arm), double(shape.is_capsule),
                           double(shape.solid.kind), shape.solid.radius_m,    shape.capsule_body.radius_m,
                           double(shape.other_joint)};
    add(kind, 7);
    for (const Vector3* v :
         {&shape.capsule_body.start, &shape.capsule_body.end, &shape.solid.half_m, &shape.solid.centre})
      add(v->data(), 3);
    add(shape.solid.rotation.data(), 9);
    if (shape.polyhedron)
      for (const Vector3& v : shape.polyhedron->vertices) add(v.data(), 3);
  }
  return value;
}

std::string to_text(const SelfPairs& pairs) {
  std::string line = fmt::format("{:a} {:a} {}", pairs.forbidden_share, pairs.worst_share, pairs.worst);
  for (const SelfPair& pair : pairs.kept) line += fmt::format(" {} {} {:a}", pair.first, pair.second, pair.clearance_m);
  for (const auto& [a, b] : pairs.overlaps) line += fmt::format(" {} {} -1", a, b);  // no clearance is negative
  return line;
}

SelfPairs from_text(const std::string& line) {
  std::istringstream words(line);
  std::string share, worst_share, clearance;
  SelfPairs pairs;
  words >> share >> worst_share >> pairs.worst;
  pairs.forbidden_share = std::strtod(share.c_str(), nullptr);
  pairs.worst_share = std::strtod(worst_share.c_str(), nullptr);
  for (int a = 0, b = 0; words >> a >> b >> clearance;) {
    const double clearance_m = std::strtod(clearance.c_str(), nullptr);
    if (clearance_m < 0.0)
      pairs.overlaps.emplace_back(a, b);
    else
      pairs.kept.push_back({a, b, clearance_m});
  }
  return pairs;
}

}  // namespace

SelfPairs find_self_pairs(const Arm& arm, double clearance_m, const std::vector<LinkPair>& ignored) {
  const std::string name = fmt::format("{:016x}.pairs", hash_of(arm, clearance_m, ignored));
  if (const std::optional<std::string> known = read_cache(name)) return from_text(*known);
  SelfPairs pairs = compute(arm, clearance_m, ignored);
  write_cache(name, to_text(pairs));
  return pairs;
}

}  // namespace sidestep
