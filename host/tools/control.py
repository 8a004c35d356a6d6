#!/usr/bin/env python3
"""Pause, resume or stop the controller, or change its speed, by a message on CONTROL.

pause   the arm slows to rest; it keeps avoiding obstacles
resume  the arm follows its target, at the speed of --speed
stop    the arm brakes to rest and the controller ends; it has to be started again
"""
import argparse

from wire import add_lcm_url, argument, command_line, control_t, finite, publish, publish_once

COMMANDS = {"pause": control_t.PAUSE, "resume": control_t.RESUME, "stop": control_t.STOP}


def share(text):
    value = finite(text)
    if not 0 <= value <= 1:
        raise ValueError(f"{text.strip()} is not from 0 to 1")
    return value


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=COMMANDS)
    parser.add_argument("--speed", type=argument(share), default=1.0, metavar="SHARE",
                        help="0 to 1: of the speed with which the arm follows its target (default 1)")
    parser.add_argument("--keep", action="store_true",
                        help="repeat it until Ctrl-C, for a controller that needs an operator (timeouts.control_s)")
    add_lcm_url(parser)
    return parser.parse_args(command_line())


def main():
    arguments = parsed()
    message = control_t()
    message.command, message.speed_scale = COMMANDS[arguments.command], arguments.speed
    speed = f" at {arguments.speed:.0%} of full speed" if arguments.command == "resume" else ""
    print(f"sending {arguments.command}{speed} on CONTROL" +
          (", 50 times a second; Ctrl-C ends" if arguments.keep else ""), flush=True)
    if arguments.keep:
        publish("CONTROL", lambda _t: message, arguments.lcm_url)
        return
    publish_once("CONTROL", message, arguments.lcm_url)


if __name__ == "__main__":
    main()
