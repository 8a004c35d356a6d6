#pragma once

#include <cmath>

#include "firmware/control/types/guide.h"
#include "firmware/control/types/messages.h"
#include "firmware/model/attachments.h"
#include "firmware/model/other_joints.h"

namespace sidestep {

/// The newest accepted message of one channel, the time of its receipt, and how many have been accepted so far.
template <typename Message>
struct Latest {
  const Message* message = nullptr;  ///< null before the first
  double received_s = 0.0;
  int64_t count = 0;

  double age_s(double now_s) const { return now_s - received_s; }
  bool fresh(double now_s, double limit_s) const { return message && age_s(now_s) >= 0.0 && age_s(now_s) <= limit_s; }
};

/// The inputs of one cycle. The input gate has checked the messages; they stay valid during the call of step().
struct Inputs {
  Latest<ArmState> arm;
  Latest<Target> target;
  Latest<ObstacleSet> obstacles;
  int skipped_cycles = 0;                ///< between the previous cycle and this one
  bool stop = false;                     ///< the process has been asked to end: brake
  double foreign_command_s = -HUGE_VAL;  ///< when another controller's command for this arm was last received
  const Guide* guide = nullptr;          ///< from foresight; null without foresight
  Latest<Control> control{};             ///< without: full speed
  Latest<Attachments> attachments{};     ///< what the tool holds and may touch; without: nothing
  Latest<OtherJoints> other_joints{};    ///< positions of all joints outside the chain; without: Arm::other_positions
};

}  // namespace sidestep
