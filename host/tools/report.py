#!/usr/bin/env python3
"""Turn an lcm-logger log of a run into one HTML page that needs nothing else: 3-D replay and curves.

Logs of build/sim --log, of host/tools/record.py and of lcm-logger are all alike. The arm is that of --config, heard on
its channels; of a log that `make run` wrote, that of the scenario, and the first where there are two.
"""
import argparse
import json
import math
import sys
from pathlib import Path

import lcm

import arm
import bus
import runs

FRAME_S = 0.03   # between two pictures of the replay
MOST_FRAMES = 4000


class NoRun(Exception):
    """The text is one line that says what the log lacks."""


def samples(file, channels=None):
    """Yields (t_s, channel -> newest message) after every CONTROLLER_STATUS that follows an arm state.

    channels: name in the log -> one of bus.TYPES; default: each by its own name.
    """
    newest, start_us, channels = {}, None, channels or {name: name for name in bus.TYPES}
    for event in lcm.EventLog(str(file)):
        name = channels.get(event.channel)
        if name is None or (message := bus.decoded(name, event.data)) is None:
            continue
        newest[name] = message
        if name == "CONTROLLER_STATUS" and "ARM_STATE" in newest:
            start_us = event.timestamp if start_us is None else start_us
            yield (event.timestamp - start_us) / 1e6, dict(newest)


def thinned(rows):
    """At most one row in FRAME_S, and fewer of a long run."""
    step_s = max(FRAME_S, rows[-1][0] / MOST_FRAMES)
    kept, due_s = [], 0.0
    for row in rows:
        if row[0] >= due_s:
            kept.append(row)
            due_s = row[0] + step_s - 1e-6
    return kept


def numbers(values, digits=4):
    """For JSON, which has no infinity."""
    return [round(float(value), digits) if math.isfinite(value) else None for value in values]


def shape_places(shapes, frames):
    """Per shape its centre and the rows of its rotation, base frame, 12 numbers."""
    placed = []
    for shape in shapes:
        place, turn = frames[shape.frame]
        placed.append(numbers([*(place + turn @ shape.place), *(turn @ shape.turn).ravel()]))
    return placed


def obstacle_rows(message):
    return [[obstacle.shape, *numbers([*obstacle.size, *obstacle.position, *arm.turn_of(obstacle.quaternion).ravel(),
                                       *obstacle.velocity])] for obstacle in message.obstacles] if message else []


def picture(heard, links, shapes):
    """What one moment of the replay shows."""
    frames = arm.frames(links, heard["ARM_STATE"].joint_position)
    target = heard.get("TARGET")
    return {"arm": shape_places(shapes, frames), "tool": numbers(frames[-1][0]),
            "target": numbers(target.position) if target else None, "obstacles": obstacle_rows(heard.get("OBSTACLES"))}


def joint_lines(rows, field, count):
    return {f"q{i + 1}": numbers(getattr(heard["ARM_STATE"], field)[i] for _, heard in rows) for i in range(count)}


def status_line(rows, field, factor=1.0):
    return numbers(getattr(heard["CONTROLLER_STATUS"], field) * factor for _, heard in rows)


def curves(rows, joints):
    """(title, name -> values) of every plot."""
    return [("Tool to target, m", {"distance": status_line(rows, "target_distance")}),
            ("Clearance, m", {"clearance": status_line(rows, "clearance")}),
            ("Joint angles, rad", joint_lines(rows, "joint_position", joints)),
            ("Joint speeds, rad/s", joint_lines(rows, "joint_velocity", joints)),
            ("Mode: 0 wait, 1 hold, 2 track, 3 brake, 4 fault", {"mode": status_line(rows, "mode")}),
            ("CPU time of a cycle, us", {"time": status_line(rows, "cycle_time", 1e6)})]


def data_of(log, robot, channels=None):
    if not log.is_file():
        raise NoRun(f"{log}: no such file")
    links, shapes = arm.chain(*robot), arm.shapes(*robot)
    joints = sum(axis is not None for _, _, axis in links)
    rows = [row for row in samples(log, channels) if row[1]["ARM_STATE"].num_joints == joints]
    if not rows:
        raise NoRun(f"{log}: no CONTROLLER_STATUS with an ARM_STATE of {joints} joints before it")
    frames = thinned(rows)
    lines = thinned(rows) if len(rows) > 4 * MOST_FRAMES else rows
    return {"title": log.name, "shapes": [[shape.kind, *shape.size] for shape in shapes],
            "t": numbers(t for t, _ in frames), "frames": [picture(heard, links, shapes) for _, heard in frames],
            "messages": [f"{bus.MODES.get(heard['CONTROLLER_STATUS'].mode)} {heard['CONTROLLER_STATUS'].message}"
                         for _, heard in frames],
            "curve_t": numbers(t for t, _ in lines), "curves": curves(lines, joints)}


def page(data):
    template = (Path(__file__).parent / "report.html").read_text()
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return template.replace("/*DATA*/null", text)


def config_for(log):
    """What the scenario that a log is named after was played with; else the LWA3's."""
    scenario_file = arm.ROOT / "host/scenarios" / f"{log.stem.removesuffix('-realtime')}.yaml"
    if not scenario_file.is_file():
        return arm.CONFIG
    return runs.config_of(runs.arms_of(runs.load_scenario(scenario_file))[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path, metavar="LOG")
    parser.add_argument("-o", "--output", type=Path, default=Path("report.html"), help="default: %(default)s")
    parser.add_argument("--config", type=Path, help="default: of the scenario that LOG is named after, else the LWA3's")
    arm.add_robot(parser)
    arguments = parser.parse_args()
    try:
        config = arguments.config or config_for(arguments.log)
        robot, channels = arm.robot_of(config, arguments), arm.channels_of(config)
        arguments.output.write_text(page(data_of(arguments.log, robot, channels)))
    except (NoRun, runs.RunFailed, OSError, ValueError) as error:
        sys.exit(f"report.py: {error}")
    print(f"wrote {arguments.output} ({arguments.output.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    main()
