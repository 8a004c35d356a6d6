"""LCM logs of runs, as build/sim --log, record.py and lcm-logger write them."""
import time
from pathlib import Path

import lcm
import numpy as np

import arm
import runs
import watch
import wire

FIELDS = {"target_distance": "target_distance_m", "clearance": "clearance_m", "cycle_time": "cycle_time_s",
          "mode": "mode", "fault": "fault", "foresight": "foresight"}  # of the status -> column
PAUSE_US = 60_000_000  # a step of the time stamps that is longer, or backward, is none of a run
EPOCH_US = 1_000_000_000_000_000  # earlier time stamps are those of a clock that does not know the date


class NoRun(Exception):
    """The log contains no run of the arm; the text is one line with the reason."""


def cycles(file, arms, one):
    """Yields (t_s, wire.Messages) at every status of one of the arms after its first state; arm_view.ArmView each.

    t_s: since the first status of any arm, without the pauses between two runs. The messages are those of all arms, and
    the same object every time.
    """
    latest = wire.Messages({name: kind for each in arms for name, kind in each.channels().items()})
    t_us, before_us = None, 0
    for event in lcm.EventLog(str(file)):
        kind = latest.kinds.get(event.channel)
        if kind is None or not latest.store(event.channel, event.data, event.timestamp * 1e-6):
            continue
        if t_us is not None and 0 < event.timestamp - before_us < PAUSE_US:
            t_us += event.timestamp - before_us
        elif t_us is None and kind == "CONTROLLER_STATUS":
            t_us = 0
        before_us = event.timestamp
        if event.channel == one.names["CONTROLLER_STATUS"] and one.names["ARM_STATE"] in latest:
            yield t_us * 1e-6, latest


def date(file):
    """When the log was recorded, local time, as text: by its first time stamp, else by the file."""
    event = next(iter(lcm.EventLog(str(file))), None)
    dated = event is not None and EPOCH_US <= event.timestamp < 2 * EPOCH_US
    time_s = event.timestamp * 1e-6 if dated else Path(file).stat().st_mtime
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(time_s))


class Silence:
    """How long an arm's sets of obstacles have been silent, by the controller's own clock.

    A program that was stopped logs all that came meanwhile at one time; the statuses then still tell when they were.
    """

    def __init__(self, one, config):
        self.channels = [one.names["OBSTACLES"], *one.neighbours]
        self.most_s = arm.section(config, "timeouts").get("obstacles_s", watch.OLD_OBSTACLES_S)
        self.heard = {}  # channel -> (when its latest set came, utime of the status after it)

    def is_too_long(self, latest, status):
        """Whether the obstacles are too old at this status, which has to be asked about each."""
        for channel in self.channels:
            received_s = latest.received_s.get(channel)
            if received_s is not None and self.heard.get(channel, (None,))[0] != received_s:
                self.heard[channel] = received_s, status.utime
        oldest_us = min((utime for _, utime in self.heard.values()), default=status.utime)
        return "obstacles are too old" in status.message or (status.utime - oldest_us) * 1e-6 > self.most_s


def run_of(file, arms, one, config):
    """The runs.Run of one arm with the columns that the messages contain, named as in the simulator's record.

    Besides those: `fault`, one of controller_status_t's, and `possible_clearance_m`: what the controller states in
    place of a clearance while the obstacles are silent, and thus may have come nearer; clearance_m is then NaN. t_s is
    that of cycles().
    """
    rows, silence = [], Silence(one, config)
    for t_s, latest in cycles(file, arms, one):
        state, status = (latest[one.names[kind]] for kind in ("ARM_STATE", "CONTROLLER_STATUS"))
        silent = silence.is_too_long(latest, status)
        if state.num_joints == one.joints:
            rows.append([t_s, *(getattr(status, field) for field in FIELDS), silent, *state.joint_position,
                         *state.joint_velocity])
    if not rows and next(iter(lcm.EventLog(str(file))), None) is None:
        raise NoRun(f"{file}: not an LCM log, or an empty one")
    if not rows:
        raise NoRun(f"{file}: nothing of the controller of {runs.shown(Path(config).absolute())}, no "
                    f"{one.names['CONTROLLER_STATUS']} after an {one.names['ARM_STATE']} of {one.joints} joints; make "
                    "report CONFIG=FILE names another configuration")
    joints = range(1, one.joints + 1)
    names = ["t_s", *FIELDS.values(), "silent", *(f"q{i}_rad" for i in joints), *(f"qd{i}_radps" for i in joints)]
    columns = dict(zip(names, np.array(rows, float).T))
    silent, clearance_m = columns.pop("silent") > 0, columns["clearance_m"]
    columns["possible_clearance_m"] = np.where(silent, clearance_m, np.nan)
    columns["clearance_m"] = np.where(silent, np.nan, clearance_m)
    return runs.Run(one.name, "", {"config": Path(config).absolute()}, columns, runs.HELD)
