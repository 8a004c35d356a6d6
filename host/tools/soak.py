#!/usr/bin/env python3
"""Endurance test: one controller in real time, while its simulator is killed and restarted at random times.

Every run of the simulator has other random obstacles on circles and another moving target, with sensor noise and lost
messages. Checked at the end: constant memory, no contact, no skipped cycle that the machine did not cause, and a newest
blackbox log that replays bit for bit. Exit code 0 if all checks pass, else 1.
"""
import argparse
import math
import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import environment
import numpy as np
import yaml

import latency
import runs

FOLDER = runs.RECORDS / "soak"
WARM_UP_S = 20  # memory growth during this time is ignored
MOST_GROWTH_KB = 512
LATE_US = 5000  # half a period; a later wake-up shows that the machine gave the process no CPU time


def circling(rng, number, until_s):
    """A sphere on a circle around the arm's base, clear of the arm's start configuration."""
    radius_m, height_m, start = rng.uniform(0.5, 0.75), rng.uniform(0.4, 1.1), rng.uniform(-1.5, 1.5)
    rate_radps = rng.choice((-1, 1)) * rng.uniform(0.08, 0.2) / radius_m

    def at(t_s):
        angle = start + rate_radps * t_s
        centre = [radius_m * math.cos(angle), radius_m * math.sin(angle), height_m]
        return centre, [-rate_radps * centre[1], rate_radps * centre[0], 0.0]

    position, velocity = at(0.0)
    return {"id": number, "shape": "sphere", "radius_m": 0.05, "position_m": position, "velocity_mps": velocity,
            "waypoints": [[float(t_s), *at(t_s)[0], *at(t_s)[1]] for t_s in range(1, until_s)]}


def wandering(rng, until_s):
    """A target within reach that arrives at another random point every four seconds."""
    def point():
        angle, radius_m = rng.uniform(-2.5, 2.5), rng.uniform(0.3, 0.5)
        return [radius_m * math.cos(angle), radius_m * math.sin(angle), rng.uniform(0.6, 1.0)]

    return {"position_m": point(), "velocity_mps": [0.0, 0.0, 0.0],
            "waypoints": [[float(t_s), *point(), 0.0, 0.0, 0.0] for t_s in range(4, until_s, 4)]}


def scenario_of(rng, duration_s):
    base = runs.load(runs.ROOT / "host/scenarios/paper-b.yaml")
    scenario = {**{key: base[key] for key in ("config", "rate_hz", "start_rad")}, "title": "Soak",
                "robot": {**base["robot"], "urdf": str(runs.ROOT / "urdf/lwa3.urdf")}, "duration_s": duration_s,
                "plant": {"kind": "servo", "lag_s": 0.01, "latency_s": 0.005, "velocity_limit_radps": 3.0,
                          "acceleration_limit_radps2": 100.0},
                "sensing": {"joint_noise_rad": 1e-4, "obstacle_noise_m": 0.003, "lost_share": 0.05,
                            "seed": rng.randrange(2**31)},
                "target": wandering(rng, duration_s), "obstacles": [circling(rng, i, duration_s) for i in range(3)]}
    file = FOLDER / "scenario.yaml"
    file.write_text(yaml.safe_dump(scenario))
    return file


def resident_kb(process):
    status = Path(f"/proc/{process.pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0])


def run_simulator(rng, controller, url, output, until_s, memory):
    """One run of the simulator until it is killed. Returns the least clearance, m, or None if tracking never began."""
    span_s = min(rng.uniform(5, 40), max(3.0, until_s - time.monotonic()))
    record = FOLDER / "sim.csv"
    sim = runs.start([runs.BUILD / "sim", "--scenario", scenario_of(rng, int(span_s) + 20), "--csv", record, "--quiet",
                      "--lcm-url", url], output)
    try:
        end_s = time.monotonic() + span_s
        while time.monotonic() < end_s and sim.poll() is None:
            time.sleep(1)
            if controller.poll() is not None:
                raise runs.RunFailed(f"build/controller {runs.ending(controller.returncode)}")
            memory.append((time.monotonic(), resident_kb(controller)))
    finally:
        sim.send_signal(signal.SIGKILL)
        sim.wait()
    columns = runs.read_csv(record)
    if not columns:
        return None
    links_m = columns["self_clearance_m"]
    return float(min(columns["clearance_m"].min(), np.where(links_m <= 0, links_m, np.inf).min()))


def controller_config():
    config = runs.load(runs.ROOT / "firmware/config/lwa3.yaml")
    config["blackbox"] = {"seconds": 10, "folder": str(FOLDER / "logs")}
    config["robot"]["urdf"] = str(runs.ROOT / "urdf/lwa3.urdf")
    file = FOLDER / "controller.yaml"
    file.write_text(yaml.safe_dump(config))
    return file


def soak(duration_s, rng):
    """(least clearance of each run of the simulator, memory samples of the controller)."""
    url, clearances, memory, processes = runs.private_url(), [], [], []
    with open(FOLDER / "controller.log", "w") as controller_log, open(FOLDER / "sim.log", "w") as sim_log, \
            open(FOLDER / "cyclictest.log", "w") as cyclictest_log:
        try:
            controller = runs.start([runs.BUILD / "controller", "--config", controller_config(), "--lcm-url", url],
                                    controller_log)
            processes.append(controller)
            cyclictest = latency.start_cyclictest(1000, duration_s + 120, os.cpu_count(), cyclictest_log)
            processes += [cyclictest] if cyclictest else []
            until_s = time.monotonic() + duration_s
            while time.monotonic() < until_s:
                clearances.append(run_simulator(rng, controller, url, sim_log, until_s, memory))
                time.sleep(rng.uniform(0.0, 2.0))
        finally:
            codes = [runs.stop(process) for process in processes]
    if codes[0]:
        raise runs.RunFailed(f"build/controller {runs.ending(codes[0])}")
    if not memory:
        raise runs.RunFailed(f"build/sim never ran for a second: {runs.last_line(FOLDER / 'sim.log')}")
    return clearances, memory


def growth_kb(memory):
    """(growth, last value) of the resident memory. Growth: mean of the last quarter less mean of the first quarter."""
    values = [kb for at_s, kb in memory if at_s - memory[0][0] > WARM_UP_S] or [memory[-1][1]]
    quarter = max(1, len(values) // 4)
    return float(np.mean(values[-quarter:]) - np.mean(values[:quarter])), values[-1]


def late_wake_ups():
    """(number of cyclictest's wake-ups later than LATE_US, worst latency in us)."""
    bins, worst_us = latency.histogram_of(FOLDER / "cyclictest.log")
    return sum(count for us, count in bins.items() if us >= LATE_US), worst_us


def checks(clearances, memory):
    """Yields (passed, line of the summary)."""
    loop = latency.loop_of(FOLDER / "controller.log")
    tracked = [clearance for clearance in clearances if clearance is not None]
    grown_kb, last_kb = growth_kb(memory)
    logs = sorted((FOLDER / "logs").glob("*.lcmlog"))
    replay = subprocess.run([runs.BUILD / "replay", logs[-1]] if logs else ["false"], capture_output=True, text=True,
                            cwd=runs.ROOT)
    try:
        late, worst_us = late_wake_ups()
        cyclictest = f"cyclictest: {late} wake-ups more than {LATE_US / 1000:g} ms late, worst {worst_us / 1000:.1f} ms"
    except runs.RunFailed:
        late, cyclictest = 0, "no cyclictest: FIFO is not permitted"
    yield bool(tracked), f"{len(clearances)} runs of the simulator, all killed; tracking began in {len(tracked)}"
    yield min(tracked, default=-1.0) > 0, f"least clearance {min(tracked, default=math.nan):.4f} m"
    yield grown_kb <= MOST_GROWTH_KB, f"memory {last_kb / 1024:.1f} MB, grown by {grown_kb:.0f} kB"
    yield loop.skipped == 0 or late > 0, f"{loop.cycles} cycles, {loop.skipped} skipped; {cyclictest}"
    yield loop.cpu_worst_us < LATE_US or late > 0, (f"wake-up p99 {loop.wake_up.p99_us:.0f} us, "
                                                    f"worst CPU time {loop.cpu_worst_us:.0f} us")
    yield replay.returncode == 0, f"newest blackbox log: {(replay.stdout + replay.stderr).strip() or 'none'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--duration", type=runs.seconds, default=3600, metavar="S",
                        help="duration (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the random choices (default %(default)s)")
    arguments = parser.parse_args()
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    print(f"soak: {arguments.duration:g} s; logs in {runs.shown(FOLDER)}", flush=True)
    lines = list(checks(*soak(arguments.duration, random.Random(arguments.seed))))
    for passed, text in lines:
        print(f"  {'ok' if passed else 'BROKEN':6}  {text}")
    return 0 if all(passed for passed, _ in lines) else 1


if __name__ == "__main__":
    runs.main_of(main)
