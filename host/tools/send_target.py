#!/usr/bin/env python3
"""Publish a target, 50 times a second, until Ctrl-C: on TARGET a point that rests, moves, or follows the arrow keys; on
JOINT_TARGET a posture.

The controller tracks the newest target. While another process sends targets too, the one whose clock is ahead counts;
beside the simulator that is this script.
"""
import argparse
import curses
import math
import sys

from wire import add_lcm_url, argument, command_line, finite, joint_target_t, publish, target_t

STEP_M = 0.02  # for each key press
MOST = 1000    # of a position, m, and of a velocity, m/s: the controller rejects a message with more
KEYS = {curses.KEY_LEFT: (0, -1), curses.KEY_RIGHT: (0, 1), curses.KEY_DOWN: (1, -1), curses.KEY_UP: (1, 1),
        ord("-"): (2, -1), ord("+"): (2, 1)}


def send(motion, lcm_url):
    """motion: function from seconds since the start to (position, velocity)."""
    target = target_t()

    def message_at(t_s):
        target.position, target.velocity = motion(t_s)
        return target
    publish("TARGET", message_at, lcm_url)


def send_posture(joints_rad, lcm_url):
    posture = joint_target_t()
    posture.num_joints, posture.joint_position = len(joints_rad), joints_rad
    publish("JOINT_TARGET", lambda _t_s: posture, lcm_url)


def line(start_m, velocity_mps):
    return lambda t: ([p + v * t for p, v in zip(start_m, velocity_mps)], velocity_mps)


def circle(centre_m, radius_m, period_s):
    """Horizontal; starts at its point of largest x."""
    x, y, z = centre_m
    w = 2 * math.pi / period_s
    return lambda t: ([x + radius_m * math.cos(w * t), y + radius_m * math.sin(w * t), z],
                      [-radius_m * w * math.sin(w * t), radius_m * w * math.cos(w * t), 0.0])


def figure_eight(centre_m, radius_m, period_s):
    """Horizontal, twice as long in x as in y; starts at its centre."""
    x, y, z = centre_m
    w = 2 * math.pi / period_s
    return lambda t: ([x + radius_m * math.sin(w * t), y + radius_m / 2 * math.sin(2 * w * t), z],
                      [radius_m * w * math.cos(w * t), radius_m * w * math.cos(2 * w * t), 0.0])


def keys(screen, position_m):
    """Left and right move the target along x, up and down along y, + and - along z."""
    screen.nodelay(True)

    def motion(_t):
        while (key := screen.getch()) != -1:
            axis, sign = KEYS.get(key, (0, 0))
            position_m[axis] += sign * STEP_M
        screen.addstr(0, 0, "target {:6.2f} {:6.2f} {:6.2f} m   arrow keys: x, y   + -: z   Ctrl-C ends".format(
            *position_m))
        screen.refresh()
        return position_m, [0.0] * 3
    return motion


def positive(text):
    if (value := finite(text)) <= 0:
        raise ValueError(f"{text.strip()} is not above 0")
    return value


def joints(text):
    return [finite(number) for number in text.split(",")]


def coordinate(text):
    if abs(value := finite(text)) > MOST:
        raise ValueError(f"{text.strip()} is beyond {MOST} m or m/s, which the controller rejects")
    return value


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, usage="%(prog)s [-h] [options] X Y Z [VX VY VZ]\n"
                                     "       %(prog)s [--lcm-url URL] --joints Q1,Q2,...")
    parser.add_argument("numbers", type=argument(coordinate), nargs="*", metavar="NUMBER",
                        help="position of the target or centre of its path, m; then velocity, m/s (default 0)")
    path = parser.add_mutually_exclusive_group()
    path.add_argument("--circle", type=argument(positive), metavar="RADIUS",
                      help="move on a horizontal circle, radius in m")
    path.add_argument("--figure-eight", type=argument(positive), metavar="RADIUS",
                      help="move on a horizontal figure eight, half its length in m")
    path.add_argument("--joints", type=argument(joints), metavar="Q1,Q2,...",
                      help="the positions of all joints, rad, or m for a prismatic joint, in place of a point")
    path.add_argument("--keys", action="store_true", help="move with the arrow keys (x, y) and with + and - (z)")
    parser.add_argument("--period", type=argument(positive), default=8.0, metavar="S",
                        help="period of the circle or figure eight (default %(default)g)")
    add_lcm_url(parser)
    arguments = parser.parse_args(command_line())
    if arguments.joints and arguments.numbers:
        parser.error("expected no point beside --joints")
    if len(arguments.numbers) == 6 and (arguments.circle or arguments.figure_eight or arguments.keys):
        parser.error("expected no velocity beside --circle, --figure-eight or --keys")
    if not arguments.joints and len(arguments.numbers) not in (3, 6):
        parser.error("expected three numbers (position) or six (position and velocity)")
    if arguments.keys and not (sys.stdin.isatty() and sys.stdout.isatty()):
        parser.error("--keys needs a terminal")
    return arguments


def words_of(arguments):
    """What is sent, for people."""
    if arguments.joints:
        return f"the posture {' '.join(f'{value:g}' for value in arguments.joints)} on JOINT_TARGET"
    numbers = [f"{value:g}" for value in arguments.numbers]
    point, velocity = " ".join(numbers[:3]), " ".join(numbers[3:])
    if arguments.circle or arguments.figure_eight:
        shape = f"a circle of {arguments.circle:g} m radius" if arguments.circle else (
            f"a figure eight of {2 * arguments.figure_eight:g} m length")
        return f"a target on {shape} about {point} m, once in {arguments.period:g} s on TARGET"
    moves = f"that starts at {point} m and moves at {velocity} m/s" if velocity else f"at {point} m"
    return f"a target {moves} on TARGET"


def main():
    arguments = parsed()
    position_m, velocity_mps, url = arguments.numbers[:3], arguments.numbers[3:] or [0.0] * 3, arguments.lcm_url
    if not arguments.keys:
        print(f"sending {words_of(arguments)}, 50 times a second; Ctrl-C ends", flush=True)
    if arguments.joints:
        send_posture(arguments.joints, url)
    elif arguments.keys:
        curses.wrapper(lambda screen: send(keys(screen, position_m), url))
    elif arguments.circle:
        send(circle(position_m, arguments.circle, arguments.period), url)
    elif arguments.figure_eight:
        send(figure_eight(position_m, arguments.figure_eight, arguments.period), url)
    else:
        send(line(position_m, velocity_mps), url)


if __name__ == "__main__":
    main()
