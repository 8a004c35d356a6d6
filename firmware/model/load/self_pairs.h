#pragma once

#include <string>
#include <utility>
#include <vector>

#include "firmware/model/arm.h"

namespace sidestep {

/// The links of two shapes that need not keep clear of each other.
using LinkPair = std::pair<std::string, std::string>;

/// The pairs of shapes of an arm, and what they forbid.
struct SelfPairs {
  std::vector<SelfPair> kept;
  std::vector<std::pair<int, int>> overlaps;  ///< pairs of links that touch by construction and are not kept apart,
                                              ///< although other links or joints lie between them
  double forbidden_share = 0.0;  ///< of the sampled configurations without contact, those nearer than a clearance
  int worst = -1;                ///< index of the kept pair that forbids most of these; -1: none forbids any
  double worst_share = 0.0;      ///< what it forbids
};

/// The pairs of link shapes, lower index first, that must keep clear of each other. These are all pairs, except
/// - neighbours: shapes of one body, or of two successive bodies. A shape below the arm or behind a joint outside the
///   chain is a neighbour only of the other shapes of its body;
/// - those of two links that are in `ignored`, in either order;
/// - overlaps: all pairs of two links that touch, with any of their shapes, in more than half of 5000 sampled
///   configurations. They are recorded unless the chain connects them with no shape on a body between.
///
/// Links of some arms pass each other within millimetres by construction. Therefore the clearance of a pair is the
/// least of clearance_m and a quantile of its own distance over the samples in which no pair touches, but at least
/// 1 mm (4 mm in a chain of nine or more joints) or, if that is less, half the median of its distance. The quantile is
/// the same for all pairs: the largest with which all pairs together forbid no more than 1.5 % of these samples. If a
/// shape is a piece of a mesh, these are 1.2 %, because pieces also touch where meshes do not. Of such an arm, and of
/// links that the chain connects with no shape between, a pair for which the 1 mm (4 mm) would forbid more than 0.5 %
/// of the samples has less, but at least 0.2 mm.
///
/// For start-up; takes about a second, after that the result is cached (disk_cache.h). The samples have a fixed seed,
/// so that the result is always the same.
SelfPairs find_self_pairs(const Arm& arm, double clearance_m, const std::vector<LinkPair>& ignored = {});

}  // namespace sidestep
