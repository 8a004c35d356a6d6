#pragma once

#include <limits>
#include <string>
#include <vector>

#include "host/sim/arm.h"

namespace sidestep::sim {

/// The two closest links among the judged ones.
struct NearestLinks {
  double clearance_m = std::numeric_limits<double>::infinity();  ///< surface to surface; 0 or negative: contact
  std::string first, second;                                     ///< links, empty if none are nearer than asked for

  bool touch() const { return clearance_m <= 0.0; }
};

/// Distances between the links of one arm, on the shapes of its URDF. It looks at no list of pairs of the controller or
/// of an SRDF, but judges all pairs of links except
/// - links of one body: no joint of the chain moves them against each other;
/// - links of adjacent bodies: one joint of the chain is between them;
/// - links that touch in more than half of kPostures random postures within the joint limits: they do by construction.
class SelfDistance {
 public:
  static constexpr int kPostures = 400;

  /// The pairs are the same each time.
  explicit SelfDistance(Arm arm);

  /// The closest judged links in the present posture of the arm, among those closer than within_m. The arm is that of
  /// the constructor. Most pairs cost only a comparison of bounding volumes.
  NearestLinks nearest(const Arm& arm, double within_m = std::numeric_limits<double>::infinity()) const;

  /// Whether these two links are judged.
  bool judges(const Arm& arm, const std::string& first, const std::string& second) const;

 private:
  struct Pair {
    size_t first, second;  ///< indices into Arm::parts()
  };
  std::vector<Pair> pairs_;
};

}  // namespace sidestep::sim
