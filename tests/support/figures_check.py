#!/usr/bin/env python3
"""Checks of what the figures say and where they say it, on made-up runs; a failed check ends with an assertion."""
import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "host/tools"), str(ROOT / "build/lcm/python")]
import labels
import outcome
import runs
import style
import words

T_S = np.arange(0, 10.005, 0.01)
LWA3 = {"config": "firmware/config/lwa3.yaml", "robot": {"urdf": "urdf/lwa3.urdf", "base": "base_link", "tip": "tool"}}
FAR_M = np.full(len(T_S), 0.5)


def moment(centre_s, least_m, slope_mps=0.1):
    """Clearance with its least value at a time."""
    return least_m + slope_mps * np.abs(T_S - centre_s)


def run_of(*obstacles, distance_m=None, own_m=None, grasp=()):
    """A run of the upright LWA3; obstacles: (clearance at every row, speed along y in m/s)."""
    columns = {"t_s": T_S, "neighbour_clearance_m": np.full(len(T_S), np.inf),
               "self_clearance_m": FAR_M if own_m is None else own_m,
               "target_distance_m": FAR_M if distance_m is None else distance_m,
               "clearance_m": np.min([clearance_m for clearance_m, _ in obstacles], axis=0)}
    columns |= {f"q{i}_rad": 0 * T_S for i in range(1, 8)}
    for i, (clearance_m, speed_mps) in enumerate(obstacles, 1):
        columns |= {f"o{i}_clearance_m": clearance_m, f"o{i}_x_m": 0 * T_S + i, f"o{i}_y_m": speed_mps * T_S,
                    f"o{i}_z_m": 0 * T_S, f"o{i}_qw": 0 * T_S + 1}
        columns |= {f"o{i}_q{part}": 0 * T_S for part in "xyz"}
    listed = [{"id": i, "shape": "sphere", "radius_m": 0.1} for i in range(1, len(obstacles) + 1)]
    return runs.Run("made-up", "paper", LWA3 | {"obstacles": listed, "grasp": list(grasp)}, columns, 0)


def arrivals():
    """A tool that was at its target and left is told apart from one that never came, and from one on its way."""
    came, left, away, coming = (run_of((FAR_M, 0), distance_m=distance_m) for distance_m in (
        np.where(T_S < 3, 0.2, 0.001), np.where((T_S > 2) & (T_S < 5), 0.005, 0.047), 0 * T_S + 0.3, 0.5 - 0.02 * T_S))
    assert words.verdict(came).endswith("no contact, arrives at 3.00 s"), words.verdict(came)
    assert words.verdict(left).endswith("arrives, but leaves again"), words.verdict(left)
    assert words.ending(left) == "at the target until 4.99 s, 47.0 mm from the target at the end", words.ending(left)
    assert words.verdict(away).endswith("does not arrive") and "approaching" not in words.ending(away)
    assert words.ending(coming) == "0.300 m from the target at the end, still approaching", words.ending(coming)


def decisive_moments():
    """Contact is drawn first, then touching links, then what comes and leaves again, then the least clearance."""
    wall, visitor, follower = (moment(2, 0.03), 0), (moment(5, 0.2), 0.3), (0.5 - 0.03 * T_S, 0.3)
    hit, own = (moment(7, -0.05), 0.3), np.where((T_S > 3) & (T_S < 4), -0.001, 0.5)
    cases = [([wall], {}, 2, "obstacle 1"), ([wall, visitor], {}, 5, "obstacle 2"),
             ([wall, follower], {}, 2, "obstacle 1"),  # does not leave
             ([wall, visitor], {"own_m": own}, 3.01, outcome.LINKS), ([wall, visitor, hit], {}, 6.51, "obstacle 3"),
             ([wall, visitor], {"grasp": [{"at_s": 0, "held": [2]}]}, 2, "obstacle 1")]  # moves only in the gripper
    for obstacles, more, at_s, name in cases:
        run = run_of(*obstacles, **more)
        found = outcome.closest(run)
        assert abs(T_S[found.row] - at_s) < 0.015 and found.name == name, (T_S[found.row], found.name, at_s, name)
    text = words.approach(run_of(wall, visitor))
    assert text == ("nearest: 30.0 mm to obstacle 1 at 2.00 s\n"
                    "nearest of what moves: 200.0 mm to obstacle 2 at 5.00 s (drawn)"), text
    text = words.approach(run_of((moment(3, -0.01), 0), hit))
    assert text.endswith("deepest: 50.0 mm in obstacle 2 at 7.00 s"), text
    assert "links touch each other" in words.verdict(run_of(wall, own_m=own))


def placed_labels():
    """Texts that name the same place cover neither each other nor a mark, and stay in the panel."""
    figure, axes = style.plt.subplots()
    placed = labels.Labels()
    placed.keep_free((0.5, 0.5), 10)
    for i in range(4):
        placed.add((0.5, 0.5), f"obstacle {i}")
    placed.add((1.0, 1.0), "in the corner")
    placed.place(axes)
    boxes = [text.get_window_extent() for text in axes.texts]
    centre = axes.transData.transform((0.5, 0.5))
    assert len(boxes) == 5 and not any(box.contains(*centre) for box in boxes)
    assert not any(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[:i])
    inside = axes.bbox.padded(2)
    assert all(inside.contains(*corner) for box in boxes for corner in (box.min, box.max)), boxes


def tasks():
    """The line below a title has whole sentences of the scenario's first comment, as many as fit."""
    text = "# A ball comes\n# at 0.5 m/s. " + "It is long, " * 15 + "is it not.\n# Third.\ntitle: x\n# Not this.\n"
    assert runs.task_of(text) == "A ball comes at 0.5 m/s.", runs.task_of(text)
    assert runs.task_of("# One.\n# Two.\ntitle: x\n") == "One. Two." and runs.task_of("title: x\n") == ""


def names():
    """An obstacle is called what the scenario calls it, else by its number, with which nobody counts persons."""
    run = run_of((moment(2, 0.03), 0), (FAR_M, 0), (FAR_M, 0))
    run.scenario["obstacles"][0]["name"], run.scenario["obstacles"][1]["kind"] = "table", "person"
    assert [outcome.obstacle_name(run, i) for i in range(3)] == ["table", "person (2)", "obstacle 3"]
    assert words.approach(run) == "nearest: 30.0 mm to table at 2.00 s (drawn)", words.approach(run)


CHECKS = {check.__name__: check for check in (arrivals, decisive_moments, placed_labels, tasks, names)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("check", choices=CHECKS)
    CHECKS[parser.parse_args().check]()
