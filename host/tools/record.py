#!/usr/bin/env python3
"""Record the messages of Sidestep's channels in an LCM log, for lcm-logplayer, until Ctrl-C."""
import argparse
import signal
import sys
import time

import environment
import lcm

import wire
from errors import reason
from stop_signals import on_stop


def stop(*_):
    """Ends the recording. Later signals, of which timeout(1) sends two, do not interrupt closing the log."""
    on_stop(signal.SIG_IGN)
    raise KeyboardInterrupt


def record(file, channels, lcm_url):
    """Returns the number of messages written."""
    network, written = wire.connect(lcm_url), 0

    def write(channel, data):
        nonlocal written
        log.write_event(int(time.time() * 1e6), channel, data)
        written += 1

    for channel in channels:
        if (subscription := network.subscribe(channel, write)) is None:
            sys.exit(f"cannot subscribe to '{channel}': not a regular expression")
        subscription.set_queue_capacity(1000)
    log = lcm.EventLog(file, "w", overwrite=True)  # opened last, because it replaces an existing log
    print(f"recording in {file}, Ctrl-C ends", flush=True)
    try:
        while True:
            wire.handle_messages(network)
    except KeyboardInterrupt:
        log.close()
    return written


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", metavar="LOG", help="file to write; an existing one is replaced")
    parser.add_argument("--channels", nargs="+", default=list(wire.TYPES), metavar="NAME",
                        help=f"default: {', '.join(wire.TYPES)}")
    wire.add_lcm_url(parser)
    arguments = parser.parse_args()
    on_stop(stop)
    try:
        open(arguments.log, "ab").close()
    except OSError as error:
        parser.error(reason(error))
    try:
        count = record(arguments.log, arguments.channels, arguments.lcm_url)
    except KeyboardInterrupt:
        sys.exit("stopped before the recording began")
    print(f"{count} messages in {arguments.log}")


if __name__ == "__main__":
    main()
