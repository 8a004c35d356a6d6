#!/usr/bin/env python3
"""A dashboard of the controller in the terminal; one line ten times a second where there is no terminal."""
import argparse
import curses
import math
import sys

import bus

PERIOD_S = 0.1
CHANNELS = ["CONTROLLER_STATUS", "ARM_STATE", "TARGET", "OBSTACLES"]
LIMITING = {name[len("LIMITING_"):].lower().replace("_", " "): getattr(bus.controller_status_t, name)
            for name in dir(bus.controller_status_t) if name.startswith("LIMITING_")}


def bar(value, full, width=30):
    """For the eye; what is not known or infinite is shown full."""
    share = min(max(value / full, 0.0), 1.0) if math.isfinite(value) else 1.0
    return "#" * round(share * width) + "." * (width - round(share * width))


def outlook(status):
    """In words what foresight expects; nothing while the law alone will do."""
    if status.foresight == status.GUIDED:
        return f"guided for {status.guide_horizon:.1f} s"
    return "no way known" if status.foresight == status.WAITING else ""


def words(status):
    """Its message without what a terminal would obey."""
    return "".join(letter if letter.isprintable() else "?" for letter in status.message)


def brief(status):
    return (f"{bus.MODES.get(status.mode, status.mode):5}  target {status.target_distance:6.3f} m  clearance "
            f"{status.clearance:6.3f} m  cycle {status.cycle_time * 1e6:5.0f} us  {outlook(status)}  {words(status)}")


def lines(heard):
    status, arm = heard.get("CONTROLLER_STATUS"), heard.get("ARM_STATE")
    if status is None:
        return ["waiting for CONTROLLER_STATUS"]
    limits = ", ".join(name for name, bit in LIMITING.items() if status.limiting & bit) or "nothing"
    obstacles = heard["OBSTACLES"].num_obstacles if "OBSTACLES" in heard else "none heard"
    shown = [f"{bus.MODES.get(status.mode, status.mode)}   {outlook(status)}   {words(status)}", "",
             f"to target {status.target_distance:8.3f} m  {bar(status.target_distance, 1.0)}",
             f"clearance {status.clearance:8.3f} m  {bar(status.clearance, 0.5)}  {status.nearest_link}"
             f" and obstacle {status.nearest_obstacle}",
             f"cycle     {status.cycle_time * 1e6:8.0f} us {bar(status.cycle_time, 0.001)}  late "
             f"{status.wake_latency * 1e6:.0f} us, {status.skipped_cycles} skipped", "",
             f"limited by {limits}; fault {status.fault}; {status.rejected_messages} messages rejected",
             f"obstacles {obstacles}; target {'heard' if 'TARGET' in heard else 'none heard'}", ""]
    joints = zip(arm.joint_position, arm.joint_velocity) if arm else []
    return shown + [f"joint {i + 1:2} {q:8.3f} rad {qd:8.3f} rad/s" for i, (q, qd) in enumerate(joints)]


def dashboard(screen, heard):
    curses.use_default_colors()
    while True:
        heard.listen(PERIOD_S)
        screen.erase()
        height, width = screen.getmaxyx()
        for row, text in enumerate(lines(heard)[:height]):
            screen.insnstr(row, 0, text, width)
        screen.refresh()


def plain(heard):
    while True:
        heard.listen(PERIOD_S)
        if status := heard.pop("CONTROLLER_STATUS", None):
            print(brief(status), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plain", action="store_true", help="lines also in a terminal")
    bus.add_lcm_url(parser)
    arguments = parser.parse_args()
    heard = bus.Newest(CHANNELS, arguments.lcm_url)
    try:
        if arguments.plain or not sys.stdout.isatty():
            plain(heard)
        curses.wrapper(dashboard, heard)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
