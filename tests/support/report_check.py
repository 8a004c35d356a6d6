#!/usr/bin/env python3
"""Checks of host/tools/report.py and what it uses; a failed check ends with an assertion."""
import argparse
import base64
import html
import math
import random
import re
import tempfile
from pathlib import Path

import lcm
import numpy as np
from tools_check import LWA3, logged_run  # and the folders of the scripts

import arm
import crowds
import logs
import report
import runs
import timeline
import verdict
import wire
from arm_view import ArmView


def recorded(page):
    """The recording in a page: its duration, s, and [(time, s, message)]."""
    import msgspec
    import zstandard
    text = re.search('__VISER_EMBED_DATA__="(.*?)"', html.unescape(page))[1]
    data = zstandard.ZstdDecompressor().decompress(base64.b64decode(text)[8:])
    scene = msgspec.msgpack.decode(data[8:8 + int.from_bytes(data[:8], "little")])
    return scene["durationSeconds"], scene["messages"]


def loads_nothing(page):
    """Whether the page begins with a policy that allows no address, and names none outside the recording."""
    policy = re.search('Content-Security-Policy" content="(.*?)"', page, re.DOTALL)
    words = set(re.split(r"[;\s]+", policy[1])) - {""}
    kinds = {word for word in words if re.fullmatch("[a-z]+-src", word)}
    shell = re.sub('srcdoc=".*?"', "", page, flags=re.DOTALL)
    return (policy.start() < page.index("<style") < page.index("srcdoc") and "default-src 'none'" in policy[1]
            and words - kinds <= {"'none'", "'unsafe-inline'", "'unsafe-eval'", "blob:", "data:"}
            and shell.count("<script") == shell.count("<script>") == 1
            and not re.search(r"https?://|src=(?!\"data:)|href=", shell))


def log_becomes_page():
    """A log becomes one page that contains the run and its verdict and loads nothing from the network."""
    with tempfile.TemporaryDirectory() as name:
        log, duration_s = logged_run(Path(name))
        page = report.page(log, {arm.CONFIG: LWA3})
        lwa3 = ArmView(arm.CONFIG, LWA3)
        run = logs.run_of(log, [lwa3], lwa3, arm.CONFIG)
        measured = dict(verdict.rows(run, log))
        log.with_suffix(".csv").write_text("t_s,clearance_m\n")
        unmeasured = dict(verdict.rows(run, log))
        log.with_suffix(".csv").unlink()
        runs.verdict_file(log).unlink()
        reported = dict(verdict.rows(run, log))
    assert loads_nothing(page) and not loads_nothing(page.replace("data:;", "data: https:;"))
    shown_s, messages = recorded(page)
    assert abs(shown_s - run.columns["t_s"][-1]) < 0.05 and duration_s <= shown_s <= duration_s + 1.5, shown_s
    moves = [t for t, message in messages if message["type"] == "SetPositionMessage" and message["name"] == "/arm/7"]
    from_s, to_s, left, right = map(float, re.search('data-spans="(.*?)"', page)[1].split())
    assert abs(from_s - run.columns["t_s"][0]) < 1e-3 and abs(to_s - run.columns["t_s"][-1]) < 1e-3, (from_s, to_s)
    assert 0 < left < 0.2 and 0.8 < right < 1, (left, right)
    assert len(moves) > 20 * duration_s and moves == sorted(moves), len(moves)
    assert any("TRACK" in str(message) for _, message in messages)
    assert len(run.joints()[0]) == 7 and run.columns["target_distance_m"][-1] < 0.01
    assert (measured["expectations of the scenario"], measured["contact"]) == ("met", "no"), measured
    assert (reported["expectations of the scenario"], reported["contact"]) == ("not known", "no"), reported
    assert measured["measured by"] != reported["measured by"] == unmeasured["measured by"]


def hostile_log():
    """A log with hostile bytes, no numbers and markup becomes a page; what is no number is not drawn."""
    state, status, obstacles, target = (wire.joint_state_t(), wire.controller_status_t(), wire.obstacles_t(),
                                        wire.target_t())
    state.num_joints, state.joint_position, state.joint_velocity = 7, [math.nan] * 7, [math.inf] * 7
    status.message, status.mode, status.fault, status.foresight = "</script><b>\0", 99, -5, 7
    status.clearance, status.guide_horizon, status.guide_tool = math.nan, 1.0, [[math.inf] * 3] * 8
    obstacles.obstacles = [crowds.obstacle(i, shape, [math.nan, -1.0, 1e300], [math.nan, 0, 0], [0, 0, 0])
                           for i, shape in enumerate((0, 1, 2, 3, 77))]
    obstacles.num_obstacles, target.position = len(obstacles.obstacles), [math.nan, math.inf, 0.0]
    messages = {"ARM_STATE": state, "TARGET": target, "OBSTACLES": obstacles, "CONTROLLER_STATUS": status}
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "<b>&.lcmlog"
        log, generator = lcm.EventLog(str(file), "w"), random.Random(1)
        for time_us in (5, 2**62, 0, 30_000_000):
            for channel, message in messages.items():
                for data in (generator.randbytes(40), message.encode()[:-1], message.encode()):
                    log.write_event(time_us, channel, data)
        log.close()
        page = report.page(file, {arm.CONFIG: LWA3})
    assert loads_nothing(page) and "<b>" not in page and "&lt;b&gt;" in page
    moved = {message.get("name") for _, message in recorded(page)[1] if message["type"] == "SetPositionMessage"}
    assert "/arm/7" not in moved and not any("/obstacles/" in str(name) for name in moved), moved


def faults_on_page():
    """Modes and faults are on the curves by name, and each fault once in the verdict."""
    t_s = np.arange(0.0, 2.0, 0.01)
    columns = {"t_s": t_s, "mode": np.where(t_s < 1, 2, 4), "fault": np.where(t_s < 1, 0, 1), "foresight": t_s < 0.5,
               "clearance_m": t_s + np.inf, "possible_clearance_m": t_s * np.nan, "target_distance_m": t_s * np.nan,
               "cycle_time_s": t_s * 1e-5}
    columns |= {f"{name}{i}_{unit}": t_s for i in (1, 2) for name, unit in (("q", "rad"), ("qd", "radps"))}
    run = runs.Run("", "", {"config": arm.CONFIG}, columns, runs.HELD)
    limits = np.array([[-1.0, 1.0], [-np.inf, np.inf]])
    drawn = timeline.draw(run, (limits, limits)).svg.decode()
    for word in ("TRACK", "FAULT", "guided", "arm state lost", "CPU time of a whole cycle (period: 10000 us)"):
        assert f"<!-- {word} -->" in drawn, word
    assert "<!-- BRAKE -->" not in drawn
    assert "obstacles silent" not in drawn and "nothing logged" not in drawn
    assert verdict.faults(run) == "arm state lost at 1.00 s, for 0.99 s"
    assert timeline.stretches(t_s, columns["mode"])[1][:2] == (4, 1.0)


def gaps():
    """No line and no stretch of a mode crosses a time from which nothing is logged."""
    t_s = np.r_[np.arange(0.0, 1.0, 0.01), np.arange(1.5, 2.0, 0.01)]
    modes = np.where(t_s < 1.6, 2, 3)
    assert np.allclose(timeline.stretches(t_s, modes), [(2, 0, 0.99), (2, 1.5, 0.1), (3, 1.6, 0.39)], atol=1e-6)
    run = timeline.broken(runs.Run("", "", {}, {"t_s": t_s, "clearance_m": t_s}, runs.HELD))
    assert np.array_equal(np.flatnonzero(np.isnan(run.columns["clearance_m"])), [100]), run.columns
    assert np.array_equal(np.delete(run.columns["clearance_m"], 100), t_s) and len(run.columns["t_s"]) == len(t_s) + 1


def silent_obstacles():
    """A clearance that the controller lowers while the obstacles are silent is neither a clearance nor a contact."""
    state, status, obstacles = wire.joint_state_t(), wire.controller_status_t(), wire.obstacles_t()
    state.num_joints, state.joint_position, state.joint_velocity = 7, [0.0] * 7, [0.0] * 7
    lwa3 = ArmView(arm.CONFIG, LWA3)
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "run.lcmlog"
        log = lcm.EventLog(str(file), "w")
        log.write_event(0, "ARM_STATE", state.encode())
        log.write_event(0, "OBSTACLES", obstacles.encode())
        for number in range(60):  # a set of obstacles at 0 and 0.5 s; the statuses from 0.2 s on are logged late
            status.utime, status.clearance = number * 10_000, 0.2 - 0.02 * number * (number < 50)
            if number == 50:
                log.write_event(500_000, "OBSTACLES", obstacles.encode())
            log.write_event(max(status.utime, 500_000 * (number >= 20)), "CONTROLLER_STATUS", status.encode())
        log.close()
        run = logs.run_of(file, [lwa3], lwa3, arm.CONFIG)
        rows = dict(verdict.rows(run, file))
    known, possible = (np.flatnonzero(np.isfinite(run.columns[name])) for name in ("clearance_m",
                                                                                   "possible_clearance_m"))
    assert np.array_equal(known, [*range(11), *range(50, 60)]) and np.array_equal(possible, range(11, 50)), known
    assert rows["contact"] == "no" and rows["least clearance"] == "0.0000 m at 0.10 s", rows


def limits():
    """The limits of joints are those of the configuration; one number for all leaves prismatic joints alone."""
    joint = '<joint name="{0}" type="{1}"><parent link="{0}"/><child link="{2}"/><limit {3}/></joint>'
    with tempfile.TemporaryDirectory() as name:
        urdf = Path(name) / "arm.urdf"
        urdf.write_text('<robot name="none">' + joint.format("a", "prismatic", "b", 'lower="0" upper="1" velocity="3"')
                        + joint.format("b", "continuous", "c", 'velocity="4"') + joint.format("c", "fixed", "d", "")
                        + joint.format("d", "revolute", "e", 'lower="-2" upper="2" velocity="5"') + "</robot>")
        inf = math.inf
        for settings, positions, fastest in (
                ({}, [[0, 1], [-inf, inf], [-2, 2]], [3, 4, 5]),
                ({"velocity_radps": 2, "upper_rad": 1.5}, [[0, 1], [-inf, 1.5], [-2, 1.5]], [3, 2, 2]),
                ({"velocity_radps": [1, 2, 3]}, [[0, 1], [-inf, inf], [-2, 2]], [1, 2, 3])):
            found = arm.limits(urdf, "a", "e", settings)
            assert np.array_equal(found[0], positions) and np.array_equal(found[1][:, 1], fastest), found


CHECKS = {check.__name__: check for check in (log_becomes_page, hostile_log, faults_on_page, gaps, silent_obstacles,
                                              limits)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("check", choices=CHECKS)
    CHECKS[parser.parse_args().check]()
