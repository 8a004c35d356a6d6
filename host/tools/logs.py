"""LCM logs of runs, as build/sim --log, record.py and lcm-logger write them."""
from pathlib import Path

import lcm
import numpy as np

import runs
import wire

FIELDS = {"target_distance": "target_distance_m", "clearance": "clearance_m", "cycle_time": "cycle_time_s",
          "mode": "mode", "fault": "fault", "foresight": "foresight"}  # of the status -> column
PAUSE_US = 60_000_000  # a step of the time stamps that is longer, or backward, is none of a run


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


def run_of(file, arms, one, config):
    """The runs.Run of one arm with the columns that the messages contain, named as in the simulator's record.

    Besides those: `fault`, one of controller_status_t's. t_s is that of cycles().
    """
    rows = []
    for t_s, latest in cycles(file, arms, one):
        state, status = (latest[one.names[kind]] for kind in ("ARM_STATE", "CONTROLLER_STATUS"))
        if state.num_joints == one.joints:
            rows.append([t_s, *(getattr(status, field) for field in FIELDS), *state.joint_position,
                         *state.joint_velocity])
    if not rows:
        raise NoRun(f"{file}: no CONTROLLER_STATUS after an ARM_STATE of {one.joints} joints")
    joints = range(1, one.joints + 1)
    names = ["t_s", *FIELDS.values(), *(f"q{i}_rad" for i in joints), *(f"qd{i}_radps" for i in joints)]
    columns = dict(zip(names, np.array(rows, float).T))
    return runs.Run(one.name, "", {"config": Path(config).absolute()}, columns, runs.HELD)
