#!/usr/bin/env python3
"""Publish what the controller's channels say as messages of Drake's viewer, for Meldis or another one.

Each arm in the shapes and colours of its clearance (red: near, blue: free), obstacles with arrowheads where they will
be after 0.15, 0.3 and 0.45 s, the configuration's surroundings (grey), the target, the way the tool came (black beads)
and, while a guide leads it, the way it will go (orange beads).
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
from side import Side

PERIOD_S = 0.04
REPEAT_LOAD_S = 1.0  # a viewer that starts later has to hear it, too
TRAIL_STEP_M = 0.01
JUMP_M = 0.3         # in one period: another run has begun


class View:
    """Of all sides; what each has of its own is named after it. Obstacles are the same for all."""

    def __init__(self, sides, lcm_url):
        self.sides = sides
        self.heard = bus.Newest({name: kind for side in sides for name, kind in side.channels().items()}, lcm_url)
        self.trails = [deque(maxlen=scene.TRAIL_BEADS) for _ in sides]
        self.surroundings = [thing for side in sides for thing in side.surroundings]
        for i, thing in enumerate(self.surroundings):
            thing.id = -2 - i  # of several arms: no two alike
        self.loaded, self.load_due_s = None, 0.0

    def things(self):
        return self.sides[0].obstacles(self.heard) + self.surroundings

    def load(self):
        things = self.things()
        key = [(thing.id, thing.shape, *thing.size) for thing in things]
        if key == self.loaded and time.monotonic() < self.load_due_s:
            return
        self.loaded, self.load_due_s = key, time.monotonic() + REPEAT_LOAD_S
        parts = scene.obstacle_parts(things)
        for side in self.sides:
            parts |= named(side, {
                "target": [scene.part(scene.KINDS["sphere"], [0.03], scene.TARGET)], **scene.arm_parts(side.shapes),
                **scene.beads("trail", scene.TRAIL_BEADS, 0.006, scene.TRAIL),
                **scene.beads("guide", scene.GUIDE_BEADS, 0.012, scene.GUIDE)})
        self.heard.wire.publish("DRAKE_VIEWER_LOAD_ROBOT", scene.load_message(parts).encode())

    def poses(self, side, trail, things):
        """Of what is a side's own; nothing until its arm is heard."""
        frames, target = side.frames(self.heard), side.target(self.heard)
        if frames is None:
            return {}
        follow(trail, frames[-1][0])
        return named(side, {
            "target": scene.AWAY if target is None else (target, np.eye(3)),
            **scene.arm_poses(side.shapes, frames, things + side.links_of_others(self.heard)),
            **scene.bead_poses("trail", scene.TRAIL_BEADS, trail),
            **scene.bead_poses("guide", scene.GUIDE_BEADS, side.guide(self.heard))})

    def draw(self):
        things, poses = self.things(), {}
        for side, trail in zip(self.sides, self.trails):
            poses |= self.poses(side, trail, things)
        if not poses:
            return
        for thing in things:
            poses |= scene.obstacle_poses(thing)
        self.heard.wire.publish("DRAKE_VIEWER_DRAW", scene.draw_message(poses, time.time()).encode())

    def run(self):
        while True:
            self.heard.listen(PERIOD_S)
            self.load()
            self.draw()


def named(side, things):
    return {f"{side.name}{name}": thing for name, thing in things.items()}


def follow(trail, tool):
    if trail and np.linalg.norm(tool - trail[-1]) > JUMP_M:
        trail.clear()
    if not trail or np.linalg.norm(tool - trail[-1]) > TRAIL_STEP_M:
        trail.append(tool)


def sides_of(arguments):
    """A side for each configuration, named after it where there are several."""
    return [Side(config, arm.robot_of(config, arguments), f"{config.stem}::" if len(arguments.config) > 1 else "")
            for config in arguments.config]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", type=Path, nargs="+", default=[arm.CONFIG],
                        help="one for each arm; default: the LWA3's")
    arm.add_robot(parser)
    bus.add_lcm_url(parser)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        View(sides_of(arguments), arguments.lcm_url).run()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
