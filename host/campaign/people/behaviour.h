#pragma once

#include <functional>

#include "host/campaign/random.h"
#include "host/people/postures.h"

namespace sidestep::campaign {

Anatomy draw_anatomy(Random& random);

/// What a person does: the posture over time. Person's frame and base frame as in Posture.
struct Behaviour {
  std::function<Posture(double t_s)> at;
  double end_s;  ///< from then on the person stands still, or is walking away
};

/// Walks straight on along x = (cos heading, sin heading), with swinging arms; at t = 0 at floor_m. speed_mps: about
/// 1.0 to 1.5.
Behaviour walking(Random& random, const Anatomy& anatomy, const Vector3& floor_m, double heading_rad, double speed_mps,
                  double end_s);

/// Stands at floor_m, reaches to a point with the hand of this side at reach_s (the trunk leans as far as that takes),
/// stays there for a moment and takes the hand back. point_m: of the middle of the hand, person's frame.
Behaviour reaching(Random& random, const Anatomy& anatomy, const Vector3& floor_m, double heading_rad, size_t side,
                   const Vector3& point_m, double reach_s);

/// Stands at floor_m and moves one hand or both quickly to and fro, the hand of this side first at strike_s at point_m
/// (person's frame, within the arm's reach); then the arms hang again.
Behaviour gesturing(Random& random, const Anatomy& anatomy, const Vector3& floor_m, double heading_rad, size_t side,
                    const Vector3& point_m, double strike_s);

}  // namespace sidestep::campaign
