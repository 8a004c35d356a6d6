#!/usr/bin/env python3
"""Let arms of example-robot-data reach random goals, without obstacles, and judge them by Pinocchio and Coal.

The straight way in joint space from start to goal is free on the meshes. Success: within DURATION_S the tool stays
within 10 mm, and no links touch on the way.
"""
import argparse
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
import yaml

from kinematics import ROBOTS, ROOT
from meshes import ARMS, MeshArm

sys.path.insert(0, str(ROOT / "host/tools"))
import runs

DURATION_S = 20
NEAR_M = 0.01
WAY_M = (0.15, 1.2)   # from start to goal
WAY_POINTS = 60
JUDGED_CYCLES = 5     # every so many cycles of a run are judged


def witnessed(arm, random):
    """(start, goal): joint positions; the straight way between them is free."""
    while True:
        start, goal = random.uniform(arm.lower, arm.upper, (2, len(arm.lower)))
        if WAY_M[0] < np.linalg.norm(arm.tool_m(start) - arm.tool_m(goal)) < WAY_M[1] and all(
                arm.is_free(start + share * (goal - start)) for share in np.linspace(0, 1, WAY_POINTS)):
            return start, goal


def play(robot, start, goal_m, folder):
    """The joint positions of a run, one row for each period."""
    names = {"urdf": str(robot.urdf), "base": robot.base, "tip": robot.tip}
    config, scenario, record = folder / "config.yaml", folder / "scenario.yaml", folder / "run.csv"
    config.write_text(yaml.safe_dump({"robot": {**names, "package_path": [str(ROBOTS.parents[1])]}}))
    scenario.write_text(yaml.safe_dump({
        "title": "reach", "robot": names, "config": str(config), "duration_s": DURATION_S, "rate_hz": 100,
        "start_rad": start.tolist(), "plant": {"kind": "ideal"},
        "target": {"position_m": goal_m.tolist(), "velocity_mps": [0, 0, 0]}}))
    runs.execute(scenario, "sidestep", record, config=config, lcm_url=runs.private_url())
    columns = runs.read_csv(record)
    return np.column_stack([column for name, column in columns.items() if name[0] == "q" and name[1].isdigit()])


def check(name, count, seed, folder):
    """Prints what failed and the sum of one arm, and returns whether all succeeded."""
    arm, random, failed = MeshArm(ARMS[name]), np.random.default_rng(seed), 0
    for number in range(count):
        start, goal = witnessed(arm, random)
        positions = play(ARMS[name], start, arm.tool_m(goal), folder)
        off_m = np.linalg.norm(arm.tool_m(positions[-1]) - arm.tool_m(goal))
        touching = next((arm.links(pairs[0]) for pairs in map(arm.touching, positions[::JUDGED_CYCLES]) if pairs), None)
        if off_m > NEAR_M or touching:
            failed += 1
            print(f"      {name}, reach {number}: {1e3 * off_m:.1f} mm from the goal, "
                  + (f"{' and '.join(touching)} touch" if touching else "no links touch"))
    print(f"{'FAIL' if failed else 'ok':4}  {name}: {count - failed} of {count} reaches", flush=True)
    return failed == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10, help="reaches of each arm (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--arm", choices=ARMS, help="only this one")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        passed = [check(name, arguments.count, arguments.seed, Path(folder))
                  for name in ([arguments.arm] if arguments.arm else ARMS)]
    print(f"{sum(passed)} passed, {len(passed) - sum(passed)} failed")
    return 0 if all(passed) else 1


if __name__ == "__main__":
    os.chdir(ROOT)
    runs.main_of(main)
