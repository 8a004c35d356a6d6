#pragma once

#include "firmware/model/gjk.h"
#include "firmware/model/kinematics.h"
#include "firmware/model/proximity.h"

namespace sidestep {

/// A link shape in one configuration, and the capsule around it in the base frame.
struct PosedShape {
  const BodyShape& shape;
  const LinkPoses& poses;
  const Capsule& capsule;

  ConvexSolid solid() const { return shape.is_capsule ? ConvexSolid::of(capsule) : solid_of(poses, shape); }
};

/// From here on, between enclosing capsules, the distance is that of the capsules; below the other value it is exact;
/// in between it changes linearly from one to the other, as do normal and points. The distance is continuous and never
/// more than the exact one. Hard and pass rows are mostly active below that.
constexpr double kCapsulesAlone_m = 0.08;
constexpr double kExact_m = 0.04;

/// The Proximity (without its indices) of a link shape to a solid that is no link, as described above. `capsules` is
/// the Proximity of the enclosing capsules, which keeps its axis distance. It is the result if the shape is a capsule:
/// measure_pair() is exact then.
Proximity refined(const PosedShape& link, const ConvexSolid& obstacle, const Proximity& capsules);

/// The same for two link shapes, of which only the hard row counts: no distance of solids is more than
/// kCapsulesAlone_m, where the search for it ends.
Proximity measure_pair(const PosedShape& first, const PosedShape& second);

/// The closest approach within horizon_s of a solid that translates at velocity_mps. now: the result of refined().
/// capsules: the closest approach of the enclosing capsule, whose instant, axis distance and head_on are kept. The
/// distance is a convex function of time: its tangents at present, at that instant and, if the solid still comes nearer
/// then, at the horizon bound it from below; that bound is distance_m. Where the cores overlap at that instant, the
/// normal is that of the capsules, which is across the path.
ClosestApproach refined(const PosedShape& link, const ConvexSolid& obstacle, const Vector3& velocity_mps,
                        const Proximity& now, const ClosestApproach& capsules, double horizon_s);

}  // namespace sidestep
