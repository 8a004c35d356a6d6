"""Sidestep's channels for the scripts: their types, and what was last heard on each."""
import math
import re
import select
import struct
import sys
import time
from pathlib import Path

import lcm

# Behind pydrake, which has types of its own. Where the scripts are installed the types stand beside them.
sys.path.append(str(Path(__file__).resolve().parents[2] / "build/lcm/python"))
from sidestep import controller_status_t, joint_command_t, joint_state_t, obstacle_t, obstacles_t, target_t

TYPES = {"TARGET": target_t, "OBSTACLES": obstacles_t, "ARM_STATE": joint_state_t, "ARM_COMMAND": joint_command_t,
         "CONTROLLER_STATUS": controller_status_t}
MODES = {getattr(controller_status_t, name): name for name in ("WAIT", "HOLD", "TRACK", "BRAKE", "FAULT")}


def decoded(channel, data):
    """The message, or None when the bytes are not one of this channel's type."""
    try:
        return TYPES[channel].decode(data)
    except (ValueError, struct.error, UnicodeDecodeError, MemoryError):
        return None


def network(lcm_url):
    """LCM, or one line and exit code 1 when it cannot be had."""
    try:
        return lcm.LCM(lcm_url)
    except RuntimeError:
        sys.exit(f"cannot use the network '{lcm_url or 'of LCM'}' (is there a multicast route?)")


def finite(text):
    """A number for an option or a sphere."""
    if not math.isfinite(value := float(text)):
        raise ValueError(f"{text} is not a finite number")
    return value


def words():
    """The command line for argparse: a blank goes before -1e-3 and -1,0,2, which it would take for options."""
    return [f" {word}" if re.match(r"-[\d.]", word) else word for word in sys.argv[1:]]


class Newest(dict):
    """channel -> the newest message; a channel is missing until something was heard.

    channels: of TYPES, or a dict from any channel's name to the one of TYPES that it is like.
    """

    def __init__(self, channels, lcm_url):
        super().__init__()
        self.wire = network(lcm_url)
        self.like = channels if isinstance(channels, dict) else {channel: channel for channel in channels}
        for channel in self.like:
            self.wire.subscribe(channel, self._take)

    def _take(self, channel, data):
        if (message := decoded(self.like[channel], data)) is not None:
            self[channel] = message

    def listen(self, duration_s):
        end = time.monotonic() + duration_s
        while (left_s := end - time.monotonic()) > 0:
            if select.select([self.wire], [], [], left_s)[0]:  # waits where Ctrl-C is heard
                self.wire.handle_timeout(10)  # ms; handle() would wait on for the rest of a broken message


def add_lcm_url(parser):
    parser.add_argument("--lcm-url", default="", metavar="URL", help="default: LCM_DEFAULT_URL or LCM's own")
