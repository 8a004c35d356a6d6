#!/usr/bin/env python3
"""Publish a target on TARGET, 50 times a second, until Ctrl-C: a point, on a line, on a path, or under the arrow keys.

The newest target counts: beside another who sends some, as the simulator does, the arm follows both in turns.
"""
import argparse
import curses
import math
import sys
import time

from bus import add_lcm_url, finite, network, target_t, words

STEP_M = 0.02  # of a key
KEYS = {curses.KEY_LEFT: (0, -1), curses.KEY_RIGHT: (0, 1), curses.KEY_DOWN: (1, -1), curses.KEY_UP: (1, 1),
        ord("-"): (2, -1), ord("+"): (2, 1)}


def send(motion, lcm_url):
    """motion: seconds since the start -> (position, velocity)."""
    wire, target, start = network(lcm_url), target_t(), time.time()
    while True:
        target.utime = int(time.time() * 1e6)
        target.position, target.velocity = motion(time.time() - start)
        wire.publish("TARGET", target.encode())
        time.sleep(0.02)


def line(start_m, velocity_mps):
    return lambda t: ([p + v * t for p, v in zip(start_m, velocity_mps)], velocity_mps)


def circle(centre_m, radius_m, period_s):
    """Horizontal, from its +x end."""
    x, y, z = centre_m
    w = 2 * math.pi / period_s
    return lambda t: ([x + radius_m * math.cos(w * t), y + radius_m * math.sin(w * t), z],
                      [-radius_m * w * math.sin(w * t), radius_m * w * math.cos(w * t), 0.0])


def figure_eight(centre_m, radius_m, period_s):
    """Horizontal, twice as long in x as in y, from its middle."""
    x, y, z = centre_m
    w = 2 * math.pi / period_s
    return lambda t: ([x + radius_m * math.sin(w * t), y + radius_m / 2 * math.sin(2 * w * t), z],
                      [radius_m * w * math.cos(w * t), radius_m * w * math.cos(2 * w * t), 0.0])


def keys(screen, place_m):
    """Left and right along x, up and down along y, + and - along z."""
    screen.nodelay(True)

    def motion(_t):
        while (key := screen.getch()) != -1:
            axis, sign = KEYS.get(key, (0, 0))
            place_m[axis] += sign * STEP_M
        screen.addstr(0, 0, "target {:6.2f} {:6.2f} {:6.2f} m   arrow keys: x, y   + -: z   Ctrl-C ends".format(*place_m))
        screen.refresh()
        return place_m, [0.0] * 3
    return motion


def positive(text):
    value = float(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not above 0")
    return value


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, usage="%(prog)s [-h] [options] X Y Z [VX VY VZ]")
    parser.add_argument("numbers", type=finite, nargs="+", metavar="N",
                        help="position in m, or centre of the path; velocity in m/s (default 0)")
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--circle", type=positive, metavar="RADIUS", help="a horizontal circle, radius in m")
    way.add_argument("--figure-eight", type=positive, metavar="RADIUS", help="a horizontal 8, half its length in m")
    way.add_argument("--keys", action="store_true", help="move it with the arrow keys, + and -")
    parser.add_argument("--period", type=positive, default=8.0, metavar="S", help="of a path (default %(default)g)")
    add_lcm_url(parser)
    arguments = parser.parse_args(words())
    if len(arguments.numbers) not in (3, 6):
        parser.error("three numbers for the position, or six with the velocity")
    if arguments.keys and not (sys.stdin.isatty() and sys.stdout.isatty()):
        parser.error("--keys needs a terminal")
    return arguments


def main():
    arguments = parsed()
    place_m, velocity_mps, url = arguments.numbers[:3], arguments.numbers[3:] or [0.0] * 3, arguments.lcm_url
    try:
        if arguments.keys:
            curses.wrapper(lambda screen: send(keys(screen, place_m), url))
        elif arguments.circle:
            send(circle(place_m, arguments.circle, arguments.period), url)
        elif arguments.figure_eight:
            send(figure_eight(place_m, arguments.figure_eight, arguments.period), url)
        else:
            send(line(place_m, velocity_mps), url)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
