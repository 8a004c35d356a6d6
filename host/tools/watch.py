#!/usr/bin/env python3
"""Print CONTROLLER_STATUS ten times a second: mode, target distance, clearance, cycle time, message."""
import argparse
import select
import sys
import time
from pathlib import Path

import lcm

sys.path.append(str(Path(__file__).resolve().parents[2] / "build/lcm/python"))
from sidestep import controller_status_t

MODES = {getattr(controller_status_t, name): name for name in ("WAIT", "HOLD", "TRACK", "BRAKE", "FAULT")}
printed_s = 0.0


def show(_channel, data):
    global printed_s
    if time.monotonic() - printed_s > 0.095:
        status, printed_s = controller_status_t.decode(data), time.monotonic()
        print(f"{MODES.get(status.mode, status.mode):5}  target {status.target_distance:6.3f} m  clearance "
              f"{status.clearance:6.3f} m  cycle {status.cycle_time * 1e6:5.0f} us  {status.message}", flush=True)


def watch(lcm_url):
    wire = lcm.LCM(lcm_url)
    wire.subscribe("CONTROLLER_STATUS", show)
    while True:
        select.select([wire], [], [])  # waits where Ctrl-C is heard
        wire.handle()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lcm-url", default="", metavar="URL", help="default: LCM's own")
    try:
        watch(parser.parse_args().lcm_url)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
