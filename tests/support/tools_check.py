#!/usr/bin/env python3
"""Checks of the scripts in host/tools and host/view; a failed check ends with an assertion."""
import argparse
import contextlib
import io
import math
import os
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from unittest import mock

import lcm
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "host/tools"), str(ROOT / "host/view"), str(ROOT / "build/lcm/python")]
import arm
import control
import crowds
import geometry
import logs
import network
import panel
import record
import report
import runs
import send_attachments
import send_obstacles
import send_target
import show
import stage
import timing
import view
import visuals
import watch
import wire
from arm_view import ArmView, static_obstacle

STEP_S = 1e-4
LWA3 = (ROOT / "urdf/lwa3.urdf", "base_link", "tool")


def slope(position_at, t):
    return (np.array(position_at(t + STEP_S)) - np.array(position_at(t - STEP_S))) / (2 * STEP_S)


def velocities():
    """The sent velocities of targets and obstacles are the derivatives of the sent positions."""
    motions = [send_target.line([0, 1, 2], [0.1, -0.2, 0.3]), send_target.circle([0, 0, 1], 0.3, 5),
             send_target.figure_eight([0, 0, 1], 0.3, 5)]
    for motion in motions:
        for t in (0.0, 1.3, 4.9):
            assert np.allclose(slope(lambda s: motion(s)[0], t), motion(t)[1], atol=1e-6), (motion, t)
    assert {part.kind for part in crowds.walking()(0.0)} == {wire.obstacle_t.PERSON}
    crowd_kinds = [crowds.straight([[0, 0, 0, 0.1, 1, 2, 3]]), crowds.wandering(4, 7), crowds.walking()]
    for crowd in crowd_kinds:
        for i, obstacle in enumerate(crowd(1.7)):
            assert np.allclose(slope(lambda s: crowd(s)[i].position, 1.7), obstacle.velocity, atol=1e-6), (crowd, i)
            axis_rate = slope(lambda s: arm.rotation_of_quaternion(crowd(s)[i].quaternion)[:, 2], 1.7)
            axis = arm.rotation_of_quaternion(obstacle.quaternion)[:, 2]
            assert np.allclose(axis_rate, np.cross(obstacle.angular_velocity, axis), atol=1e-6)


def tracks():
    """Spheres of a CSV file move on straight lines from row to row and then rest."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        file.write("t_s,id,x_m,y_m,z_m,radius_m\n0,4,0.5,0,0,0.1\n2,4,0.9,0,0,0.1\n")
        file.flush()
        crowd = crowds.from_csv(file.name)
    for t, x, vx in ((0, 0.5, 0.2), (1, 0.7, 0.2), (5, 0.9, 0)):
        (sphere,) = crowd(t)
        assert np.allclose([*sphere.position, *sphere.velocity], [x, 0, 0, vx, 0, 0]) and sphere.id == 4


def clearances():
    """The clearance that colours a drawing is correct for the upright LWA3 and a sphere, a capsule, a box and cylinders."""
    link_poses = arm.link_poses(arm.chain(*LWA3), [0.0] * 7)
    shapes = arm.shapes(*LWA3)
    for shape, size, expected in ((0, [0.1], 0.35), (1, [0.1, 1.0], 0.35), (2, [0.4, 0.4, 2.0], 0.25),
                                  (3, [0.1, 1.0], 0.35), (3, [0.4, 0.02], 0.05)):
        obstacle = crowds.obstacle(1, shape, size, [0.5, 0, 0.5], [0, 0, 0])
        nearest = min(geometry.clearance_m(one, link_poses[one.frame], [obstacle]) for one in shapes)
        assert math.isclose(nearest, expected, abs_tol=5e-3), (shape, nearest)


def nearest_lines():
    """The line from a link to its nearest obstacle has the clearance as length, less the radii at its ends."""
    link_poses = arm.link_poses(arm.chain(*LWA3), [0.0] * 7)
    for kind, size, radius_m in ((0, [0.1], 0.1), (1, [0.1, 1.0], 0.1), (2, [0.4, 0.4, 2.0], 0.0)):
        obstacle = crowds.obstacle(1, kind, size, [0.5, 0, 0.5], [0, 0, 0])
        for shape in arm.shapes(*LWA3):
            length_m, (start, end) = geometry.nearest_line(shape, link_poses[shape.frame], obstacle)
            assert math.isclose(length_m, np.linalg.norm(end - start))
            least_m = geometry.clearance_m(shape, link_poses[shape.frame], [obstacle])
            assert math.isclose(length_m - radius_m - shape.size[0], least_m, abs_tol=1e-9), (kind, shape)


def unknown_clearance():
    """Without a current status, or with silent obstacles, the clearance is unknown: no link is coloured as safe."""
    one, status = ArmView(arm.CONFIG, LWA3), wire.controller_status_t()
    status.clearance, status.nearest_obstacle, status.nearest_link = 0.3, 4, one.shapes[-1].link
    ball = crowds.obstacle(4, 0, [0.1], [0.5, 0, 0.5], [0, 0, 0])
    poses = arm.link_poses(one.chain, [0.0] * 7)
    latest = wire.Messages(one.channels())
    assert not one.knows_clearance(latest) and one.nearest(latest, poses, [ball]) is None
    latest.store("CONTROLLER_STATUS", status.encode(), 10.0)
    assert one.knows_clearance(latest) and np.allclose(one.nearest(latest, poses, [ball])[1], ball.position)
    for number in (-1, -2, 5):
        status.nearest_obstacle = number
        latest.store("CONTROLLER_STATUS", status.encode(), 10.0)
        assert one.nearest(latest, poses, [ball]) is None, number
    latest.store("OBSTACLES", wire.obstacles_t().encode(), 9.0)
    assert not one.knows_clearance(latest)
    latest.store("OBSTACLES", wire.obstacles_t().encode(), 10.0)
    assert one.knows_clearance(latest)
    latest.store("ARM_STATE", wire.joint_state_t().encode(), 12.0)
    assert not one.knows_clearance(latest)


def allowed_touch():
    """What the tool may touch colours the other links only, and what it holds none."""
    one = ArmView(arm.CONFIG, LWA3)
    latest, message = wire.Messages(one.channels()), wire.attachments_t()
    ball, can = (crowds.obstacle(number, 0, [0.1], [0.5, 0, 0.5], [0, 0, 0]) for number in (4, 7))
    frames = sorted({shape.frame for shape in one.shapes})
    assert one.avoided(latest, frames[-1], [ball, can]) == [ball, can]
    message.allowed, message.num_allowed = [7], 1
    for held, of_arm in (([], [ball, can]), ([can], [ball])):
        message.shapes, message.num_shapes = held, len(held)
        latest.store("ATTACHMENTS", message.encode(), 10.0)
        assert one.avoided(latest, frames[-1], [ball, can]) == [ball]
        assert all(one.avoided(latest, frame, [ball, can]) == of_arm for frame in frames[:-1])


def panel_texts():
    """The panel says how long it waits for which channel, and names no nearest link to a clearance nobody knows."""
    assert "waiting for LEFT_STATUS for 12 s" in panel.words_of(None, {}, "LEFT_STATUS", 12.3)
    status = wire.controller_status_t()
    status.mode, status.message, status.clearance, status.nearest_link = status.TRACK, "tracking", 0.3, "hand"
    status.nearest_obstacle = 4
    for age_s, named in ((0.0, True), (0.2, False)):
        words = panel.words_of(status, {"CONTROLLER_STATUS": 0.0, "OBSTACLES": age_s}, "STATUS", 12.3)
        assert ("hand and obstacle 4" in words) == named and "tracking" not in words and "TRACK" in words, words


def quaternions():
    """A rotation converted to a quaternion and back is unchanged."""
    generator = np.random.default_rng(1)
    for _ in range(100):
        rotation = arm.rotation_of_quaternion(generator.normal(size=4))
        assert np.allclose(arm.rotation_of_quaternion(arm.quaternion_of(rotation)), rotation)


def places():
    """Obstacles that an arm with a rotated base receives in its own frame are drawn in the common world frame."""
    config = ROOT / "firmware/config/left.yaml"
    left = ArmView(config, LWA3)
    kinds = left.channels()
    assert kinds["LEFT_TARGET"] == "TARGET" and kinds["RIGHT_LINKS"] == "OBSTACLES", kinds
    bar = crowds.obstacle(1, 1, [0.1, 0.5], [0.3, 0.2, 0.7], [0, 1, 0])
    bar.quaternion = arm.quaternion_of(arm.rotation_from_z(np.array([1.0, 0, 0])))
    drawn = left.in_world(bar)
    assert np.allclose(drawn.position, [-0.8, -0.2, 0.7]) and np.allclose(drawn.velocity, [0, -1, 0]), drawn.position
    assert np.allclose(np.abs(arm.rotation_of_quaternion(drawn.quaternion)[:, 2]), [1, 0, 0])


def goals():
    """The star of a target is where the newest target or posture puts the tool."""
    lwa3 = ArmView(ROOT / "firmware/config/lwa3.yaml", LWA3)
    target, posture = wire.target_t(), wire.joint_target_t()
    target.position = [1.0, 2.0, 3.0]
    posture.num_joints, posture.joint_position = 7, [0, math.pi / 2, 0, -math.pi / 2, 0, 0, 0]
    home_m = [-0.328, 0, 0.9137]
    latest = type("Latest", (dict,), {})({"TARGET": target, "JOINT_TARGET": posture})
    for last, goal_m in (("JOINT_TARGET", home_m), ("TARGET", [1, 2, 3])):
        latest.received_s = {"TARGET": 1, "JOINT_TARGET": 1} | {last: 2}
        assert np.allclose(lwa3.target(latest), goal_m, atol=1e-4), lwa3.target(latest)
    posture.num_joints = 6
    assert arm.goal_m(lwa3.chain, posture) is None
    with tempfile.TemporaryDirectory() as name:
        log, state, status = lcm.EventLog(f"{name}/log", "w"), wire.joint_state_t(), wire.controller_status_t()
        posture.num_joints = state.num_joints = 7
        state.joint_position, state.joint_velocity = posture.joint_position, [0.0] * 7
        sent_messages = (("ARM_STATE", state), ("TARGET", target), ("CONTROLLER_STATUS", status),
                         ("JOINT_TARGET", posture), ("CONTROLLER_STATUS", status), ("TARGET", target),
                         ("CONTROLLER_STATUS", status))
        for number, (channel, message) in enumerate(sent_messages):
            log.write_event(number, channel, message.encode())
        log.close()
        shown = [lwa3.target(latest) for _, latest in logs.cycles(f"{name}/log", [lwa3], lwa3)]
        assert np.allclose(shown, [[1, 2, 3], home_m, [1, 2, 3]], atol=1e-4), shown


def surroundings():
    """The table and the wall of a configuration are drawn."""
    table, wall = ArmView(ROOT / "firmware/config/table.yaml", LWA3).surroundings
    assert (table.id, table.shape, wall.id) == (-2, 2, -3) and list(wall.size) == [0.05, 2.5, 2.0]
    assert np.allclose(table.position, [-0.8, 0, 0.35])
    assert math.isclose(geometry.distance_m(table, np.array([[-0.8, 0, 0.47]]))[0], 0.1)


def visual_meshes():
    """Visual meshes are found beside the URDF and below the package path; a missing file is left out."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "packages/arms").mkdir(parents=True)
        for file in ("base.stl", "packages/arms/hand.dae"):
            (folder / file).touch()
        visual = '<visual><origin xyz="0 0 {}"/><geometry><mesh filename="{}" scale="2 2 2"/></geometry></visual>'
        (folder / "arm.urdf").write_text(
            f'<robot name="none"><link name="base">{visual.format(1, "base.stl")}{visual.format(1, "no.stl")}</link>'
            f'<link name="hand">{visual.format(3, "package://arms/hand.dae")}</link>'
            '<joint name="j" type="revolute"><parent link="base"/><child link="hand"/></joint></robot>')
        found = visuals.visuals(folder / "arm.urdf", "base", "hand", [folder / "packages"])
        assert [(one.frame, one.file) for one in found] == [(0, folder / "base.stl"),
                                                            (1, folder / "packages/arms/hand.dae")], found
        assert list(found[1].position) == [0, 0, 3] and list(found[0].scale) == [2, 2, 2]
        assert len(visuals.visuals(folder / "arm.urdf", "base", "hand")) == 1
    assert visuals.visuals(*LWA3) == []


def logged_run(folder):
    """Runs paper-a in lockstep. Returns the simulator's log and the duration of the run."""
    log, scenario_file = folder / "run.lcmlog", ROOT / "host/scenarios/paper-a.yaml"
    runs.execute(scenario_file, "sidestep", folder / "run.csv", lcm_url=runs.private_url(), log=log)
    return log, runs.load_scenario(scenario_file)["duration_s"]


def recorder_of(file, url):
    """record.py, which listens."""
    recorder = subprocess.Popen([sys.executable, ROOT / "host/tools/record.py", file, "--lcm-url", url],
                                stdout=subprocess.PIPE)
    recorder.stdout.readline()
    return recorder


def log_replays():
    """record.py records the messages that lcm-logplayer plays from a log."""
    url = runs.private_url()
    with tempfile.TemporaryDirectory() as name:
        log, _ = logged_run(Path(name))
        copy = Path(name) / "copy.lcmlog"
        recorder = recorder_of(copy, url)
        subprocess.run(["lcm-logplayer", "--lcm-url", url, log], check=True, timeout=60, stdout=subprocess.DEVNULL)
        time.sleep(0.5)
        recorder.send_signal(signal.SIGINT)
        assert recorder.wait(10) == 0
        lwa3 = ArmView(arm.CONFIG, LWA3)
        played, again = (logs.run_of(file, [lwa3], lwa3, arm.CONFIG).joints() for file in (log, copy))
    assert len(again) > 0.95 * len(played), (len(again), len(played))
    assert np.array_equal(again[-1], played[-1])


def closed_logs():
    """record.py closes its log at each signal that ends it, also when its terminal is closed."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        url = runs.private_url()
        with tempfile.TemporaryDirectory() as name:
            log = Path(name) / "run.lcmlog"
            recorder, sender, end_s = recorder_of(log, url), wire.connect(url), time.monotonic() + 10
            while log.stat().st_size == 0:  # until it has written, the rest of its messages being in its buffer
                assert time.monotonic() < end_s, number
                sender.publish("TARGET", wire.TYPES["TARGET"]().encode())
                time.sleep(0.001)
            recorder.send_signal(number)
            assert recorder.wait(10) == 0, number
            channels = [event.channel for event in lcm.EventLog(str(log))]
            assert recorder.stdout.read() == f"{len(channels)} messages in {log}\n".encode(), number
            assert set(channels) == {"TARGET"}, number


def survivors_of_nohup():
    """Under nohup(1) a script goes on when its terminal is closed, but ends at SIGTERM; without nohup it ends."""
    script = ("import os, runs, sys\n"
              "def main():\n"
              "    print(os.getpid(), flush=True)\n"
              "    return len(sys.stdin.read())\n"
              "runs.main_of(main)\n")
    for words, number, code in ((["nohup"], signal.SIGHUP, 4), (["nohup"], signal.SIGTERM, 130),
                                ([], signal.SIGHUP, 130)):
        process = subprocess.Popen([*words, sys.executable, "-c", script], cwd=ROOT / "host/tools", text=True,
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        os.kill(int(process.stdout.readline()), number)
        process.communicate("four", timeout=10)
        assert process.returncode == code, (words, number, process.returncode)


def sent(script, *words):
    """The first value that a script with these arguments sends."""
    values = []
    with contextlib.redirect_stdout(io.StringIO()), \
            mock.patch.multiple(script, send=lambda motion, _url: values.append(motion(0.0))), \
            mock.patch.object(sys, "argv", ["", *words]):
        script.main()
    return values[0]


def announcements():
    """The senders say what they send."""
    for script, words, said in ((send_target, ["0.1", "0.2", "-1", "--circle", "0.3"],
                                 "sending a target on a circle of 0.3 m radius about 0.1 0.2 -1 m, once in 8 s on T"),
                                (send_target, ["1", "0", "1", "0", "0", ".1"], "at 1 0 1 m and moves at 0 0 0.1 m/s"),
                                (send_target, ["--joints", "-1,0,.5"], "posture -1 0 0.5 on JOINT_TARGET, 50 times"),
                                (send_obstacles, ["1,0,1,.1"], "sending 1 obstacle on OBSTACLES, 50 times a second"),
                                (send_obstacles, [], "sending no obstacles (the empty set)")):
        output = io.StringIO()
        with contextlib.redirect_stdout(output), mock.patch.multiple(script, send=lambda _motion, _url: None), \
                mock.patch.object(send_target, "send_posture", lambda _joints_rad, _url: None), \
                mock.patch.object(sys, "argv", ["", *words]):
            script.main()
        assert said in output.getvalue() and output.getvalue().count("\n") == 1, output.getvalue()


def refusal(script, *words):
    """Exit code and last line of error output of a script with these arguments."""
    errors = io.StringIO()
    with contextlib.redirect_stderr(errors), mock.patch.multiple(sys, argv=["", *map(str, words)], stdin=io.StringIO()):
        try:
            script.main()
        except SystemExit as end:
            return (1, end.code) if isinstance(end.code, str) else (end.code, errors.getvalue().splitlines()[-1])


def coordinates():
    """Numbers are parsed correctly with a minus sign, with an exponent, among options and after `--`."""
    for words in (("-0.3,0,1,.1",), ("--", "-0.3,0,1,.1"), ("--seed", "-2", "-3e-1,0,1,.1")):
        (sphere,) = sent(send_obstacles, *words)
        assert sphere.position == [-0.3, 0, 1] and sphere.size[0] == 0.1, (words, sphere.position)
    assert len(sent(send_obstacles, "1,0,1,.1", "--seed", "2", "-1,0,1,.1")) == 2
    assert sent(send_target, "-1e-3", "0.4", "-.7", "0", "-2e-1", "0")[1] == [0, -0.2, 0]
    assert [len(sent(send_obstacles, *words)) for words in ((), ("--random", "3"))] == [0, 3]


def refusals():
    """A script rejects wrong arguments and files with one line that has the reason, and sends nothing."""
    with tempfile.TemporaryDirectory() as name:
        rows = Path(name) / "rows.csv"
        rows.write_text(f"t_s,id,x_m,y_m,z_m,radius_m\n0,4,0.5,0,0,0.1\n0,{2**31},0.5,0,0,0.1\n")
        no_robot, log = Path(name) / "no-robot.yaml", Path(name) / "old.lcmlog"
        no_robot.write_text("rate_hz: 100\n")
        log.write_text("old")
        short_row, thin = Path(name) / "short.csv", Path(name) / "thin.csv"
        short_row.write_text("t_s,id,x_m,y_m,z_m,radius_m\n0,4,0.5,0\n")
        thin.write_text("t_s,id,x_m,y_m,z_m,radius_m\n0,4,0.5,0,0,-1\n")
        no_rows = Path(name) / "no-rows.csv"
        no_rows.write_text("t_s,id,x_m,y_m,z_m,radius_m\n")
        nonsense = Path(name) / "nonsense"  # neither YAML nor XML
        nonsense.write_text("a: b: c\n")
        for script, words, code, reason in (
                (send_obstacles, ["--random", "-3"], 2, "-3 is below 0"),
                (send_obstacles, ["--random", "2", "1,0,1,.1"], 2, "spheres cannot be combined"),
                (send_obstacles, ["1,0,1,.1", "--person"], 2, "spheres cannot be combined"),
                (send_obstacles, ["--csv", ""], 2, "No such file"),
                (send_obstacles, ["--csv", rows], 2, f"{rows}, line 3: id {2**31}"),
                (send_obstacles, ["0,0,1,-0.1"], 2, "radius -0.1 is below 0"),
                (send_obstacles, ["--random", "5000"], 2, "5000 obstacles are more than"),
                (send_obstacles, ["--csv", short_row], 2, f"{short_row}, line 2: too few columns"),
                (send_obstacles, ["--csv", thin], 2, f"{thin}, line 2: radius -1 is below 0"),
                (send_obstacles, ["--csv", no_rows], 2, f"{no_rows}: no rows"),
                (control, ["pause", "--speed", "1.5"], 2, "1.5 is not from 0 to 1"),
                (control, ["halt"], 2, "invalid choice: 'halt'"),
                (send_target, ["1", "0", "1", "--keys"], 2, "needs a terminal"),
                (send_target, ["1", "0", "1", "--joints", "0,0"], 2, "no point beside --joints"),
                (send_target, ["--joints", "0,nan"], 2, "'nan' is not a finite number"),
                (send_target, ["1", "1e300", "0"], 2, "1e300 is beyond 1000 m or m/s"),
                (send_target, ["1", "0", "0", "1", "0", "0", "--circle", "1"], 2, "no velocity beside --circle"),
                (send_obstacles, ["2000,0,0,.1"], 2, "a number is beyond 1000 m or m/s"),
                (send_attachments, ["--allow", str(2**31)], 2, "has more than 32 bits"),
                (send_target, [], 2, "expected three numbers"),
                (record, [log, "--channels", "(", "--lcm-url", runs.private_url()], 1, "subscribe to '('"),
                (report, [log, "--config", nonsense], 1, f"{nonsense}: mapping"),
                (report, [log, "--config", no_robot], 1, "robot has no urdf"),
                (report, [log, "--urdf", nonsense], 1, f"{nonsense}: syntax error"),
                (view, ["--config", "/nonexistent"], 1, "No such file"),
                (timing, ["--rate", "0"], 2, "0 is not from 10 to 2000"),
                (view, ["--port", "80000"], 2, "80000 is not from 1 to 65535"),
                (view, ["--config", nonsense], 1, f"{nonsense}: mapping")):
            result = refusal(script, *words)
            assert result[0] == code and reason in result[1] and "\n" not in result[1], (words, result)
            assert "Errno" not in result[1], result
        assert log.read_text() == "old"
        robot = dict(urdf="arm.urdf", base="base", tip="tool")
        assert arm.robot_of(no_robot, argparse.Namespace(**robot)) == tuple(robot.values())


def unknown_scenario():
    """The error about a scenario that does not exist lists those that do."""
    try:
        runs.load_scenario(ROOT / "host/scenarios/nope.yaml")
        assert False
    except runs.RunFailed as error:
        assert str(error).startswith("host/scenarios/nope.yaml: no such scenario; there are box, closing-gap,"), error


def free_port():
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


def taken_port():
    """A port that another process listens on is refused before anything starts."""
    with socket.socket() as other:
        other.bind(("", 0))
        other.listen()
        port = other.getsockname()[1]
        with mock.patch.object(sys, "argv", ["", str(ROOT / "host/scenarios/play.yaml"), "--port", str(port)]):
            try:
                show.main()
                assert False
            except runs.RunFailed as failure:
                assert str(failure).startswith(f"port {port}: Address already in use") and "\n" not in str(failure)


def lost_view():
    """A view that ends also ends a scenario without end, which is said."""
    port = str(free_port())

    @contextlib.contextmanager
    def ending_view(*_):
        yield subprocess.Popen(["sleep", "1"])
    with mock.patch.multiple(sys, argv=["", str(ROOT / "host/scenarios/play.yaml"), "--port", port]), \
            mock.patch.dict(os.environ, LCM_DEFAULT_URL=runs.private_url()), \
            mock.patch.object(show, "viewer", ending_view):
        try:
            show.main()
            assert False
        except runs.RunFailed as failure:
            assert str(failure).startswith("the view has ended"), failure


def play_commands():
    """Each command that `make play` names runs and says something at once. --keys needs a terminal: without it."""
    alone = os.environ | {"LCM_DEFAULT_URL": runs.private_url()}
    commands = [line.split("#")[0].split() for line in show.COMMANDS.splitlines() if "host/tools" in line]
    assert len(commands) == 7, commands
    for command in commands:
        words = [word for word in command if word != "--keys"]
        process = subprocess.Popen(words, cwd=ROOT, env=alone, stdout=subprocess.PIPE, text=True)
        first = process.stdout.readline()
        process.kill()
        process.wait()
        assert first.startswith(("sending ", "waiting for CONTROLLER_STATUS")), (words, first)


def another_python():
    """A script that a Python without its packages starts goes on with that of build/venv."""
    for name in ("send_target.py", "docs.py", "timing.py"):
        done = subprocess.run(["/usr/bin/python3", ROOT / "host/tools" / name, "--help"], capture_output=True,
                              text=True)
        assert done.returncode == 0 and done.stdout.startswith(f"usage: {name}"), done


def busy_network():
    """A run is refused on a network with another controller, and says which other programs send."""
    url, was_heard = runs.private_url(), threading.Event()

    def send(kind, channel):
        while not was_heard.is_set():
            wire.publish_once(channel, wire.TYPES[kind](), url)
    for kind, channel in (("TARGET", "TARGET"), ("CONTROLLER_STATUS", "LEFT_STATUS")):
        assert network.heard(url) == {}
        was_heard.clear()
        sender, deadline = threading.Thread(target=send, args=(kind, channel), daemon=True), time.monotonic() + 20
        sender.start()
        while not (found := network.heard(url)) and time.monotonic() < deadline:
            pass
        was_heard.set()
        sender.join()
        assert found == {kind: channel}, found
        with mock.patch.object(network, "heard", lambda: dict(found)), \
                contextlib.redirect_stdout(io.StringIO()) as output:
            try:
                network.check_free()
                said = output.getvalue()
            except runs.RunFailed as failure:
                said = str(failure)
        assert said.startswith("note: another program sends on TARGET" if kind == "TARGET" else
                               "another controller runs on this LCM network (it sends on LEFT_STATUS)"), said


INTERRUPTED_POLL = """import signal, subprocess
poll, calls = subprocess.Popen.poll, []
def interrupted(process):
    calls.append(process)
    if len(calls) == 100:
        process._waitpid_lock.acquire()
        signal.raise_signal(signal.SIGINT)
        process._waitpid_lock.release()
    return poll(process)
subprocess.Popen.poll = interrupted
"""
TWO_ARMS = """import sys
sys.path.insert(0, "host/tools")
import runs
runs.main_of(lambda: runs.execute(runs.ROOT / "host/scenarios/two-arms.yaml", "sidestep", runs.RECORDS / "signals.csv",
                                  lcm_url=sys.argv[1], lockstep=False))"""


def second_signal():
    """Two signals in short succession leave no controller and no simulator behind."""
    url = runs.private_url()

    def running():
        return subprocess.run(["pgrep", "-c", "-f", f"^/.*/build/(controller|sim) .*{re.escape(url)}"],
                              capture_output=True, text=True).stdout.strip()
    for number in (signal.SIGINT, signal.SIGTERM):
        script = subprocess.Popen([sys.executable, "-c", TWO_ARMS, url], cwd=ROOT, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 20
        while running() != "3" and time.monotonic() < deadline:
            time.sleep(0.02)
        assert running() == "3", running()
        time.sleep(1.0)  # they run
        script.send_signal(number)
        time.sleep(0.03)
        script.send_signal(number)
        assert script.wait(20) == 130
        assert running() == "0", running()


def signal_within_poll():
    """A signal that comes while subprocess asks for the state of a process ends the run, too."""
    script = subprocess.run([sys.executable, "-c", INTERRUPTED_POLL + TWO_ARMS, runs.private_url()], cwd=ROOT,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=30)
    assert script.returncode == 130, script


def late_receiver():
    """Messages that came while nobody received are received even without time left; a flood ends at some time."""
    network = runs.private_url()
    latest = wire.LatestMessages(["TARGET"], network)
    target = wire.target_t()
    for pause_s in (0.3, 1, 3, 9):  # on a busy machine LCM's thread takes a while to get them
        for _ in range(3):
            target.utime += 1
            latest.network.publish("TARGET", target.encode())
        time.sleep(pause_s)
        latest.receive(0.0)
        if "TARGET" in latest and latest["TARGET"].utime == target.utime:
            break
    assert latest["TARGET"].utime == target.utime
    with mock.patch.object(wire, "handle_messages", return_value=True) as handled:
        latest.receive(0.0)
    assert handled.call_count == wire.MOST_AT_ONCE


def watched_texts():
    """watch.py tells a silent controller from a living one, and has words for what is no number."""
    status = wire.controller_status_t()
    status.mode, status.message, status.nearest_obstacle = status.FAULT, "fault: no arm state", -1
    status.target_distance, status.clearance, status.fault = math.nan, -15.0, status.FAULT_ARM_STATE_LOST
    status.limiting = status.LIMITING_SHIELD | status.LIMITING_NOT_REALTIME
    status.self_clearance = math.nan
    latest, ages_s = {"CONTROLLER_STATUS": status}, {"CONTROLLER_STATUS": 0.02, "OBSTACLES": 7.5}
    for shown in ("\n".join(watch.lines(latest, ages_s)), watch.brief(status, ages_s)):
        for part in ("FAULT", "no target", "unknown, the obstacles are too old", "fault: arm state lost"):
            assert part in shown, (part, shown)
        assert not re.search(r"nan|inf\b|-1|stale", shown), shown
    assert "limited by shield, not realtime;" in "\n".join(watch.lines(latest, ages_s))
    assert watch.lines(latest, {"CONTROLLER_STATUS": 3.2})[0].startswith("stale for 3 s: the controller is silent")
    assert watch.mode_text(status) == ("FAULT", "fault: no arm state")
    assert watch.lines({}, {}) == ["waiting for CONTROLLER_STATUS"]
    status.self_clearance, status.self_links = math.nan, ["", ""]
    assert "links: distances not measured" in watch.lines(latest, ages_s)
    status.limiting, status.self_clearance, status.self_links = status.LIMITING_SELF, 0.0123, ["forearm", "hand"]
    for shown in ("\n".join(watch.lines(latest, ages_s)), watch.brief(status, ages_s)):
        assert "forearm and hand are 12 mm apart" in shown, shown
    for clearance_m, text in ((0.1234, "0.123 m"), (math.inf, "no obstacles"), (math.nan, "unknown, no obstacles")):
        status.clearance = clearance_m
        assert watch.clearance_text(status, {}).startswith(text)
    status.clearance = 0.1234
    assert watch.clearance_text(status, {"CONTROLLER_STATUS": 0.3, "OBSTACLES": 0.33}) == "0.123 m"  # a late viewer
    for ages, text in (({}, "none received"), ({"TARGET": 0.1, "ARM_STATE": 0.0}, "of the tool"),
                       ({"TARGET": 0.3, "JOINT_TARGET": 0.1}, "a posture")):
        assert watch.goal_text(ages) == text and f"target: {text}" in "\n".join(watch.lines(latest, ages))
    for scale, text in ((1.0, ""), (0.25, "at 25% speed"), (0.0, "at 0% speed")):
        status.speed_scale = scale
        assert watch.speed_text(status) == text and text in watch.brief(status, {})
    status.message = "holding: paused"
    assert watch.speed_text(status) == ""
    status.message = ""
    status.nearest_link = "hand"
    for number, text in ((-1, ""), (7, "hand and obstacle 7"), (-3, "hand and surroundings[1]"),
                         (-20004, "hand and link 4 of another arm")):
        status.nearest_obstacle = number
        assert watch.nearest_text(status) == text, watch.nearest_text(status)


def networks():
    """Two runs never have the same network, even if the same port is drawn twice; nor have two processes."""
    drawn = iter([40001, 40001, 40002, 40001])
    with mock.patch("random.randint", lambda *_: next(drawn)):
        urls = [runs.private_url(), runs.private_url()]
    assert [url.split(":")[2] for url in urls] == ["40001?ttl=0", "40002?ttl=0"], urls
    other = ("import runs, random; ports = iter([40001, 40003]); random.randint = lambda *_: next(ports); "
             "print(runs.private_url())")
    printed = subprocess.run([sys.executable, "-c", other], cwd=ROOT / "host/tools", capture_output=True, text=True)
    assert ":40003?" in printed.stdout, printed


def camera():
    """The camera of the view moves aside where a wall would hide the arm."""
    free = stage.camera_m(np.zeros(3), [])
    assert np.allclose(free, stage.CAMERA_M), free
    wall = static_obstacle({"shape": "box", "edges_m": [2, 0.1, 2], "position_m": [0, -0.6, 0.5]}, -2)
    assert stage.camera_m(np.zeros(3), [wall])[1] > -0.5, "behind the wall"


def hostile_bytes():
    """Bytes that are not a message of the channel's type are no message, and raise no exception."""
    generator = random.Random(1)
    for channel, kind in wire.TYPES.items():
        whole = kind().encode()
        for data in (b"", whole[:-1], b"\0" * 40):
            assert wire.decoded(channel, data) is None, (channel, data)
        wire.decoded(channel, whole[:8] + generator.randbytes(60))  # may be a message
        assert wire.decoded(channel, whole) is not None


def manual_pages():
    """Every manual page lists the options that its program's --help lists."""
    for page in sorted((ROOT / "host/install/man").glob("*.1")):
        name = page.stem.removeprefix("sidestep-")
        script = ROOT / f"host/tools/{name.replace('-', '_')}.py"
        command = [sys.executable, script] if script.exists() else [ROOT / f"build/{name}"]
        text = subprocess.run([*command, "--help"], check=True, capture_output=True, text=True).stdout
        offered = set(re.findall(r"^ *(?:-h,? *)?(--[a-z][a-z-]*)", text, re.MULTILINE))
        entries = "".join(re.findall(r"^\.It Fl .*$", page.read_text(), re.MULTILINE))
        listed = {f"-{option}" for option in re.findall(r"Fl (?:h , )?(-[a-z][a-z-]*)", entries)}
        assert offered and offered == listed, (name, offered ^ listed)


def installed_modules():
    """Every module of host/tools that an installed script imports is installed, too (environment is cut out)."""
    staged = re.search(r"for tool in (send_target .*); do", (ROOT / "host/install/stage").read_text())[1].split()
    assert {"send_target", "record", "wire"} <= set(staged)
    for name in staged:
        text = (ROOT / f"host/tools/{name}.py").read_text()
        imported = set(re.findall(r"^ *(?:import|from) ([a-z_]+)", text, re.MULTILINE)) - {"environment"}
        missing = {other for other in imported if (ROOT / f"host/tools/{other}.py").exists()} - set(staged)
        assert not missing, (name, missing)


CHECKS = {check.__name__: check for check in (velocities, tracks, clearances, nearest_lines, unknown_clearance,
                                              allowed_touch, panel_texts, quaternions, places,
                                              surroundings, visual_meshes, log_replays, closed_logs,
                                              survivors_of_nohup, coordinates, refusals, announcements,
                                              unknown_scenario, taken_port, lost_view, play_commands, another_python,
                                              busy_network, networks, camera, second_signal, signal_within_poll,
                                              late_receiver, watched_texts, hostile_bytes, goals,
                                              manual_pages, installed_modules)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("check", choices=CHECKS)
    CHECKS[parser.parse_args().check]()
