#!/usr/bin/env python3
"""Publish the state of one or more controllers as messages of Drake's viewer, for Meldis or another viewer.

Drawn are: each arm, coloured by its clearance (red: small, blue: large); the obstacles, with arrowheads at their
extrapolated positions in 0.15, 0.3 and 0.45 s; the surroundings of the configuration (grey); the target; the tool's
past path (black beads); and, while foresight guides the arm, the tool's coming path (orange beads).
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
import scene
import wire
from arm_view import ArmView

PERIOD_S = 0.04
REPEAT_LOAD_S = 1.0  # for viewers that start later
TRAIL_STEP_M = 0.01
JUMP_M = 0.3         # a tool motion within one period that only a new run can cause


class View:
    """Several arms in one world. Each arm's own drawings carry its name; all arms have the same obstacles."""

    def __init__(self, arms, lcm_url):
        self.arms = arms
        channels = {name: kind for one in arms for name, kind in one.channels().items()}
        self.latest = wire.LatestMessages(channels, lcm_url)
        self.trails = [deque(maxlen=scene.TRAIL_BEADS) for _ in arms]
        self.surroundings = [obstacle for one in arms for obstacle in one.surroundings]
        for i, obstacle in enumerate(self.surroundings):
            obstacle.id = -2 - i  # unique among several arms
        self.loaded, self.load_due_s = None, 0.0

    def obstacles(self):
        return self.arms[0].obstacles(self.latest) + self.surroundings

    def load(self):
        obstacles = self.obstacles()
        key = [(obstacle.id, obstacle.shape, *obstacle.size) for obstacle in obstacles]
        if key == self.loaded and time.monotonic() < self.load_due_s:
            return
        self.loaded, self.load_due_s = key, time.monotonic() + REPEAT_LOAD_S
        parts = scene.obstacle_parts(obstacles)
        for one in self.arms:
            parts |= named(one, {
                "target": [scene.part(scene.KINDS["sphere"], [0.03], scene.TARGET)], **scene.arm_parts(one.shapes),
                **scene.beads("trail", scene.TRAIL_BEADS, 0.006, scene.TRAIL),
                **scene.beads("guide", scene.GUIDE_BEADS, 0.012, scene.GUIDE)})
        self.latest.network.publish("DRAKE_VIEWER_LOAD_ROBOT", scene.load_message(parts).encode())

    def poses(self, one, trail, obstacles):
        """Poses of one arm's own drawings; empty before its first arm state."""
        link_poses, target = one.link_poses(self.latest), one.target(self.latest)
        if link_poses is None:
            return {}
        extend(trail, link_poses[-1][0])
        return named(one, {
            "target": scene.HIDDEN if target is None else (target, np.eye(3)),
            **scene.arm_poses(one.shapes, link_poses, obstacles + one.links_of_others(self.latest)),
            **scene.bead_poses("trail", scene.TRAIL_BEADS, trail),
            **scene.bead_poses("guide", scene.GUIDE_BEADS, one.guide(self.latest))})

    def draw(self):
        obstacles, poses = self.obstacles(), {}
        for one, trail in zip(self.arms, self.trails):
            poses |= self.poses(one, trail, obstacles)
        if not poses:
            return
        for obstacle in obstacles:
            poses |= scene.obstacle_poses(obstacle)
        self.latest.network.publish("DRAKE_VIEWER_DRAW", scene.draw_message(poses, time.time()).encode())

    def run(self):
        while True:
            self.latest.receive(PERIOD_S)
            self.load()
            self.draw()


def named(one, drawings):
    return {f"{one.name}{name}": drawing for name, drawing in drawings.items()}


def extend(trail, tool):
    if trail and np.linalg.norm(tool - trail[-1]) > JUMP_M:
        trail.clear()
    if not trail or np.linalg.norm(tool - trail[-1]) > TRAIL_STEP_M:
        trail.append(tool)


def arms_of(arguments):
    """An ArmView for each configuration, named after its file if there are several."""
    return [ArmView(config, arm.robot_of(config, arguments), f"{config.stem}::" if len(arguments.config) > 1 else "")
            for config in arguments.config]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", type=Path, nargs="+", default=[arm.CONFIG],
                        help="configuration of the controller, one for each arm (default: that of the LWA3)")
    arm.add_robot(parser)
    wire.add_lcm_url(parser)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        View(arms_of(arguments), arguments.lcm_url).run()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
