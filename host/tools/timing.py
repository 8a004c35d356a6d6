#!/usr/bin/env python3
"""Compare the wake-up latency of the control loop with that of cyclictest, on the idle and on the busy machine.

Controller and cyclictest run at the same time with the same period and FIFO priority; the second run adds an endless
loop for every CPU. Goal: the loop's p99 is at most 1.5 times that of cyclictest in the same run, and no cycle is
skipped.
"""
import argparse
import subprocess
import time

import environment
import yaml

import latency
import runs

GOAL = 1.5
FOLDER = runs.RECORDS / "timing"


def scenario_of(duration_s):
    """Simulation B of the paper, prolonged to the duration."""
    scenario = runs.load_scenario(runs.ROOT / "host/scenarios/paper-b.yaml")
    scenario.update(duration_s=duration_s, robot={**scenario["robot"], "urdf": str(runs.ROOT / "urdf/lwa3.urdf")})
    file = FOLDER / "scenario.yaml"
    file.write_text(yaml.safe_dump(scenario))
    return file


def measure(name, duration_s, rate_hz, stressed):
    """One run. Returns (Loop, Latency of cyclictest, or None if FIFO is not permitted to it)."""
    logs = {part: FOLDER / f"{name}-{part}.log" for part in ("controller", "sim", "cyclictest")}
    files = {part: open(log, "w") for part, log in logs.items()}
    url, scenario, processes = runs.private_url(), scenario_of(duration_s + 5), []
    try:
        processes += latency.busy_loops() if stressed else []
        controller = runs.start([runs.BUILD / "controller", "--config", runs.config_of(runs.load(scenario)),
                                 "--rate", rate_hz, "--lcm-url", url], files["controller"])
        processes.append(controller)
        processes.append(runs.start([runs.BUILD / "sim", "--scenario", scenario, "--quiet", "--lcm-url", url],
                                    files["sim"]))
        cyclictest = latency.start_cyclictest(round(1e6 / rate_hz), duration_s, 1, files["cyclictest"])
        processes += [cyclictest] if cyclictest else []
        time.sleep(duration_s)
        if controller.poll() is not None:
            raise runs.RunFailed(f"build/controller {runs.ending(controller.returncode)}")
        if cyclictest:
            try:
                cyclictest.wait(10)
            except subprocess.TimeoutExpired:
                raise runs.RunFailed(f"cyclictest is not finished after {duration_s + 10:g} s") from None
    finally:
        for process in processes:
            runs.stop(process)
        for file in files.values():
            file.close()
    return latency.loop_of(logs["controller"]), latency.cyclictest_of(logs["cyclictest"]) if cyclictest else None


def line(name, process, latencies, remark=""):
    return (f"{name:16} {process:10} {latencies.p50_us:9.0f} {latencies.p99_us:9.0f} {latencies.p999_us:9.0f} "
            f"{latencies.worst_us:9.0f}  {remark}")


def show(name, loop, cyclictest):
    print(line(name, "loop", loop.wake_up, f"{loop.skipped} of {loop.cycles + loop.skipped} cycles skipped"))
    if not cyclictest:
        return
    ratio = loop.wake_up.p99_us / cyclictest.p99_us
    met = ratio <= GOAL and loop.skipped == 0
    print(line("", "cyclictest", cyclictest, f"p99 ratio: {ratio:.2f}; goal {'met' if met else 'missed'}"),
          flush=True)


def rate(text):
    """A rate on the command line that the controller accepts, Hz."""
    if not 10 <= (value := float(text)) <= 2000:
        raise argparse.ArgumentTypeError(f"{text} is not from 10 to 2000")
    return value


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--duration", type=runs.seconds, default=30, metavar="S",
                        help="duration of each run (default %(default)s)")
    parser.add_argument("--rate", type=rate, default=100, metavar="HZ", help="control rate (default %(default)s)")
    arguments = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    print(f"{'wake-up, us':16} {'':10} {'p50':>9} {'p99':>9} {'p99.9':>9} {'worst':>9}", flush=True)
    for name, stressed in (("idle", False), ("all CPUs busy", True)):
        loop, cyclictest = measure("busy" if stressed else "idle", arguments.duration, arguments.rate, stressed)
        show(name, loop, cyclictest)
    print("FIFO and locked memory: " + ("permitted" if loop.fifo else "NOT permitted to the loop") +
          ("" if cyclictest else "; FIFO NOT permitted to cyclictest, hence no comparison"))
    return 0


if __name__ == "__main__":
    runs.main_of(main)
