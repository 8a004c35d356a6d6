#!/usr/bin/env python3
"""Run a scenario repeatedly and show it live in the browser, until Ctrl-C.

Starts view.py, which serves the page, the controller and the simulator.
"""
import argparse
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/tools"))
import network
import runs
from errors import reason
from view import add_port

PAUSE_S = 1.0  # between two runs
NICE = 5       # of the view: at 10, a browser that draws in software leaves it too little of two CPUs for its rate
COMMANDS = """In a second terminal:
  cd {root}
  build/venv/bin/python host/tools/send_target.py -0.5 -0.3 0.5              # Ctrl-C ends it, and any other sender
  build/venv/bin/python host/tools/send_target.py -0.5 0 0.5 --circle 0.2
  build/venv/bin/python host/tools/send_target.py -0.5 -0.3 0.5 --keys       # arrow keys, + and -
In a third:
  cd {root}
  build/venv/bin/python host/tools/send_obstacles.py -0.5,-1,0.5,0.1,0,0.1,0  # one sphere, 0.1 m/s along y
  build/venv/bin/python host/tools/send_obstacles.py --person
  build/venv/bin/python host/tools/control.py pause                          # and: resume, resume --speed 0.3
  build/venv/bin/python host/tools/watch.py
"""


def refuse_taken(port):
    """RunFailed if another process listens on the port."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a port whose last user has ended is free
        try:
            probe.bind(("", port))
        except OSError as error:
            raise runs.RunFailed(f"port {port}: {reason(error)}; choose another with PORT=") from None


@contextmanager
def viewer(scenario, port, lcm_url=""):
    """view.py while the block runs, at a lower priority than everything else."""
    arms = runs.arms_of(scenario)
    command = ["nice", "-n", NICE, sys.executable, ROOT / "host/view/view.py", "--port", port,
               "--config", *map(runs.config_of, arms), *["--steer"] * lacks_target(scenario)]
    runs.RECORDS.mkdir(parents=True, exist_ok=True)
    with open(runs.RECORDS / "view.log", "w") as log:
        process = subprocess.Popen([*map(str, command), *(["--lcm-url", lcm_url] if lcm_url else [])],
                                   process_group=0, stdout=log, stderr=log)
    try:
        yield process
    finally:
        runs.stop(process)


def lacks_target(scenario):
    return any("target" not in one for one in runs.arms_of(scenario))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.yaml")
    add_port(parser)
    arguments = parser.parse_args()
    scenario_file = arguments.scenario.absolute()
    scenario = runs.load_scenario(scenario_file)
    refuse_taken(arguments.port)
    network.check_free()
    address = f"http://localhost:{arguments.port}"
    print(f"{scenario['title']}: open {address} (Ctrl-C ends)\n"
          f"A browser without a GPU draws it at a lower resolution; in full: {address}/?fixedDpr=1", flush=True)
    if lacks_target(scenario):
        print(COMMANDS.format(root=ROOT), flush=True)
    with viewer(scenario, arguments.port) as view:
        while view.poll() is None:
            try:
                runs.execute(scenario_file, "sidestep", runs.RECORDS / "view.csv", lockstep=False, viewer=view)
            except runs.ControllerStopped as stopped:
                print(f"\n{stopped}")
                return 0
            time.sleep(PAUSE_S)
    raise runs.RunFailed(f"the view has ended: {runs.last_line(runs.RECORDS / 'view.log')}")


if __name__ == "__main__":
    runs.main_of(main)
