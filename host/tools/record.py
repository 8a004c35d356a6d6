#!/usr/bin/env python3
"""Write what is said on Sidestep's channels into an lcm log until Ctrl-C; lcm-logplayer reads it."""
import argparse
import select
import signal
import sys
import time

import lcm

import bus


def record(file, channels, lcm_url):
    """Returns the number of messages written."""
    wire, written = bus.network(lcm_url), 0

    def keep(channel, data):
        nonlocal written
        log.write_event(int(time.time() * 1e6), channel, data)
        written += 1

    for channel in channels:
        if (heard := wire.subscribe(channel, keep)) is None:
            sys.exit(f"cannot listen to '{channel}': not a regular expression")
        heard.set_queue_capacity(1000)
    log = lcm.EventLog(file, "w", overwrite=True)  # not before all is well: it replaces an old one
    try:
        while True:
            select.select([wire], [], [])  # waits where Ctrl-C is heard
            wire.handle_timeout(10)  # ms; handle() would wait on for the rest of a broken message
    except KeyboardInterrupt:
        log.close()
    return written


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", metavar="LOG", help="the file to write; an old one is replaced")
    parser.add_argument("--channels", nargs="+", default=list(bus.TYPES), metavar="NAME", help="default: %(default)s")
    bus.add_lcm_url(parser)
    arguments = parser.parse_args()
    for stop in (signal.SIGINT, signal.SIGTERM):  # a background job is born deaf to the first
        signal.signal(stop, signal.default_int_handler)
    try:
        open(arguments.log, "ab").close()
    except OSError as error:
        parser.error(str(error))
    try:
        count = record(arguments.log, arguments.channels, arguments.lcm_url)
    except KeyboardInterrupt:
        sys.exit("stopped before it began to listen")
    print(f"{count} messages in {arguments.log}")


if __name__ == "__main__":
    main()
