#!/usr/bin/env python3
"""Publish obstacles on OBSTACLES, 50 times a second, until Ctrl-C.

The obstacles are spheres of constant velocity, or a crowd: from a CSV file, random, or a walking person. Each message
contains the full set. The controller keeps an obstacle that is missing in it for another 0.3 s (timeouts.coast_s).
Without obstacles the empty set is sent.
"""
import argparse

import crowds
import wire
from errors import reason

MOST = 4096    # the controller rejects a message with more obstacles
MOST_M = 1000  # ... or with a larger coordinate, m, or velocity, m/s


def send(crowd, lcm_url):
    """crowd: function from seconds since the start to a list of obstacles."""
    message = wire.obstacles_t()

    def message_at(t_s):
        message.obstacles = crowd(t_s)
        message.num_obstacles = len(message.obstacles)
        return message
    wire.publish("OBSTACLES", message_at, lcm_url)


def numbers(text):
    words = text.split(",")
    if len(words) not in (4, 7):
        raise ValueError("a sphere is four numbers, or seven with the velocity: x,y,z,radius[,vx,vy,vz]")
    centre, velocity = ([wire.finite(word) for word in part] for part in (words[:3], words[4:]))
    if max(map(abs, centre + velocity)) > MOST_M:
        raise ValueError(f"{text.strip()}: a number is beyond {MOST_M} m or m/s, which the controller rejects")
    return [*centre, crowds.radius(words[3]), *(velocity or [0.0] * 3)]


def count(text):
    if (number := int(text)) < 0:
        raise argparse.ArgumentTypeError(f"{number} is below 0")
    return number


def crowd_of(arguments):
    spheres = [numbers(text) for text in arguments.spheres]
    if arguments.csv is None and arguments.random is None and not arguments.person:
        return crowds.straight(spheres)
    if spheres:  # they would be ignored, and the controller would assume that they do not exist
        raise ValueError("spheres cannot be combined with --csv, --random or --person")
    if arguments.csv is not None:
        return crowds.from_csv(arguments.csv)
    return crowds.walking() if arguments.person else crowds.wandering(arguments.random, arguments.seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage="%(prog)s [-h] [options] [x,y,z,radius[,vx,vy,vz] ...]",
                                     epilog="Centre and radius in m, velocity in m/s (default 0).")
    parser.add_argument("spheres", nargs="*", help=argparse.SUPPRESS)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--csv", metavar="FILE",
                      help="spheres from a file with the columns t_s, id, x_m, y_m, z_m, radius_m")
    kind.add_argument("--random", type=count, metavar="N",
                      help="N spheres that oscillate about random points near the arm")
    kind.add_argument("--person", action="store_true",
                      help="a person of capsules who walks back and forth past the arm")
    parser.add_argument("--seed", type=int, default=1, help="seed of --random (default %(default)s)")
    wire.add_lcm_url(parser)
    arguments = parser.parse_intermixed_args(wire.command_line())
    try:
        crowd = crowd_of(arguments)
        if (most := len(crowd(0.0))) > MOST:
            raise ValueError(f"{most} obstacles are more than the {MOST} that a message may contain")
    except UnicodeDecodeError:
        parser.error(f"{arguments.csv}: not a text file")
    except KeyError as error:
        parser.error(f"{arguments.csv}: no column {error}")
    except (OSError, TypeError, ValueError) as error:
        parser.error(reason(error))
    what = ("no obstacles (the empty set)" if most == 0 else "1 obstacle" if most == 1 else f"{most} obstacles")
    print(f"sending {what} on OBSTACLES, 50 times a second; Ctrl-C ends", flush=True)
    send(crowd, arguments.lcm_url)


if __name__ == "__main__":
    main()
