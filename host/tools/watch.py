#!/usr/bin/env python3
"""Show the state of the controller in the terminal. Without a terminal: print one line ten times a second."""
import argparse
import curses
import math
import sys

import wire

PERIOD_S = 0.1
STALE_S = 0.5          # a controller that is silent for longer is not running
OLD_OBSTACLES_S = 0.1  # as timeouts.obstacles_s: the clearance to older obstacles is not known
CHANNELS = ["CONTROLLER_STATUS", "ARM_STATE", "TARGET", "JOINT_TARGET", "OBSTACLES"]


def constants(prefix):
    """Value -> name in words of the status constants with this prefix."""
    kind = wire.controller_status_t
    return dict(sorted((getattr(kind, name), name[len(prefix):].lower().replace("_", " ")) for name in dir(kind)
                       if name.startswith(prefix)))


FAULTS, LIMITS = constants("FAULT_"), constants("LIMITING_")


def bar(value, full, width=30):
    """A text bar of value / full; empty for NaN, full for infinity."""
    share = 0.0 if math.isnan(value) else min(max(value / full, 0.0), 1.0)
    return "#" * round(share * width) + "." * (width - round(share * width))


def speed_text(status):
    """The operator's speed; empty at full speed, and where the message says that the arm is paused."""
    return "" if "paused" in status.message or status.speed_scale >= 1 else f"at {status.speed_scale:.0%} speed"


def foresight_text(status):
    """The foresight status; empty while the law needs no guide (DIRECT)."""
    if status.foresight == status.GUIDED:
        left_s = status.guide_horizon
        return f"guided for the next {left_s:.1f} s" if left_s > 0 else "guided, at the end of the path"
    return "no path known" if status.foresight == status.WAITING else ""


def message_text(status):
    """The message without the control characters that a terminal would execute."""
    return "".join(letter if letter.isprintable() else "?" for letter in status.message)


def mode_text(status):
    """The mode and the message, where that says more than the mode."""
    message = message_text(status)
    return wire.MODES.get(status.mode, str(status.mode)), "" if message == "tracking" else message


def target_text(status):
    return f"{status.target_distance:.3f} m" if math.isfinite(status.target_distance) else "no target"


def goal_text(ages_s):
    """Which kind of target came last; the newest counts."""
    kinds = {"TARGET": "of the tool", "JOINT_TARGET": "a posture"}
    ages_s = {channel: age_s for channel, age_s in ages_s.items() if channel in kinds}
    return kinds[min(ages_s, key=ages_s.get)] if ages_s else "none received"


def clearance_text(status, ages_s):
    # A viewer that is late itself receives both late.
    older_s = ages_s.get("OBSTACLES", 0.0) - ages_s.get("CONTROLLER_STATUS", 0.0)
    if older_s > OLD_OBSTACLES_S or "obstacles are too old" in status.message:
        return "unknown, the obstacles are too old"
    if math.isnan(status.clearance):
        return "unknown, no obstacles received yet"
    return f"{status.clearance:.3f} m" if math.isfinite(status.clearance) else "no obstacles"


def knows_clearance(status, ages_s):
    """Whether there is a status, it is current, and it states a clearance."""
    return status is not None and not stale_text(ages_s) and not clearance_text(status, ages_s).startswith("unknown")


def nearest_text(status):
    """The link and the obstacle that the clearance is between; empty without obstacles."""
    if status.nearest_obstacle == -1:
        return ""
    arm, link = divmod(-status.nearest_obstacle, 10000)  # docs/wire.md
    other = (f"obstacle {status.nearest_obstacle}" if status.nearest_obstacle >= 0 else
             f"link {link} of another arm" if arm else f"surroundings[{link - 2}]")
    return f"{status.nearest_link} and {other}"


def self_text(status):
    """The two links of the arm that have the least room, and their distance; empty if it was not measured."""
    if math.isnan(status.self_clearance):
        return ""
    return f"{' and '.join(status.self_links)} are {status.self_clearance * 1e3:.0f} mm apart"


def limits_text(status):
    return ", ".join(name for bit, name in LIMITS.items() if status.limiting & bit) or "nothing"


def fault_text(status):
    return FAULTS.get(status.fault, f"number {status.fault}")


def stale_text(ages_s):
    """Why there is nothing to show, or nothing current; empty while the controller is alive."""
    age_s = ages_s.get("CONTROLLER_STATUS")
    if age_s is None:
        return "waiting for CONTROLLER_STATUS"
    return f"stale for {age_s:.0f} s: the controller is silent" if age_s > STALE_S else ""


def brief(status, ages_s):
    parts = [f"{wire.MODES.get(status.mode, status.mode):5}", f"target {target_text(status)}",
             f"clearance {clearance_text(status, ages_s)}", f"cycle {status.cycle_time * 1e6:.0f} us",
             self_text(status) if status.limiting & status.LIMITING_SELF else "",
             f"fault: {fault_text(status)}" if status.fault else "", foresight_text(status), speed_text(status),
             "" if status.message.startswith("fault: ") else message_text(status)]
    return "  ".join(filter(None, parts))


def joint_lines(arm, age_s):
    if arm is None:
        return ["no arm state received"]
    joints = enumerate(zip(arm.joint_position, arm.joint_velocity), 1)
    stale = [f"arm state: stale for {age_s:.0f} s"] if age_s > STALE_S else []
    return stale + [f"joint {i:2} {q:8.3f} rad {qd:8.3f} rad/s" for i, (q, qd) in joints]


def lines(latest, ages_s):
    """latest: channel -> message; ages_s: channel -> s since that message."""
    status, stale = latest.get("CONTROLLER_STATUS"), stale_text(ages_s)
    if status is None:
        return [stale]
    clearance = clearance_text(status, ages_s)
    obstacles = latest["OBSTACLES"].num_obstacles if "OBSTACLES" in latest else "none received"
    mode = f"{wire.MODES.get(status.mode, status.mode)}   {foresight_text(status)}   {message_text(status)} " \
           f"{speed_text(status)}"
    return [f"{stale}; last: {mode}" if stale else mode, "",
            f"to target  {target_text(status):>10}  {bar(status.target_distance, 1.0)}",
            f"clearance  {clearance:>10}" + (f"  {bar(status.clearance, 0.5)}  {nearest_text(status)}"
                                             if clearance.endswith(" m") else ""),
            f"cycle      {status.cycle_time * 1e6:7.0f} us  {bar(status.cycle_time, 0.001)}  of CPU time, "
            f"{status.wake_latency * 1e6:.0f} us late, {status.skipped_cycles} skipped", "",
            f"limited by {limits_text(status)}; fault: {fault_text(status)}; {status.rejected_messages} messages "
            "rejected",
            f"links: {self_text(status) or 'distances not measured'}",
            f"obstacles: {obstacles}; target: {goal_text(ages_s)}", "",
            *joint_lines(latest.get("ARM_STATE"), ages_s.get("ARM_STATE", 0.0))]


def dashboard(screen, latest):
    curses.use_default_colors()
    while True:
        latest.receive(PERIOD_S)
        screen.erase()
        height, width = screen.getmaxyx()
        for row, text in enumerate(lines(latest, latest.ages_s())[:height]):
            screen.insnstr(row, 0, text, width)
        screen.refresh()


def plain(latest):
    """A line for every status; while the controller is silent one for every second, before the first status one."""
    shown_s = None
    while True:
        latest.receive(PERIOD_S)
        ages_s = latest.ages_s()
        if status := latest.pop("CONTROLLER_STATUS", None):
            print(brief(status, ages_s), flush=True)
        elif (stale := stale_text(ages_s)) and (silent_s := int(ages_s.get("CONTROLLER_STATUS", 0))) != shown_s:
            print(stale, flush=True)
            shown_s = silent_s


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plain", action="store_true", help="print lines in a terminal as well")
    wire.add_lcm_url(parser)
    arguments = parser.parse_args()
    latest = wire.LatestMessages(CHANNELS, arguments.lcm_url)
    try:
        if arguments.plain or not sys.stdout.isatty():
            plain(latest)
        curses.wrapper(dashboard, latest)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
