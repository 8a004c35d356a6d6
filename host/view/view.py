#!/usr/bin/env python3
"""Publish what the controller's channels say as messages of Drake's viewer, for Meldis or another one.

The arm in the shapes and colours of its clearance (red: near, blue: free), obstacles with arrowheads where they will be
after 0.15, 0.3 and 0.45 s, the target, the way the tool came (black beads) and, while a guide leads it, the way it will
go (orange beads).
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
import bus
import scene

PERIOD_S = 0.04
REPEAT_LOAD_S = 1.0  # a viewer that starts later has to hear it, too
TRAIL_STEP_M = 0.01
JUMP_M = 0.3         # in one period: another run has begun


class View:
    def __init__(self, robot, lcm_url):
        self.chain, self.shapes = arm.chain(*robot), arm.shapes(*robot)
        self.heard = bus.Newest(["ARM_STATE", "OBSTACLES", "TARGET", "CONTROLLER_STATUS"], lcm_url)
        self.trail = deque(maxlen=scene.TRAIL_BEADS)
        self.loaded, self.load_due_s = None, 0.0

    def obstacles(self):
        message = self.heard.get("OBSTACLES")
        known = message.obstacles if message else []
        return [obstacle for obstacle in known if obstacle.shape in scene.OBSTACLE_KINDS]

    def load(self):
        obstacles = self.obstacles()
        key = [(obstacle.id, obstacle.shape, *obstacle.size) for obstacle in obstacles]
        if key == self.loaded and time.monotonic() < self.load_due_s:
            return
        self.loaded, self.load_due_s = key, time.monotonic() + REPEAT_LOAD_S
        parts = {"target": [scene.part(scene.KINDS["sphere"], [0.03], scene.TARGET)], **scene.arm_parts(self.shapes),
                 **scene.obstacle_parts(obstacles), **scene.beads("trail", scene.TRAIL_BEADS, 0.006, scene.TRAIL),
                 **scene.beads("guide", scene.GUIDE_BEADS, 0.012, scene.GUIDE)}
        self.heard.wire.publish("DRAKE_VIEWER_LOAD_ROBOT", scene.load_message(parts).encode())

    def follow(self, tool):
        if self.trail and np.linalg.norm(tool - self.trail[-1]) > JUMP_M:
            self.trail.clear()
        if not self.trail or np.linalg.norm(tool - self.trail[-1]) > TRAIL_STEP_M:
            self.trail.append(tool)

    def guide(self):
        status = self.heard.get("CONTROLLER_STATUS")
        return status.guide_tool if status and status.guide_horizon > 0 else []

    def draw(self):
        state, target = self.heard.get("ARM_STATE"), self.heard.get("TARGET")
        if state is None or state.num_joints != sum(axis is not None for _, _, axis in self.chain):
            return
        frames = arm.frames(self.chain, state.joint_position)
        self.follow(frames[-1][0])
        poses = {"target": (target.position, np.eye(3)) if target else scene.AWAY}
        poses |= scene.arm_poses(self.shapes, frames, self.obstacles())
        poses |= scene.bead_poses("trail", scene.TRAIL_BEADS, self.trail)
        poses |= scene.bead_poses("guide", scene.GUIDE_BEADS, self.guide())
        for obstacle in self.obstacles():
            poses |= scene.obstacle_poses(obstacle)
        self.heard.wire.publish("DRAKE_VIEWER_DRAW", scene.draw_message(poses, time.time()).encode())

    def run(self):
        while True:
            self.heard.listen(PERIOD_S)
            self.load()
            self.draw()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arm.add_robot(parser)
    bus.add_lcm_url(parser)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        View(arm.robot_of(arguments), arguments.lcm_url).run()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
