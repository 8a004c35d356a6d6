#!/usr/bin/env python3
"""Compare the forward kinematics of arm-check with Pinocchio, for several arms at random configurations."""
import argparse
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pinocchio as pin

ROOT = Path(__file__).resolve().parents[2]
ROBOTS = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
ARMS = [
    (ROBOTS / "panda_description/urdf/panda.urdf", "panda_link0", "panda_hand_tcp"),
    (ROBOTS / "xarm_description/urdf/xarm7.urdf", "link_base", "link_eef"),
    (ROOT / "urdf/iiwa14.urdf", "base_link", "flange"),
    (ROOT / "urdf/panda.urdf", "panda_link0", "panda_tool"),
    (ROOT / "urdf/lwa3.urdf", "base_link", "tool"),
    (ROOT / "tests/data/arm6.urdf", "foot", "tip"),
    (ROOT / "tests/data/arm8.urdf", "mount", "flange"),
]


def chain(model, base, tip):
    """Pinocchio's indices of the joints from base to tip."""
    parent = lambda frame: model.frames[model.getFrameId(frame)].parentJoint
    of_base = set(model.supports[parent(base)])
    return [joint for joint in model.supports[parent(tip)] if joint not in of_base]


def configuration(model, joints, positions):
    """Pinocchio's configuration vector; all other joints are at 0."""
    q = pin.neutral(model)
    for joint, position in zip(joints, positions):
        at, size = model.joints[joint].idx_q, model.joints[joint].nq
        # Pinocchio represents a continuous joint by cosine and sine.
        q[at:at + size] = [position] if size == 1 else [np.cos(position), np.sin(position)]
    return q


def pose(model, data, base, tip, q):
    """Of the tip in the frame of the base."""
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[model.getFrameId(base)].inverse() * data.oMf[model.getFrameId(tip)]


def poses_of_pinocchio(model, base, tip, postures, joints):
    """One row for each posture: x y z, then the rotation by rows."""
    data = model.createData()
    poses = [pose(model, data, base, tip, configuration(model, joints, posture)) for posture in postures]
    return np.array([[*one.translation, *one.rotation.ravel()] for one in poses])


def poses_of_arm_check(urdf, base, tip, postures):
    text = "\n".join(" ".join(repr(float(angle)) for angle in posture) for posture in postures)
    command = [ROOT / "build/arm-check", urdf, "--base", base, "--tip", tip, "--fk"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=120)
    if done.returncode:
        sys.exit(done.stderr.strip())
    return np.array([list(map(float, line.split())) for line in done.stdout.splitlines() if line[:1] in "-0123456789"])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="postures for each arm (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tolerance", type=float, default=1e-9,
                        help="for positions, m, and for rotation matrices (default %(default)s)")
    arguments = parser.parse_args()
    random, failed = np.random.default_rng(arguments.seed), 0
    for urdf, base, tip in ARMS:
        model = pin.buildModelFromUrdf(str(urdf))
        joints = chain(model, base, tip)
        postures = random.uniform(-np.pi, np.pi, (arguments.count, len(joints)))
        ours = poses_of_arm_check(urdf, base, tip, postures)
        gap = np.abs(ours - poses_of_pinocchio(model, base, tip, postures, joints)).max()
        passed = len(ours) == arguments.count and gap <= arguments.tolerance
        failed += not passed
        print(f"{'ok' if passed else 'FAIL':4}  {urdf.name:12} {base} to {tip}, {len(joints)} joints, "
              f"{arguments.count} postures: largest difference {gap:.1e}")
    print(f"{len(ARMS) - failed} passed, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    os.chdir(ROOT)
    main()
