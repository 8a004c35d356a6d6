#pragma once

#include <limits>

#include "firmware/control/types/guide.h"
#include "firmware/control/types/law.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// How far an arm has followed a guide.
struct GuideProgress {
  double start_s = -std::numeric_limits<double>::infinity();  ///< of the guide: its first knot's time
  double delay_s = 0.0;                                       ///< behind the guide's own times
};

/// The time at which the guide is to be evaluated, at most now_s; to be called once a cycle while there is a guide. An
/// arm that the shield keeps from following would cut corners and end in a dead end: the guide waits for it. Time runs
/// at full speed while every joint is within 0.05 rad (times Arm::joint_scale) of the guide, and the slower the farther
/// one is away, down to a tenth from 0.2 rad on. Another guide begins without delay. step_s: the time that passes on
/// the guide in this cycle at full speed: the period, or less where the arm is to be slower.
double guide_time_s(const Arm& arm, const Guide& guide, const JointVector& position_rad, double now_s, double period_s,
                    double step_s, GuideProgress& progress);

/// Nominal velocity of an arm that follows a guide with at least one knot: the guide's joint velocity plus k_guide
/// times the deviation from it, both at guide_time_s(). After the last knot: the sidestep law with that knot as the
/// preferred posture, or the posture law for a posture; with ForesightStatus::kWaiting the arm stays at the knot
/// instead.
NominalCommand guided_law(const SidestepGains& gains, const LawInput& input, const Guide& guide, double time_s);

}  // namespace sidestep
