#pragma once

#include <utility>
#include <vector>

#include "firmware/model/arm.h"

namespace sidestep {

/// Pairs of link shapes, as indices, that must keep clear of each other: all on different bodies except neighbours
/// (joined by nothing but joints without a shape of their own) and those that touch with every joint in the middle of
/// its range or in most postures, or never get clearance_m apart, because they, or the capsules around them, are built
/// that way. For start-up; samples postures with a fixed seed.
std::vector<std::pair<int, int>> find_self_pairs(const Arm& arm, double clearance_m = 0.0);

/// The pairs that find_self_pairs() leaves out because they are near as they are built.
std::vector<std::pair<int, int>> find_overlaps(const Arm& arm, double clearance_m = 0.0);

}  // namespace sidestep
