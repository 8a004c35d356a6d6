#pragma once

#include <utility>
#include <vector>

#include "firmware/model/arm.h"

namespace sidestep {

/// The pairs of link shapes, as indices into Arm::shapes, lower index first, that must keep clear of each other. These
/// are all pairs, except
/// - neighbours: shapes of one body, or of two bodies with no shape on any body between them. A shape below the arm
///   is a neighbour only of the other shapes of body 0;
/// - overlaps: pairs that are near each other by construction, or because of the capsules around them: those that touch
///   with every joint in the middle of its range, or in more than half of 200 sampled configurations, or that are
///   nearer than clearance_m in all of these.
/// For start-up. The samples have a fixed seed, so that the result is always the same.
std::vector<std::pair<int, int>> find_self_pairs(const Arm& arm, double clearance_m = 0.0);

/// The overlaps that find_self_pairs() skips.
std::vector<std::pair<int, int>> find_overlaps(const Arm& arm, double clearance_m = 0.0);

}  // namespace sidestep
