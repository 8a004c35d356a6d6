#!/usr/bin/env python3
"""Publish a target on TARGET, 50 times a second, moving with its velocity until Ctrl-C."""
import argparse
import sys
import time
from pathlib import Path

import lcm

sys.path.append(str(Path(__file__).resolve().parents[2] / "build/lcm/python"))
from sidestep import target_t


def send(position_m, velocity_mps, lcm_url):
    wire, target, start = lcm.LCM(lcm_url), target_t(), time.time()
    while True:
        target.utime = int(time.time() * 1e6)
        target.position = [p + v * (time.time() - start) for p, v in zip(position_m, velocity_mps)]
        target.velocity = velocity_mps
        wire.publish("TARGET", target.encode())
        time.sleep(0.02)


def main():
    parser = argparse.ArgumentParser(description=__doc__, usage="%(prog)s [-h] [--lcm-url URL] X Y Z [VX VY VZ]")
    parser.add_argument("numbers", type=float, nargs="+", metavar="N",
                        help="position in m, velocity in m/s (default 0)")
    parser.add_argument("--lcm-url", default="", metavar="URL", help="default: LCM's own")
    arguments = parser.parse_args()
    if len(arguments.numbers) not in (3, 6):
        parser.error("three numbers for the position, or six with the velocity")
    try:
        send(arguments.numbers[:3], arguments.numbers[3:] or [0.0] * 3, arguments.lcm_url)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
