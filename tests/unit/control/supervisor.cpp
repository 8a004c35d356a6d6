#include "firmware/control/supervisor.h"

#include <functional>
#include <set>
#include <vector>

#include "tests/support/check.h"

using namespace sidestep;

namespace {

constexpr int kFlags = 18;
static_assert(sizeof(InputStatus) == kFlags, "a new flag belongs into status_of()");
const Mode kModes[] = {Mode::kWait, Mode::kHold, Mode::kTrack, Mode::kBrake, Mode::kFault};

InputStatus status_of(unsigned bits) {
  InputStatus status;
  bool* const all[kFlags] = {&status.arm_known,
                             &status.arm_fresh,
                             &status.arm_lost,
                             &status.arm_consistent,
                             &status.arm_starting,
                             &status.arm_inconsistent,
                             &status.obstacles_known,
                             &status.obstacles_fresh,
                             &status.target_known,
                             &status.target_fresh,
                             &status.late,
                             &status.stop,
                             &status.paused,
                             &status.operator_silent,
                             &status.foreign_command,
                             &status.target_out_of_reach,
                             &status.posture_blocked,
                             &status.posture_outside_limits};
  for (int i = 0; i < kFlags; ++i) *all[i] = bits >> i & 1;
  return status;
}

/// Flags that monitor_inputs() can produce. Other combinations are tested only for properties that hold for all.
bool possible(const InputStatus& f) {
  if (f.arm_fresh && (!f.arm_known || f.arm_lost)) return false;
  if ((f.arm_lost || f.arm_inconsistent || f.arm_consistent) && !f.arm_known) return false;
  if (f.target_fresh && !f.target_known) return false;
  return !(f.obstacles_fresh && !f.obstacles_known);
}

using Property = std::function<bool(const Supervision& last, const InputStatus&, const Supervision& next)>;

/// Checks a property for every mode, fault and combination of flags.
void check_always(const char* name, const Property& property, bool only_possible = false) {
  for (const Mode mode : kModes) {
    for (unsigned bits = 0; bits < 1u << kFlags; ++bits) {
      const InputStatus status = status_of(bits);
      if (only_possible && !possible(status)) continue;
      for (const Fault fault : {Fault::kArmStateLost, Fault::kArmStateInconsistent, Fault::kNotFinite}) {
        const Supervision last{mode, mode == Mode::kFault ? fault : Fault::kNone, "before"};
        const Supervision next = next_mode(last, status);
        check(property(last, status, next), "%s: mode %d, flags 0x%x -> mode %d, fault %d", name,
              static_cast<int>(mode), bits, static_cast<int>(next.mode), static_cast<int>(next.fault));
      }
    }
  }
}

bool may_move(Mode mode) {
  return mode == Mode::kHold || mode == Mode::kTrack;
}

void tracking_needs_everything_fresh(void**) {
  check_always("track", [](const auto&, const InputStatus& f, const auto& next) {
    return next.mode != Mode::kTrack ||
           (f.arm_fresh && !f.arm_lost && !f.arm_inconsistent && f.obstacles_fresh && f.target_known &&
            f.target_fresh && !f.late && !f.stop && !f.foreign_command && !f.paused && !f.operator_silent);
  });
}

void a_goal_that_cannot_be_reached_changes_only_the_message_of_tracking(void**) {
  check_always("unreachable", [](const Supervision& last, const InputStatus& f, const Supervision& next) {
    InputStatus reachable = f;
    reachable.target_out_of_reach = reachable.posture_blocked = reachable.posture_outside_limits = false;
    const bool any = f.target_out_of_reach || f.posture_blocked || f.posture_outside_limits;
    const Supervision same = next_mode(last, reachable);
    if (same.mode != next.mode || same.fault != next.fault) return false;
    return (std::string(same.message) != next.message) == (any && next.mode == Mode::kTrack);
  });
}

void a_stopped_arm_does_not_start_on_old_obstacles(void**) {
  check_always("start", [](const auto& last, const InputStatus& f, const auto& next) {
    const bool stopped = last.mode == Mode::kWait || last.mode == Mode::kFault;
    return !stopped || f.obstacles_fresh || !may_move(next.mode);
  });
}

void a_request_to_stop_never_leads_to_a_moving_mode(void**) {
  check_always("stop",
               [](const auto&, const InputStatus& f, const auto& next) { return !f.stop || !may_move(next.mode); });
}

void the_arm_does_not_move_while_another_controller_commands_it(void**) {
  check_always("foreign command", [](const auto&, const InputStatus& f, const auto& next) {
    return !f.foreign_command || !may_move(next.mode);
  });
}

void the_arm_does_not_move_without_a_fresh_arm_state(void**) {
  check_always(
      "arm", [](const auto&, const InputStatus& f, const auto& next) { return f.arm_fresh || !may_move(next.mode); },
      true);
}

void the_arm_starts_only_with_consistent_states_and_known_obstacles(void**) {
  check_always("start", [](const Supervision& last, const InputStatus& f, const auto& next) {
    const bool starts = (last.mode == Mode::kWait || last.mode == Mode::kFault) && may_move(next.mode);
    return !starts || (f.arm_known && f.arm_fresh && f.arm_consistent && !f.arm_starting && f.obstacles_known);
  });
}

void a_start_never_leads_directly_to_track(void**) {
  check_always("hold first", [](const Supervision& last, const auto&, const auto& next) {
    return (last.mode != Mode::kWait && last.mode != Mode::kFault) || next.mode != Mode::kTrack;
  });
}

void a_lost_or_inconsistent_arm_is_a_fault_of_that_name(void**) {
  check_always("fault", [](const Supervision& last, const InputStatus& f, const auto& next) {
    if (last.mode == Mode::kWait) return next.fault == Fault::kNone;
    if (f.arm_inconsistent) return next.mode == Mode::kFault && next.fault == Fault::kArmStateInconsistent;
    if (f.arm_lost) return next.mode == Mode::kFault && next.fault == Fault::kArmStateLost;
    return last.mode == Mode::kFault || next.mode != Mode::kFault;
  });
}

void a_fault_lasts_until_the_arm_is_consistent_and_the_obstacles_fresh(void**) {
  check_always("latched", [](const Supervision& last, const InputStatus& f, const auto& next) {
    if (last.mode != Mode::kFault || f.arm_inconsistent || f.arm_lost) return true;
    const bool obstacles = f.obstacles_fresh || !f.obstacles_known;  // without any the next mode is WAIT
    const bool ready = f.arm_known && f.arm_fresh && f.arm_consistent && !f.arm_starting && obstacles;
    if (ready && !f.stop && !f.foreign_command) return next.mode != Mode::kFault;
    return next.mode == Mode::kFault && next.fault == last.fault;
  });
}

void a_fault_is_named_exactly_in_mode_fault(void**) {
  check_always("named", [](const auto&, const auto&, const auto& next) {
    return (next.mode == Mode::kFault) == (next.fault != Fault::kNone);
  });
}

void every_reason_to_brake_leads_to_brake(void**) {
  check_always("brake", [](const Supervision& last, const InputStatus& f, const auto& next) {
    if (last.mode == Mode::kWait || last.mode == Mode::kFault || f.arm_inconsistent || f.arm_lost) return true;
    const bool reason = f.stop || f.foreign_command || !f.arm_fresh || !f.obstacles_fresh || f.late;
    return reason == (next.mode == Mode::kBrake);
  });
}

void without_a_fresh_target_or_an_operators_consent_the_mode_is_hold(void**) {
  check_always("hold", [](const Supervision& last, const InputStatus& f, const auto& next) {
    const bool undisturbed = f.arm_known && f.arm_fresh && !f.arm_lost && !f.arm_inconsistent && f.obstacles_fresh &&
                             !f.late && !f.stop && !f.foreign_command;
    if (last.mode == Mode::kWait || last.mode == Mode::kFault || !undisturbed) return true;
    const bool tracks = f.target_known && f.target_fresh && !f.paused && !f.operator_silent;
    return next.mode == (tracks ? Mode::kTrack : Mode::kHold);
  });
}

void a_running_controller_waits_again_only_after_a_fault_without_obstacles(void**) {
  check_always("wait", [](const Supervision& last, const InputStatus& f, const auto& next) {
    const bool from_fault = last.mode == Mode::kFault && !f.obstacles_known;
    return next.mode != Mode::kWait || last.mode == Mode::kWait || from_fault;
  });
}

void every_mode_is_reachable_and_has_a_message(void**) {
  std::set<Mode> reached;
  std::set<std::string> messages;
  check_always("message", [&](const auto&, const auto&, const auto& next) {
    reached.insert(next.mode);
    messages.insert(next.message);
    return next.message && *next.message && std::string(next.message) != "before";
  });
  assert_int_equal(reached.size(), 5);
  check(messages.size() >= 17, "%zu messages", messages.size());
}

void an_ordinary_run_passes_through_the_expected_modes(void**) {
  InputStatus f;
  Supervision now;
  const auto then = [&](Mode mode, const char* word) {
    now = next_mode(now, f);
    check(now.mode == mode && std::string(now.message).find(word) != std::string::npos,
          "mode %d, '%s', expected %d, '%s'", static_cast<int>(now.mode), now.message, static_cast<int>(mode), word);
  };
  then(Mode::kWait, "first arm state");
  f.arm_known = f.arm_fresh = true;
  then(Mode::kWait, "consistent");
  f.arm_consistent = true;
  then(Mode::kWait, "obstacle");
  f.obstacles_known = f.obstacles_fresh = true;
  then(Mode::kHold, "holding");
  then(Mode::kHold, "no target");
  f.target_known = f.target_fresh = true;
  then(Mode::kTrack, "tracking");
  f.target_fresh = false;
  then(Mode::kHold, "target is too old");
  f.obstacles_fresh = false;
  then(Mode::kBrake, "obstacles are too old");
  f.obstacles_fresh = f.target_fresh = true;
  then(Mode::kTrack, "tracking");
  f.late = true;
  then(Mode::kBrake, "skipped");
  f.late = false;
  f.arm_fresh = false;
  then(Mode::kBrake, "arm state is too old");
  f.arm_lost = true;
  f.arm_consistent = false;
  then(Mode::kFault, "no arm state");
  f.arm_lost = false;
  f.arm_fresh = true;
  then(Mode::kFault, "consistent");
  f.arm_consistent = true;
  then(Mode::kHold, "holding");
  f.foreign_command = true;
  then(Mode::kBrake, "another controller");
  f.foreign_command = false;
  then(Mode::kTrack, "tracking");
  f.stop = true;
  then(Mode::kBrake, "stop");
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(tracking_needs_everything_fresh),
      cmocka_unit_test(a_goal_that_cannot_be_reached_changes_only_the_message_of_tracking),
      cmocka_unit_test(a_stopped_arm_does_not_start_on_old_obstacles),
      cmocka_unit_test(a_request_to_stop_never_leads_to_a_moving_mode),
      cmocka_unit_test(the_arm_does_not_move_while_another_controller_commands_it),
      cmocka_unit_test(the_arm_does_not_move_without_a_fresh_arm_state),
      cmocka_unit_test(the_arm_starts_only_with_consistent_states_and_known_obstacles),
      cmocka_unit_test(a_start_never_leads_directly_to_track),
      cmocka_unit_test(a_lost_or_inconsistent_arm_is_a_fault_of_that_name),
      cmocka_unit_test(a_fault_lasts_until_the_arm_is_consistent_and_the_obstacles_fresh),
      cmocka_unit_test(a_fault_is_named_exactly_in_mode_fault),
      cmocka_unit_test(every_reason_to_brake_leads_to_brake),
      cmocka_unit_test(without_a_fresh_target_or_an_operators_consent_the_mode_is_hold),
      cmocka_unit_test(a_running_controller_waits_again_only_after_a_fault_without_obstacles),
      cmocka_unit_test(every_mode_is_reachable_and_has_a_message),
      cmocka_unit_test(an_ordinary_run_passes_through_the_expected_modes),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
