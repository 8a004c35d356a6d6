#!/usr/bin/env python3
"""Run a scenario repeatedly and show it live in the browser, until Ctrl-C.

Starts Meldis, which serves the page, view.py, which publishes the drawing, and the controller and the simulator.
"""
import argparse
import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/tools"))
import runs

PAUSE_S = 1.0  # between two runs


@contextmanager
def viewers(scenario, port, lcm_url=""):
    """Meldis and view.py while the block runs. Meldis reads its LCM network from the environment."""
    network = ["--lcm-url", lcm_url] if lcm_url else []
    view = [ROOT / "host/view/view.py", "--config", *map(runs.config_of, runs.arms_of(scenario))]
    environment = os.environ | ({"LCM_DEFAULT_URL": lcm_url} if lcm_url else {})
    meldis, started = ["-m", "pydrake.visualization.meldis", "--port", port, "--idle-timeout", 0], []
    runs.RECORDS.mkdir(parents=True, exist_ok=True)
    try:
        with open(runs.RECORDS / "view.log", "w") as log:
            for command in (meldis, view + network):
                started.append(subprocess.Popen([sys.executable, *map(str, command)], env=environment, process_group=0,
                                                stdout=log, stderr=log))
        yield started
    finally:
        for process in reversed(started):
            runs.stop(process)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.yaml")
    parser.add_argument("--port", type=int, default=7000, help="port of the browser page (default %(default)s)")
    arguments = parser.parse_args()
    scenario_file = arguments.scenario.absolute()
    scenario = runs.load_scenario(scenario_file)
    print(f"{scenario['title']}: open http://localhost:{arguments.port} (Ctrl-C ends)", flush=True)
    with viewers(scenario, arguments.port) as started:
        while all(process.poll() is None for process in started):
            runs.execute(scenario_file, "sidestep", runs.RECORDS / "view.csv", lockstep=False)
            time.sleep(PAUSE_S)
    raise runs.RunFailed("a viewer has ended")


if __name__ == "__main__":
    runs.main_of(main)
