#!/usr/bin/env python3
"""Tell the controller what the tool holds and what it may touch, by a message on ATTACHMENTS.

The shapes are part of the arm until the next message: they are kept clear of obstacles and of the other links. The tool
and what it holds may touch the allowed obstacles. Without options the tool lets go of everything. To grasp: allow the
object, approach it, hold it with its id still allowed, carry it, put it down, and stop allowing it when the tool has
left.
"""
import argparse

from wire import add_lcm_url, argument, attachments_t, command_line, finite, obstacle_id, obstacle_t, publish_once

SIZES = {"sphere": (obstacle_t.SPHERE, "RADIUS"), "capsule": (obstacle_t.CAPSULE, "RADIUS,LENGTH"),
         "box": (obstacle_t.BOX, "X,Y,Z"), "cylinder": (obstacle_t.CYLINDER, "RADIUS,HEIGHT")}
MOST_SHAPES, MOST_ALLOWED = 16, 64  # the controller rejects a message with more


def held(text):
    """ID:SHAPE:SIZES@X,Y,Z as an obstacle_t."""
    try:
        number, kind, rest = text.split(":")
        sizes, place = ([finite(word) for word in part.split(",")] for part in rest.split("@"))
        shape, names = SIZES[kind]
        if len(sizes) != len(names.split(",")) or len(place) != 3 or min(sizes) < 0:
            raise ValueError
        made = obstacle_t()
        made.id, made.shape = obstacle_id(number), shape
        made.size, made.position, made.quaternion = [*sizes, 0.0, 0.0][:3], place, [1.0, 0.0, 0.0, 0.0]
        return made
    except (KeyError, ValueError) as error:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not ID:SHAPE:SIZES@X,Y,Z, with sphere:RADIUS, capsule:RADIUS,LENGTH, box:X,Y,Z or "
            "cylinder:RADIUS,HEIGHT") from error


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="example: send_attachments.py --hold 7:cylinder:0.033,0.14@0,0,0 --allow 7")
    parser.add_argument("--hold", type=held, action="append", default=[], metavar="ID:SHAPE:SIZES@X,Y,Z",
                        help="a shape with its centre in the tool's frame, m; capsules and cylinders lie along z "
                             "(repeatable)")
    parser.add_argument("--allow", type=argument(obstacle_id), nargs="+", default=[], metavar="ID",
                        help="obstacles that the tool and what it holds may touch")
    add_lcm_url(parser)
    arguments = parser.parse_args(command_line())
    if len(arguments.hold) > MOST_SHAPES or len(arguments.allow) > MOST_ALLOWED:
        parser.error(f"at most {MOST_SHAPES} shapes and {MOST_ALLOWED} allowed obstacles")
    return arguments


def main():
    arguments = parsed()
    message = attachments_t()
    message.shapes, message.num_shapes = arguments.hold, len(arguments.hold)
    message.allowed, message.num_allowed = arguments.allow, len(arguments.allow)
    allowed = ", ".join(map(str, arguments.allow)) or "no obstacle"
    shapes = {0: "nothing", 1: "1 shape"}.get(len(arguments.hold), f"{len(arguments.hold)} shapes")
    print(f"sending on ATTACHMENTS: the tool holds {shapes} and may touch {allowed}", flush=True)
    publish_once("ATTACHMENTS", message, arguments.lcm_url)


if __name__ == "__main__":
    main()
