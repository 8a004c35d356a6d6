#!/usr/bin/env python3
"""Compare lockstep cycles of build/controller --law paper over LCM with paper_law.py, on random states.

The limits are so wide that the state may change arbitrarily between cycles. Exit code 0: all differences are within
1e-6 rad/s.
"""
import csv
import io
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import lcm
import numpy as np
import yaml

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "build/lcm/python"))
from sidestep import controller_status_t, joint_command_t, joint_state_t, obstacle_t, obstacles_t, target_t

TOLERANCE_RADPS = 1e-6
PERIOD_US = 10_000
CYCLES_TO_TRACK = 60
# The states are independent of each other, hence no limits and no obstacle memory (coast_s).
WIDE = {"velocity_radps": 1e5, "acceleration_radps2": 1e8, "lower_rad": -1e6, "upper_rad": 1e6}


def numbers(row):
    return {key: float(value or 0) for key, value in row.items() if key != "kind"}


def cases(seed, count):
    """Random states as dictionaries of numbers, without those of the `planned` reading of V, which has a memory."""
    command = [sys.executable, ROOT / "tests/support/paper_law.py", "cases", "--seed", str(seed), "--count", str(count)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return [row for row in map(numbers, csv.DictReader(io.StringIO(text))) if row["planned"] == 0]


def values(row, prefix, suffixes):
    return [row[f"{prefix}{suffix}"] for suffix in suffixes]


def messages(row, utime):
    target = target_t()
    target.utime, target.tracks_orientation = utime, row["tracks_orientation"] == 1
    target.position, target.velocity = values(row, "target_", "xyz"), values(row, "target_v", "xyz")
    target.quaternion, target.angular_velocity = values(row, "target_q", "wxyz"), values(row, "target_w", "xyz")
    obstacles = obstacles_t()
    obstacles.utime, obstacles.num_obstacles = utime, int(row["obstacles"])
    for i in range(1, obstacles.num_obstacles + 1):
        obstacle = obstacle_t()
        obstacle.id, obstacle.size = i, [0.05, 0.0, 0.0]
        obstacle.position, obstacle.velocity = values(row, f"o{i}_", "xyz"), values(row, f"o{i}_v", "xyz")
        obstacles.obstacles.append(obstacle)
    arm = joint_state_t()
    arm.utime, arm.num_joints = utime, 7
    arm.joint_position, arm.joint_velocity = values(row, "q", range(1, 8)), values(row, "qd", range(1, 8))
    return {"TARGET": target, "OBSTACLES": obstacles, "ARM_STATE": arm}


def send(network, row, utime):
    for channel, message in messages(row, utime).items():
        network.publish(channel, message.encode())


def step(network, replies, row, utime):
    """Runs one cycle and returns the commanded joint velocity."""
    replies.clear()
    send(network, row, utime)
    if not answered(network, replies, 5.0):
        sys.exit("law_over_lcm: no reply from the controller")
    return np.array(joint_command_t.decode(replies["ARM_COMMAND"]).joint_velocity)


def answered(network, replies, limit_s):
    end = time.monotonic() + limit_s
    while "CONTROLLER_STATUS" not in replies and time.monotonic() < end:
        network.handle_timeout(20)
    return "CONTROLLER_STATUS" in replies


def wait_until_it_listens(network, replies, row):
    """Sends the first row until the controller, which starts meanwhile, answers; returns the time of the last one."""
    for utime in range(PERIOD_US, 100 * PERIOD_US, PERIOD_US):
        send(network, row, utime)
        if answered(network, replies, 0.3):
            while network.handle_timeout(200):  # replies to earlier tries
                pass
            return utime
    sys.exit("law_over_lcm: the controller does not start")


def compare(network, rows):
    replies, worst = {}, 0.0
    network.subscribe("ARM_COMMAND|CONTROLLER_STATUS", replies.__setitem__)
    start = utime = wait_until_it_listens(network, replies, rows[0])
    for row in [rows[0]] * CYCLES_TO_TRACK + rows:
        utime += PERIOD_US
        velocity = step(network, replies, row, utime)
        if utime > start + CYCLES_TO_TRACK * PERIOD_US:
            mode = controller_status_t.decode(replies["CONTROLLER_STATUS"]).mode
            if mode != controller_status_t.TRACK:
                sys.exit(f"law_over_lcm: mode {mode} instead of TRACK")
            difference = np.abs(velocity - values(row, "expect_qd", range(1, 8)))
            if not np.isfinite(difference).all():  # max() would ignore NaN
                sys.exit(f"law_over_lcm: the command is {velocity}")
            worst = max(worst, difference.max())
    return worst


def main():
    config = yaml.safe_load((ROOT / "firmware/config/lwa3.yaml").read_text())
    config |= {"limits": WIDE, "timeouts": {"coast_s": 0}}
    rows, url = cases(seed=77, count=400), sys.argv[1]
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        yaml.safe_dump(config, file)
        file.flush()
        command = [ROOT / "build/controller", "--config", file.name, "--law", "paper", "--lockstep", "--lcm-url", url]
        controller = subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=ROOT)
        try:
            worst = compare(lcm.LCM(url), rows)
        finally:
            controller.terminate()
            controller.wait()
    print(f"{len(rows)} random states, largest difference {worst:.2e} rad/s")
    sys.exit(not worst < TOLERANCE_RADPS)


if __name__ == "__main__":
    main()
