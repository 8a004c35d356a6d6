"""What a configuration and its channels tell of one arm, in the world frame of its neighbours."""
import copy
from pathlib import Path

import numpy as np
import yaml

import arm
import scene
from bus import obstacle_t

HEARD = ["ARM_STATE", "OBSTACLES", "TARGET", "CONTROLLER_STATUS"]
SHAPES = {"sphere": (obstacle_t.SPHERE, ["radius_m"]), "capsule": (obstacle_t.CAPSULE, ["radius_m", "length_m"]),
          "box": (obstacle_t.BOX, [])}


def thing_of(said, number):
    """One of `surroundings`, with the id that the status uses."""
    thing = obstacle_t()
    thing.id, (thing.shape, keys) = number, SHAPES[said["shape"]]
    thing.size = said["edges_m"] if not keys else [*(said[key] for key in keys), 0.0, 0.0][:3]
    thing.position, thing.quaternion = said["position_m"], said.get("quaternion", [1, 0, 0, 0])
    return thing


class Side:
    """robot: (URDF, base, tip). name: goes before that of all that is drawn of it. heard: bus.Newest of channels()."""

    def __init__(self, config, robot, name=""):
        said = yaml.safe_load(Path(config).read_text())
        neighbours = said.get("neighbours") or {}
        self.name = name
        self.chain, self.shapes = arm.chain(*robot), arm.shapes(*robot)
        self.names = {kind: (said.get("channels") or {}).get(kind.lower(), kind) for kind in HEARD}
        self.neighbours = neighbours.get("listen") or []
        self.place = np.array(neighbours.get("base_position_m", [0, 0, 0]), float)
        self.turn = arm.rotation_of(*neighbours.get("base_rpy_rad", [0, 0, 0]))
        self.surroundings = [self.in_world(thing_of(thing, -2 - i))
                             for i, thing in enumerate(said.get("surroundings") or [])]

    def channels(self):
        """Name -> which of bus.TYPES it is like."""
        return {name: kind for kind, name in self.names.items()} | dict.fromkeys(self.neighbours, "OBSTACLES")

    def point(self, place):
        return self.place + self.turn @ np.array(place)

    def in_world(self, obstacle):
        seen = copy.copy(obstacle)
        seen.position, seen.velocity = self.point(obstacle.position), self.turn @ np.array(obstacle.velocity)
        seen.quaternion = arm.quaternion_of(self.turn @ arm.turn_of(obstacle.quaternion))
        return seen

    def obstacles(self, heard):
        message = heard.get(self.names["OBSTACLES"])
        known = message.obstacles if message else []
        return [self.in_world(obstacle) for obstacle in known if obstacle.shape in scene.OBSTACLE_KINDS]

    def links_of_others(self, heard):
        return [link for name in self.neighbours if name in heard for link in heard[name].obstacles]

    def frames(self, heard):
        """Of the chain, the tool last; None until the arm was heard."""
        state = heard.get(self.names["ARM_STATE"])
        if state is None or state.num_joints != sum(axis is not None for _, _, axis in self.chain):
            return None
        return [(self.point(place), self.turn @ turn) for place, turn in arm.frames(self.chain, state.joint_position)]

    def target(self, heard):
        message = heard.get(self.names["TARGET"])
        return self.point(message.position) if message else None

    def guide(self, heard):
        status = heard.get(self.names["CONTROLLER_STATUS"])
        return [self.point(place) for place in status.guide_tool] if status and status.guide_horizon > 0 else []
