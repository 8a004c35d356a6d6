"""LCM for the scripts: Sidestep's channels, their message types, and the latest message of each channel."""
import argparse
import math
import os
import re
import select
import struct
import sys
import time
from pathlib import Path

import environment
import lcm

# Appended, so that pydrake's own modules come first. Installed scripts find the types in share/sidestep/python.
sys.path.append(str(Path(__file__).resolve().parents[2] / "build/lcm/python"))
from sidestep import (attachments_t, control_t, controller_status_t, joint_command_t, joint_state_t, joint_target_t,
                      named_joints_t, obstacle_t, obstacles_t, target_t)

TYPES = {"TARGET": target_t, "OBSTACLES": obstacles_t, "ARM_STATE": joint_state_t, "ARM_COMMAND": joint_command_t,
         "CONTROLLER_STATUS": controller_status_t, "OTHER_JOINTS": named_joints_t, "CONTROL": control_t,
         "ATTACHMENTS": attachments_t, "JOINT_TARGET": joint_target_t}
MOST_AT_ONCE = 1000  # messages; a flood of them must not stop the caller
MODES = {getattr(controller_status_t, name): name for name in ("WAIT", "HOLD", "TRACK", "BRAKE", "FAULT")}


def decoded(kind, data):
    """The message of type TYPES[kind], or None if the bytes are not a message of that type."""
    try:
        return TYPES[kind].decode(data)
    except (ValueError, struct.error, UnicodeDecodeError, MemoryError):
        return None


def connect(lcm_url):
    """An LCM instance. Without a usable network the script ends with one line and exit code 1."""
    try:
        return lcm.LCM(lcm_url)
    except RuntimeError:
        of_environment = os.environ.get("LCM_DEFAULT_URL") if not lcm_url else None
        name = f"{of_environment} of LCM_DEFAULT_URL" if of_environment else lcm_url or "LCM's default"
        sys.exit(f"cannot use the LCM network {name}: not of the form udpm://ADDRESS:PORT?ttl=N, or no multicast route")


def handle_messages(network, limit_s=None):
    """Waits for a message, up to limit_s or without limit, and handles it. Returns whether one came."""
    came = bool(select.select([network], [], [], limit_s)[0])  # Ctrl-C interrupts select(), but not handle()
    if came:
        network.handle_timeout(10)  # ms; handle() would block on an incomplete message
    return came


def publish_once(channel, message, lcm_url):
    """Publishes one message, five times within 0.1 s: a datagram may be lost."""
    network = connect(lcm_url)
    for _ in range(5):
        message.utime = int(time.time() * 1e6)
        network.publish(channel, message.encode())
        time.sleep(0.02)


def publish(channel, message_at, lcm_url):
    """Publishes message_at(seconds since the start) on a channel, 50 times a second, until Ctrl-C."""
    network, start = connect(lcm_url), time.time()
    try:
        while True:
            message = message_at(time.time() - start)
            message.utime = int(time.time() * 1e6)
            network.publish(channel, message.encode())
            time.sleep(0.02)
    except KeyboardInterrupt:
        pass


def finite(text):
    """The finite number that the text gives; ValueError otherwise."""
    try:
        if math.isfinite(value := float(text)):
            return value
    except ValueError:
        pass
    raise ValueError(f"'{text.strip()}' is not a finite number")


def obstacle_id(text):
    """The id of an obstacle, a number of 32 bits; ValueError otherwise."""
    if not -2**31 <= (number := int(text)) < 2**31:
        raise ValueError(f"id {number} has more than 32 bits")
    return number


def argument(read):
    """The type of an argument for argparse, which then shows the text of the ValueError of read(text)."""
    def reader(text):
        try:
            return read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    return reader


def command_line():
    """The arguments for argparse. A leading blank stops argparse from reading -1e-3 and -1,0,2 as options."""
    return [f" {word}" if re.match(r"-[\d.]", word) else word for word in sys.argv[1:]]


class Messages(dict):
    """Channel -> latest valid message, and in `received_s` when it came. A channel without a message yet is missing.

    channels: a list of keys of TYPES, or a dict from channel name to key of TYPES.
    """

    def __init__(self, channels):
        super().__init__()
        self.received_s = {}
        self.kinds = channels if isinstance(channels, dict) else {channel: channel for channel in channels}

    def store(self, channel, data, now_s):
        """Returns whether the bytes are a message of the channel's type."""
        message = decoded(self.kinds[channel], data)
        if message is not None:
            self[channel], self.received_s[channel] = message, now_s
        return message is not None

    def now_s(self):
        """The time of the newest message, as far as the messages of a log tell."""
        return max(self.received_s.values(), default=0.0)

    def ages_s(self):
        """Channel -> s since its latest message."""
        now_s = self.now_s()
        return {channel: now_s - received_s for channel, received_s in self.received_s.items()}


class LatestMessages(Messages):
    """Messages as they come over the network; the times are of the monotonic clock."""

    def __init__(self, channels, lcm_url):
        super().__init__(channels)
        self.network = connect(lcm_url)
        for channel in self.kinds:
            self.network.subscribe(channel, lambda name, data: self.store(name, data, time.monotonic()))

    def now_s(self):
        return time.monotonic()

    def receive(self, duration_s):
        """Handles the messages that come within duration_s, and first of all those that have come before."""
        end = time.monotonic() + duration_s
        for _ in range(MOST_AT_ONCE):
            left_s = end - time.monotonic()
            if not handle_messages(self.network, max(left_s, 0.0)) and left_s <= 0:
                return


def add_lcm_url(parser):
    parser.add_argument("--lcm-url", default="", metavar="URL",
                        help="LCM network (default: LCM_DEFAULT_URL, else LCM's default)")
