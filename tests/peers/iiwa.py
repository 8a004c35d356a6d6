#!/usr/bin/env python3
"""A closed loop with Drake's simulated iiwa in real time: a moving target among moving obstacles.

Drake simulates the arm, its drives and its LCM interface, and measures the clearance. The last line is
`N passed, N failed`.
"""
import argparse
import subprocess
import sys
from collections import Counter

import lcm
import numpy as np
from drake import lcmt_iiwa_command, lcmt_iiwa_status

from iiwa_world import HOME_RAD, OBSTACLES, TARGET, Iiwa, ROOT

sys.path.insert(0, str(ROOT / "host/tools"))
import crowds
import runs
import wire

CONFIG = "firmware/config/iiwa14-drake.yaml"
PERIOD_S = 0.01
START_LIMIT_S = 20.0
GUARD_S = 0.25


class Recorder:
    """Stores the messages of controller and simulator."""

    def __init__(self, lcm_url, iiwa):
        self.iiwa, self.network = iiwa, lcm.LCM(lcm_url)
        self.commands, self.modes, self.message = [], [], "no status received"
        self.first_status_s = self.first_command_s = None
        for channel, handler in (("IIWA_COMMAND", self._command), ("IIWA_STATUS", self._status),
                              ("CONTROLLER_STATUS", self._report)):
            self.network.subscribe(channel, handler).set_queue_capacity(1000)

    def receive(self):
        while self.network.handle_timeout(0):
            pass

    def _command(self, _, data):
        message = lcmt_iiwa_command.decode(data)
        if self.first_command_s is None:
            self.first_command_s = self.iiwa.now_s()
        self.commands.append((message.utime * 1e-6, *message.joint_position))

    def _status(self, _, data):
        if self.first_status_s is None:
            self.first_status_s = lcmt_iiwa_status.decode(data).utime * 1e-6

    def _report(self, _, data):
        report = wire.decoded("CONTROLLER_STATUS", data)
        self.modes.append(wire.MODES[report.mode])
        self.message = report.message


def publish(network, utime, time_s):
    target = wire.target_t()
    target.utime, target.quaternion = utime, [1, 0, 0, 0]
    target.position, target.velocity = TARGET.at(time_s)
    network.publish("TARGET", target.encode())
    obstacles = wire.obstacles_t()
    obstacles.utime, obstacles.num_obstacles = utime, len(OBSTACLES)
    for number, (radius_m, centre) in enumerate(OBSTACLES):
        position, velocity = centre.at(time_s)
        obstacles.obstacles.append(crowds.sphere(number, *position, radius_m, *velocity))
    network.publish("OBSTACLES", obstacles.encode())


def play(iiwa, recorder, duration_s):
    """Target distances and clearances, m, one per period since tracking began. Until then target and obstacles rest."""
    errors_m, clearances_m, start_s = [], [], None
    while start_s is None or iiwa.now_s() < start_s + duration_s:
        now_s = iiwa.now_s()
        if start_s is None and "TRACK" in recorder.modes:
            start_s = now_s
            recorder.modes.clear()
        if start_s is None and now_s > START_LIMIT_S:
            raise runs.RunFailed(f"never tracked: {recorder.message}")
        time_s = 0.0 if start_s is None else now_s - start_s
        if start_s is not None:
            errors_m.append(np.linalg.norm(iiwa.flange_m() - TARGET.at(time_s)[0]))
            clearances_m.append(min(iiwa.clearance_m(centre.at(time_s)[0], radius) for radius, centre in OBSTACLES))
        publish(recorder.network, round(now_s * 1e6), time_s)
        iiwa.advance(PERIOD_S)
        recorder.receive()
    return np.array(errors_m), np.array(clearances_m)


def checks(iiwa, recorder, errors_m, clearances_m, acceleration_radps2):
    """Yields (passed, measured values as text)."""
    commands = np.array(recorder.commands)
    positions = np.vstack([HOME_RAD, HOME_RAD, commands[:, 1:]])
    speeds = np.diff(positions, axis=0) / PERIOD_S
    speed = (np.abs(speeds) / iiwa.speed_limits_radps()).max()
    change = np.abs(np.diff(speeds, axis=0)).max() / (acceleration_radps2 * PERIOD_S)
    silence_s = recorder.first_command_s - recorder.first_status_s
    tracked = Counter(recorder.modes)["TRACK"] / len(recorder.modes)
    near = np.percentile(errors_m, [50, 90]) * 1e3
    yield clearances_m.min() > 0, f"least clearance {clearances_m.min() * 1e3:.0f} mm by Drake's distances"
    yield near[0] < 30 and near[1] < 150, (f"distance to the target: median {near[0]:.1f} mm, "
                                           f"90th percentile {near[1]:.0f} mm, maximum {errors_m.max() * 1e3:.0f} mm")
    yield tracked > 0.95, f"mode TRACK in {100 * tracked:.1f} % of {len(recorder.modes)} cycles"
    yield speed < 1 + 1e-9 and change < 1 + 1e-6, (f"{len(commands)} continuous commands, at most "
                                                   f"{100 * speed:.0f} % of the velocity limit and "
                                                   f"{100 * change:.0f} % of the acceleration limit")
    yield silence_s >= GUARD_S, f"first command {1e3 * silence_s:.0f} ms after the first status"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--duration", type=float, default=60, metavar="S",
                        help="duration of tracking (default %(default)s)")
    duration_s = parser.parse_args().duration
    url = runs.private_url()
    iiwa = Iiwa(url)
    recorder = Recorder(url, iiwa)
    controller = runs.start([runs.BUILD / "controller", "--config", CONFIG, "--lcm-url", url], subprocess.DEVNULL)
    try:
        errors_m, clearances_m = play(iiwa, recorder, duration_s)
    finally:
        runs.stop(controller)
    acceleration = runs.load(ROOT / CONFIG)["limits"]["acceleration_radps2"]
    results = list(checks(iiwa, recorder, errors_m, clearances_m, acceleration))
    for passed, text in results:
        print(f"{'ok' if passed else 'FAIL':4}  Drake's iiwa, {len(errors_m) * PERIOD_S:.0f} s: {text}")
    failed = sum(not passed for passed, _ in results)
    print(f"{len(results) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    runs.main_of(main)
