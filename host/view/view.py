#!/usr/bin/env python3
"""Show one or more controllers live on a page of this machine, until Ctrl-C.

The page shows each arm, by its visual meshes where there are any and by the shapes that the controller uses, coloured
by clearance; the obstacles with their velocities; the surroundings of the configuration; the target; the tool's past
path and, while foresight guides the arm, its coming path; and the state of the controller in words.
"""
import argparse
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/tools"))
import arm
import runs
import wire
from arm_view import ArmView
from stop_signals import on_stop

PERIOD_S = 1 / 30
CATCH_UP_S = 0.1      # a drawing that is late by less shortens the wait for the next, so that the rate holds
SLOW = 6              # colours and words change every SLOW frames
TRAIL_POINTS = 60


class View:
    """Several arms in one world, each an ArmView."""

    def __init__(self, arms, lcm_url, port, steers):
        import viser  # takes a second, and tests of the arguments do without it

        import panel
        import resolution
        import stage
        self.arms = arms
        channels = {name: kind for one in arms for name, kind in one.channels().items()}
        self.latest = wire.LatestMessages(channels, lcm_url)
        # Whoever reaches the page can steer where that is offered: this machine only.
        self.server = viser.ViserServer(host="127.0.0.1", port=port, label="Sidestep", verbose=False)
        resolution.adapt(self.server)
        self.stage = stage.Stage(self.server, arms, TRAIL_POINTS)
        self.panel = panel.Panel(self.server, arms, stage.first_layers(arms))
        self.steering = panel.Steering(self.server) if steers else None
        self.server.gui.add_html(panel.key())
        self.frame = 0

    def draw(self):
        slow = self.frame % SLOW == 0
        self.frame += 1
        tools = self.stage.draw(self.latest, self.panel.layers(), colours=slow)
        if slow:
            self.panel.show([one.state(self.latest) for one in self.arms])
        if self.steering and (target := self.steering.message(tools[0], self.arms[0].in_base)):
            self.latest.network.publish(self.arms[0].names["TARGET"], target.encode())

    def run(self):
        due_s = time.monotonic()
        while True:
            due_s = max(due_s + PERIOD_S, time.monotonic() - CATCH_UP_S)
            self.latest.receive(max(due_s - time.monotonic(), 0.0))
            with self.server.atomic():
                self.draw()


def port(text):
    """The port that the text gives; argparse names what is wrong with another text."""
    if not 1 <= (value := int(text)) <= 65535:
        raise argparse.ArgumentTypeError(f"{text} is not from 1 to 65535")
    return value


def add_port(parser):
    parser.add_argument("--port", type=port, default=7000, help="port of the browser page (default %(default)s)")


def arms_of(arguments):
    """An ArmView for each configuration, named after its file if there are several."""
    return [ArmView(config, arm.robot_of(config, arguments), config.stem if len(arguments.config) > 1 else "")
            for config in arguments.config]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", type=Path, nargs="+", default=[arm.CONFIG],
                        help="configuration of the controller, one for each arm (default: that of the LWA3)")
    add_port(parser)
    parser.add_argument("--steer", action="store_true", help="offer a target to drag, which is then sent on TARGET")
    arm.add_robot(parser)
    wire.add_lcm_url(parser)
    arguments = parser.parse_args()
    on_stop(runs.interrupt)
    try:
        View(arms_of(arguments), arguments.lcm_url, arguments.port, arguments.steer).run()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
