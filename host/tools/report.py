#!/usr/bin/env python3
"""Turn an LCM log of a run into one self-contained HTML page with a 3-D replay and curves.

The log may come from build/sim --log, record.py or lcm-logger. The arm and its channels are those of --config. Without
--config they are those of the scenario after which `make run` has named the log (its first arm, if it has two).
"""
import argparse
import json
import math
import sys
from pathlib import Path

import lcm

import arm
import runs
import wire
from errors import reason

FRAME_S = 0.03   # least time between two frames of the replay
MOST_FRAMES = 4000
GOALS = ("TARGET", "JOINT_TARGET")


class NoRun(Exception):
    """The log cannot be shown; the text is one line with the reason."""


def samples(file, channels=None):
    """Yields (t_s, kind -> latest message) at every CONTROLLER_STATUS after the first arm state.

    channels: channel name in the log -> kind, a key of wire.TYPES; by default the two are equal.
    """
    latest, start_us, channels = {}, None, channels or {kind: kind for kind in wire.TYPES}
    for event in lcm.EventLog(str(file)):
        kind = channels.get(event.channel)
        if kind is None or (message := wire.decoded(kind, event.data)) is None:
            continue
        if kind in GOALS:  # the newest of both kinds counts
            latest = {other: value for other, value in latest.items() if other not in GOALS}
        latest[kind] = message
        if kind == "CONTROLLER_STATUS" and "ARM_STATE" in latest:
            start_us = event.timestamp if start_us is None else start_us
            yield (event.timestamp - start_us) / 1e6, dict(latest)


def thinned(rows):
    """The rows at a distance of at least FRAME_S, about MOST_FRAMES of them at most."""
    step_s = max(FRAME_S, rows[-1][0] / MOST_FRAMES)
    kept, due_s = [], 0.0
    for row in rows:
        if row[0] >= due_s:
            kept.append(row)
            due_s = row[0] + step_s - 1e-6
    return kept


def numbers(values, digits=4):
    """Rounded numbers for JSON, which has no infinity and no NaN: None stands for both."""
    return [round(float(value), digits) if math.isfinite(value) else None for value in values]


def shape_poses(shapes, links):
    """12 numbers for each shape: its centre, m, and its rotation by rows, base frame."""
    poses = []
    for shape in shapes:
        position, rotation = links[shape.frame]
        poses.append(numbers([*(position + rotation @ shape.position), *(rotation @ shape.rotation).ravel()]))
    return poses


def obstacle_row(obstacle):
    """Shape, size, centre, rotation by rows, velocity."""
    return [obstacle.shape, *numbers([*obstacle.size, *obstacle.position,
                                      *arm.rotation_of_quaternion(obstacle.quaternion).ravel(), *obstacle.velocity])]


def frame_of(messages, chain, shapes):
    """One frame of the replay."""
    links = arm.link_poses(chain, messages["ARM_STATE"].joint_position)
    target, obstacles = messages.get("TARGET") or messages.get("JOINT_TARGET"), messages.get("OBSTACLES")
    goal = target and arm.goal_m(chain, target)
    return {"arm": shape_poses(shapes, links), "tool": numbers(links[-1][0]),
            "target": None if goal is None else numbers(goal),
            "obstacles": [obstacle_row(obstacle) for obstacle in obstacles.obstacles] if obstacles else []}


def joint_lines(rows, field, count):
    return {f"q{i + 1}": numbers(getattr(messages["ARM_STATE"], field)[i] for _, messages in rows)
            for i in range(count)}


def status_line(rows, field, factor=1.0):
    return numbers(getattr(messages["CONTROLLER_STATUS"], field) * factor for _, messages in rows)


def curves(rows, joints):
    """[(title, curve name -> values)], one pair for each plot."""
    return [("Tool to target, m", {"distance": status_line(rows, "target_distance")}),
            ("Clearance, m", {"clearance": status_line(rows, "clearance")}),
            ("Joint angles, rad", joint_lines(rows, "joint_position", joints)),
            ("Joint speeds, rad/s", joint_lines(rows, "joint_velocity", joints)),
            ("Mode: 0 wait, 1 hold, 2 track, 3 brake, 4 fault", {"mode": status_line(rows, "mode")}),
            ("CPU time of a whole cycle, us", {"time": status_line(rows, "cycle_time", 1e6)})]


def data_of(log, robot, channels=None):
    if not log.is_file():
        raise NoRun(f"{log}: no such file")
    chain, shapes = arm.chain(*robot), arm.shapes(*robot)
    joints = sum(joint.axis is not None for joint in chain)
    rows = [row for row in samples(log, channels) if row[1]["ARM_STATE"].num_joints == joints]
    if not rows:
        raise NoRun(f"{log}: no CONTROLLER_STATUS after an ARM_STATE of {joints} joints")
    frames = thinned(rows)
    lines = thinned(rows) if len(rows) > 4 * MOST_FRAMES else rows
    return {"title": log.name, "shapes": [[shape.kind, *shape.size] for shape in shapes],
            "t": numbers(t for t, _ in frames), "frames": [frame_of(messages, chain, shapes) for _, messages in frames],
            "messages": [f"{wire.MODES.get(status.mode)} {status.message}"
                         for status in (messages["CONTROLLER_STATUS"] for _, messages in frames)],
            "curve_t": numbers(t for t, _ in lines), "curves": curves(lines, joints)}


def page(data):
    template = (Path(__file__).parent / "report.html").read_text()
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return template.replace("/*DATA*/null", text)


def config_for(log):
    """The configuration of the scenario after which the log is named, else that of the LWA3."""
    scenario_file = runs.ROOT / "host/scenarios" / f"{log.stem.removesuffix('-realtime')}.yaml"
    if not scenario_file.is_file():
        return arm.CONFIG
    return runs.config_of(runs.arms_of(runs.load_scenario(scenario_file))[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path, metavar="LOG")
    parser.add_argument("-o", "--output", type=Path, default=Path("report.html"),
                        help="page to write (default: %(default)s)")
    parser.add_argument("--config", type=Path,
                        help="configuration of the controller (default: that of the scenario after which LOG is named, "
                             "else that of the LWA3)")
    arm.add_robot(parser)
    arguments = parser.parse_args()
    try:
        config = arguments.config or config_for(arguments.log)
        robot, channels = arm.robot_of(config, arguments), arm.channels_of(config)
        arguments.output.write_text(page(data_of(arguments.log, robot, channels)))
    except (NoRun, runs.RunFailed, OSError, ValueError) as error:
        sys.exit(f"report.py: {reason(error)}")
    print(f"wrote {arguments.output} ({arguments.output.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    main()
