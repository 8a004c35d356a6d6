#pragma once

#include "firmware/control/message_order.h"
#include "firmware/control/motion_estimator.h"
#include "firmware/control/obstacle_memory.h"
#include "firmware/control/other_joint_memory.h"
#include "firmware/control/types/inputs.h"
#include "firmware/control/types/settings.h"

namespace sidestep {

/// Where values come from, which decides what the gate does after the plausibility check.
enum class InputSource {
  kNetwork,    ///< messages: ordered by their sender's utime, obstacles remembered
  kLockstep,   ///< the same; the receipt time of an arm state is its utime
  kCalls,      ///< function calls of the same process: in the order of the calls, obstacles remembered
  kRecording,  ///< values that a gate has accepted before, remembered obstacles included: plausibility only
};

/// What the gate decided about a value.
struct Verdict {
  bool accepted = false;
  const char* rejected = nullptr;  ///< static text: why the value is invalid; null for a late or repeated one

  explicit operator bool() const { return accepted; }
};

/// The gate for values from outside, after decoding: checks plausibility (validation.h), drops late and repeated
/// messages (message_order.h), gives obstacles without velocities estimated ones (motion_estimator.h) and adds
/// remembered obstacles to an accepted set (obstacle_memory.h). A late obstacle set is dropped, but its obstacles enter
/// the memory. With neighbours the merger, which is before the gate, drops late sets and estimates motion. Does not
/// throw and does not allocate. Large: lives on the heap.
class InputGate {
 public:
  /// The arm outlives this.
  InputGate(const Arm& arm, const Settings& settings, InputSource source);

  /// Each may change the value: fields that do not apply become neutral, remembered obstacles are added. A value that
  /// was not accepted is not to be used. now_s: local time of receipt.
  Verdict accept(ArmState& arm, double now_s);
  Verdict accept(Target& target, double now_s);
  Verdict accept(Control& control, double now_s);
  Verdict accept(ObstacleSet& obstacles, int64_t utime, double now_s);
  /// Places the shapes on the last body of the arm.
  Verdict accept(Attachments& attachments, double now_s);
  /// Completes the positions of the named joints by the last ones of the others, and adds velocities.
  Verdict accept(OtherJoints& joints, double now_s);

 private:
  void complete(ObstacleSet& obstacles, double sending_interval_s, double elapsed_s, double now_s);
  void complete_late(ObstacleSet& late, double now_s);
  bool is_ordered() const { return source_ == InputSource::kNetwork || source_ == InputSource::kLockstep; }

  const Arm& arm_;
  Timeouts timeouts_;
  InputSource source_;
  MessageOrder arm_order_, target_order_, joint_target_order_, obstacles_order_, other_joints_order_, control_order_,
      attachments_order_;
  bool estimates_motion_;
  MotionEstimator estimator_;
  double estimated_s_ = 0.0;  ///< when the estimator was last used
  double late_s_ = 0.0;       ///< by which late sets have advanced its time since the last accepted set
  ObstacleMemory memory_;
  OtherJointMemory other_joints_;
};

}  // namespace sidestep
