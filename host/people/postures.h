#pragma once

#include <functional>
#include <vector>

#include "host/people/body.h"
#include "host/people/capsule_path.h"

namespace sidestep {

/// A person upright and at rest, with hanging arms.
Posture standing(const Anatomy& anatomy, const Vector3& floor_m, double heading_rad);

/// A posture to be taken at a time.
struct TimedPosture {
  double at_s;
  Posture posture;
};

/// The share of a way from rest to rest that is done after the share u of its time, u in 0..1: minimum jerk, as people
/// move (Flash and Hogan, 1985).
double minimum_jerk(double u);

/// A person who takes these postures, at rest in each: at least one, times increasing. From one to the next everything
/// moves with minimum jerk; the legs step where the place on the floor changes. Before the first and after the last
/// posture the person stays.
Posture posture_at(const std::vector<TimedPosture>& postures, double t_s);

/// The capsules of a person from t = 0 to duration_s.
std::vector<CapsulePath> record(const Anatomy& anatomy, const std::function<Posture(double t_s)>& posture,
                                double duration_s);

}  // namespace sidestep
