#!/usr/bin/env python3
"""Show one or more controllers live on a page of this machine, until Ctrl-C.

The page shows each arm, by its visual meshes where there are any and by the shapes that the controller uses, coloured
by clearance; the obstacles with their velocities; the surroundings of the configuration; the target; the tool's past
path and, while foresight guides the arm, its coming path; and the state of the controller in words.
"""
import argparse
import signal
import sys
import time
from collections import deque
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/tools"))
import arm
import geometry
import wire
from arm_view import ArmView

PERIOD_S = 1 / 30
SLOW = 6              # colours and words change every SLOW frames
TRAIL_POINTS = 120
TRAIL_STEP_M = 0.01
JUMP_M = 0.3          # a tool motion within one period that only a new run can cause
CAMERA_M, LOOK_AT_M, FIELD_RAD = (1.1, -1.6, 1.1), (0.1, 0.0, 0.5), 0.75  # from the middle of the arms' bases


class View:
    """Several arms in one world; all have the same obstacles."""

    def __init__(self, arms, lcm_url, port, steers):
        import viser  # takes a second, and tests of the arguments do without it

        import panel
        import scene
        self.arms = arms
        channels = {name: kind for one in arms for name, kind in one.channels().items()}
        self.latest = wire.LatestMessages(channels, lcm_url)
        self.trails = [deque(maxlen=TRAIL_POINTS) for _ in arms]
        self.surroundings = [obstacle for one in arms for obstacle in one.surroundings]
        for i, obstacle in enumerate(self.surroundings):
            obstacle.id = -2 - i  # unique among several arms
        # Whoever reaches the page can steer where that is offered: this machine only.
        self.server = viser.ViserServer(host="localhost", port=port, label="Sidestep", verbose=False)
        middle = np.mean([one.position for one in arms], axis=0)
        self.server.initial_camera.position = middle + CAMERA_M
        self.server.initial_camera.look_at = middle + LOOK_AT_M
        self.server.initial_camera.fov = FIELD_RAD
        self.server.scene.configure_default_lights(cast_shadow=False)  # shadows cost most without a GPU
        self.server.scene.add_grid("/floor", width=4.0, height=4.0, cell_size=0.25, section_size=1.0)
        self.arm_nodes = [scene.ArmNodes(self.server.scene, one) for one in arms]
        self.obstacle_nodes = scene.ObstacleNodes(self.server.scene)
        self.panel = panel.Panel(self.server, arms, any(one.visuals for one in arms))
        self.steering = panel.Steering(self.server) if steers else None
        self.server.gui.add_html(panel.key())
        self.frame = 0

    def draw(self):
        obstacles = self.arms[0].obstacles(self.latest) + self.surroundings
        slow = self.frame % SLOW == 0
        self.frame += 1
        tools = [self.draw_arm(*parts, obstacles if slow else None)
                 for parts in zip(self.arms, self.arm_nodes, self.trails)]
        self.obstacle_nodes.shows_arrows = self.panel.arrows.value
        self.obstacle_nodes.draw(obstacles)
        if slow:
            self.panel.show([one.state(self.latest) for one in self.arms])
        if self.steering and (target := self.steering.message(tools[0], self.arms[0].in_base)):
            self.latest.network.publish(self.arms[0].names["TARGET"], target.encode())

    def draw_arm(self, one, nodes, trail, obstacles):
        """Draws one arm and returns its tool position; None before its first arm state. obstacles: to colour it."""
        link_poses = one.link_poses(self.latest)
        if link_poses is None:
            return None
        extend(trail, link_poses[-1][0])
        nodes.place(link_poses)
        nodes.mark(one.target(self.latest), trail if self.panel.trail.value else [], one.guide(self.latest))
        nodes.show(self.panel.visuals.value, self.panel.shapes.value)
        if obstacles is not None:
            near = obstacles + one.links_of_others(self.latest)
            nodes.colour([geometry.clearance_m(shape, link_poses[shape.frame], near) for shape in one.shapes])
        return link_poses[-1][0]

    def run(self):
        due_s = time.monotonic()
        while True:
            due_s = max(due_s + PERIOD_S, time.monotonic())
            self.latest.receive(due_s - time.monotonic())
            with self.server.atomic():
                self.draw()


def extend(trail, tool):
    if trail and np.linalg.norm(tool - trail[-1]) > JUMP_M:
        trail.clear()
    if not trail or np.linalg.norm(tool - trail[-1]) > TRAIL_STEP_M:
        trail.append(tool)


def arms_of(arguments):
    """An ArmView for each configuration, named after its file if there are several."""
    return [ArmView(config, arm.robot_of(config, arguments), config.stem if len(arguments.config) > 1 else "")
            for config in arguments.config]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", type=Path, nargs="+", default=[arm.CONFIG],
                        help="configuration of the controller, one for each arm (default: that of the LWA3)")
    parser.add_argument("--port", type=int, default=7000, help="port of the page (default %(default)s)")
    parser.add_argument("--steer", action="store_true", help="offer a target to drag, which is then sent on TARGET")
    arm.add_robot(parser)
    wire.add_lcm_url(parser)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        View(arms_of(arguments), arguments.lcm_url, arguments.port, arguments.steer).run()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
