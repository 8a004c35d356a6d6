#!/usr/bin/env python3
"""Show the state of the controller in the terminal. Without a terminal: print one line ten times a second."""
import argparse
import curses
import math
import sys

import wire

PERIOD_S = 0.1
CHANNELS = ["CONTROLLER_STATUS", "ARM_STATE", "TARGET", "OBSTACLES"]
LIMITING = {name[len("LIMITING_"):].lower().replace("_", " "): getattr(wire.controller_status_t, name)
            for name in dir(wire.controller_status_t) if name.startswith("LIMITING_")}


def bar(value, full, width=30):
    """A text bar of value / full; full as well for NaN and infinity."""
    share = min(max(value / full, 0.0), 1.0) if math.isfinite(value) else 1.0
    return "#" * round(share * width) + "." * (width - round(share * width))


def foresight_text(status):
    """The foresight status; empty while the law needs no guide (DIRECT)."""
    if status.foresight == status.GUIDED:
        return f"guided for the next {status.guide_horizon:.1f} s"
    return "no path known" if status.foresight == status.WAITING else ""


def message_text(status):
    """The message without the control characters that a terminal would execute."""
    return "".join(letter if letter.isprintable() else "?" for letter in status.message)


def brief(status):
    return (f"{wire.MODES.get(status.mode, status.mode):5}  target {status.target_distance:6.3f} m  clearance "
            f"{status.clearance:6.3f} m  cycle {status.cycle_time * 1e6:5.0f} us  {foresight_text(status)}  "
            f"{message_text(status)}")


def lines(latest):
    status, arm = latest.get("CONTROLLER_STATUS"), latest.get("ARM_STATE")
    if status is None:
        return ["waiting for CONTROLLER_STATUS"]
    limits = ", ".join(name for name, bit in LIMITING.items() if status.limiting & bit) or "nothing"
    obstacles = latest["OBSTACLES"].num_obstacles if "OBSTACLES" in latest else "none received"
    shown = [f"{wire.MODES.get(status.mode, status.mode)}   {foresight_text(status)}   {message_text(status)}", "",
             f"to target {status.target_distance:8.3f} m  {bar(status.target_distance, 1.0)}",
             f"clearance {status.clearance:8.3f} m  {bar(status.clearance, 0.5)}  {status.nearest_link}"
             f" and obstacle {status.nearest_obstacle}",
             f"cycle     {status.cycle_time * 1e6:8.0f} us {bar(status.cycle_time, 0.001)}  late "
             f"{status.wake_latency * 1e6:.0f} us, {status.skipped_cycles} skipped", "",
             f"limited by {limits}; fault {status.fault}; {status.rejected_messages} messages rejected",
             f"obstacles {obstacles}; target {'received' if 'TARGET' in latest else 'none received'}", ""]
    joints = zip(arm.joint_position, arm.joint_velocity) if arm else []
    return shown + [f"joint {i + 1:2} {q:8.3f} rad {qd:8.3f} rad/s" for i, (q, qd) in enumerate(joints)]


def dashboard(screen, latest):
    curses.use_default_colors()
    while True:
        latest.receive(PERIOD_S)
        screen.erase()
        height, width = screen.getmaxyx()
        for row, text in enumerate(lines(latest)[:height]):
            screen.insnstr(row, 0, text, width)
        screen.refresh()


def plain(latest):
    while True:
        latest.receive(PERIOD_S)
        if status := latest.pop("CONTROLLER_STATUS", None):
            print(brief(status), flush=True)


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
