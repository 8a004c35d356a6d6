#!/usr/bin/env python3
"""Compare which configurations arm-check allows with those in which the meshes touch, by Pinocchio and Coal.

Fails if the controller allows one in which links touch, forbids more than 3 % of the others, or more than 0.3 % of
those in which all links are 20 mm apart.
"""
import argparse
import os
import subprocess
import sys

import numpy as np

from kinematics import ROBOTS, ROOT
from meshes import ARMS, MeshArm

MOST_FORBIDDEN, MOST_FORBIDDEN_FAR, FAR_M = 0.03, 0.003, 0.02
# Links below the arm stand at joints that arm-check takes no positions for.
JUDGED = [name for name in ARMS if name != "tiago"]


def rooms_m(robot, postures):
    """Of each posture: how far the links are above their clearances, by the controller's shapes, m."""
    command = [ROOT / "build/arm-check", robot.urdf, "--base", robot.base, "--tip", robot.tip, "--self",
               "--package-path", ROBOTS.parents[1]]
    text = "\n".join(" ".join(map(repr, map(float, posture))) for posture in postures)
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr.strip())
    return np.array([float(line.split()[0]) for line in done.stdout.splitlines()])


def check(name, count, seed):
    """Prints the counts of one arm and returns whether they are as they should be."""
    arm = MeshArm(ARMS[name])
    postures = np.random.default_rng(seed).uniform(arm.lower, arm.upper, (count, len(arm.lower)))
    forbidden = rooms_m(ARMS[name], postures) < 0.0
    free = np.array([arm.is_free(posture) for posture in postures])
    far_forbidden = sum(arm.distance_m(posture) >= FAR_M for posture in postures[free & forbidden])
    allowed, share = np.sum(~free & ~forbidden), np.sum(free & forbidden) / np.sum(free)
    sample = postures[free][:500]  # distances take long
    far = np.mean([arm.distance_m(posture) >= FAR_M for posture in sample]) * np.sum(free)
    passed = allowed == 0 and share <= MOST_FORBIDDEN and far_forbidden <= MOST_FORBIDDEN_FAR * far
    print(f"{'ok' if passed else 'FAIL':4}  {name}: {count} configurations, links touch in {np.sum(~free)}, of which "
          f"{allowed} are allowed; of the others {100 * share:.2f} % are forbidden, and {far_forbidden} of about "
          f"{far:.0f} that are 20 mm free", flush=True)
    return passed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000, help="configurations of each arm (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    passed = [check(name, arguments.count, arguments.seed) for name in JUDGED]
    print(f"{sum(passed)} passed, {len(passed) - sum(passed)} failed")
    return 0 if all(passed) else 1


if __name__ == "__main__":
    os.chdir(ROOT)
    sys.exit(main())
