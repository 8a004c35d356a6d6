#!/usr/bin/env python3
"""Publish spheres on OBSTACLES, 50 times a second, moving with their velocity until Ctrl-C.

The message is always the full set: what is not in it is gone. No sphere at all sends the empty set.
"""
import argparse
import sys
import time
from pathlib import Path

import lcm

sys.path.append(str(Path(__file__).resolve().parents[2] / "build/lcm/python"))
from sidestep import obstacle_t, obstacles_t


def sphere(number, x, y, z, radius, vx=0.0, vy=0.0, vz=0.0):
    obstacle = obstacle_t()
    obstacle.id, obstacle.shape, obstacle.size = number, obstacle_t.SPHERE, [radius, 0, 0]
    obstacle.position, obstacle.velocity = [x, y, z], [vx, vy, vz]
    return obstacle


def send(spheres, lcm_url):
    wire, message, start = lcm.LCM(lcm_url), obstacles_t(), time.time()
    while True:
        now = time.time()
        message.utime = int(now * 1e6)
        message.obstacles = [sphere(i, *(p + v * (now - start) for p, v in zip(s, s[4:])), *s[3:])
                             for i, s in enumerate(spheres)]
        message.num_obstacles = len(message.obstacles)
        wire.publish("OBSTACLES", message.encode())
        time.sleep(0.02)


def numbers(text):
    values = [float(number) for number in text.split(",")]
    if len(values) not in (4, 7):
        raise ValueError
    return values + [0.0] * (7 - len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage="%(prog)s [-h] [--lcm-url URL] [x,y,z,radius[,vx,vy,vz] ...]",
                                     epilog="Centre and radius in m, velocity in m/s (default 0).")
    parser.add_argument("--lcm-url", default="", metavar="URL", help="default: LCM's own")
    arguments, spheres = parser.parse_known_args()  # so that a sphere may begin with a minus
    try:
        send([numbers(text) for text in spheres], arguments.lcm_url)
    except ValueError:
        parser.error("a sphere is four numbers, or seven with the velocity: x,y,z,radius[,vx,vy,vz]")
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
