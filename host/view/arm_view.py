"""One arm of the view: its configuration and its messages, transformed to the world frame that the arms share."""
import copy

import numpy as np

import arm
import geometry
import runs
import watch
from visuals import visuals
from wire import obstacle_t

KINDS = ["ARM_STATE", "OBSTACLES", "TARGET", "JOINT_TARGET", "ATTACHMENTS",
         "CONTROLLER_STATUS"]  # the messages that are shown
SHAPES = {"sphere": (obstacle_t.SPHERE, ["radius_m"]), "capsule": (obstacle_t.CAPSULE, ["radius_m", "length_m"]),
          "cylinder": (obstacle_t.CYLINDER, ["radius_m", "height_m"]), "box": (obstacle_t.BOX, [])}
KNOWN = {number for number, _ in SHAPES.values()}
FAR_M = 1e4  # what is farther, larger or no number is not drawn


def is_near(*values):
    return all(bool(np.all(np.abs(value) < FAR_M)) for value in values)


def static_obstacle(settings, number):
    """An entry of `surroundings` as obstacle_t, with the negative id that controller_status_t uses for it."""
    obstacle = obstacle_t()
    obstacle.id, (obstacle.shape, keys) = number, SHAPES[settings["shape"]]
    obstacle.size = settings["edges_m"] if not keys else [*(settings[key] for key in keys), 0.0, 0.0][:3]
    obstacle.position, obstacle.quaternion = settings["position_m"], settings.get("quaternion", [1, 0, 0, 0])
    return obstacle


def link_obstacle(shape, position, rotation):
    """An arm.Shape as obstacle_t for other arms. position, rotation: of its link."""
    obstacle = obstacle_t()
    obstacle.shape, obstacle.size = SHAPES[shape.kind][0], [*shape.size, 0.0, 0.0][:3]
    obstacle.position = position + rotation @ shape.position
    obstacle.quaternion = arm.quaternion_of(rotation @ shape.rotation)
    return obstacle


class ArmView:
    """robot: (URDF, base, tip). name: of one arm among several. latest: wire.LatestMessages of channels()."""

    def __init__(self, config, robot, name=""):
        settings = runs.load(config)
        neighbours = settings.get("neighbours") or {}
        self.name = name
        self.chain, self.shapes = arm.chain(*robot), arm.shapes(*robot)
        self.joints = sum(joint.axis is not None for joint in self.chain)
        package_path = (settings.get("robot") or {}).get("package_path") or []
        self.visuals = visuals(*robot, [runs.ROOT / path for path in package_path])
        self.names = {kind: (settings.get("channels") or {}).get(kind.lower(), kind) for kind in KINDS}
        self.neighbours = neighbours.get("listen") or []
        self.position = np.array(neighbours.get("base_position_m", [0, 0, 0]), float)  # of the base, world frame
        self.rotation = arm.rotation_of_rpy(*neighbours.get("base_rpy_rad", [0, 0, 0]))
        self.surroundings = [self.in_world(static_obstacle(entry, -2 - i))
                             for i, entry in enumerate(settings.get("surroundings") or [])]

    def channels(self):
        """Channel name -> key of wire.TYPES."""
        return {name: kind for kind, name in self.names.items()} | dict.fromkeys(self.neighbours, "OBSTACLES")

    def point(self, position):
        return self.position + self.rotation @ np.array(position)

    def in_base(self, position):
        return self.rotation.T @ (np.array(position) - self.position)

    def in_world(self, obstacle):
        result = copy.copy(obstacle)
        result.position, result.velocity = self.point(obstacle.position), self.rotation @ np.array(obstacle.velocity)
        if not np.array_equal(self.rotation, np.eye(3)):
            result.quaternion = arm.quaternion_of(self.rotation @ arm.rotation_of_quaternion(obstacle.quaternion))
        return result

    def obstacles(self, latest):
        message = latest.get(self.names["OBSTACLES"])
        obstacles = message.obstacles if message else []
        return [self.in_world(obstacle) for obstacle in obstacles if obstacle.shape in KNOWN and
                is_near(obstacle.position, obstacle.quaternion, obstacle.size, obstacle.velocity)]

    def avoided(self, latest, frame, obstacles):
        """Those of the obstacles that a link, by its frame, has to avoid: the tool may touch what ATTACHMENTS allows."""
        message = latest.get(self.names["ATTACHMENTS"])
        if message is None:
            return obstacles
        tool = 1 + max(i for i, joint in enumerate(self.chain) if joint.axis is not None)
        held = {shape.id for shape in message.shapes}
        touched = set(message.allowed) if frame >= tool else held & set(message.allowed)
        return [obstacle for obstacle in obstacles if obstacle.id not in touched]

    def links_of_others(self, latest):
        return [link for name in self.neighbours if name in latest for link in latest[name].obstacles]

    def link_poses(self, latest):
        """The link poses, the tool last; None before the first arm state."""
        state = latest.get(self.names["ARM_STATE"])
        if state is None or state.num_joints != self.joints or not is_near(state.joint_position):
            return None
        return [(self.point(position), self.rotation @ rotation)
                for position, rotation in arm.link_poses(self.chain, state.joint_position)]

    def links(self, latest):
        """The arm's shapes as obstacles for other arms; none before the first arm state."""
        poses = self.link_poses(latest)
        return [link_obstacle(shape, *poses[shape.frame]) for shape in self.shapes] if poses else []

    def target(self, latest):
        """Where the tool shall be, by the newest target or posture; None without either."""
        kinds = [kind for kind in ("TARGET", "JOINT_TARGET") if self.names[kind] in latest]
        if not kinds:
            return None
        newest = max(kinds, key=lambda kind: latest.received_s[self.names[kind]])
        goal = arm.goal_m(self.chain, latest[self.names[newest]])
        return self.point(goal) if goal is not None and is_near(goal) else None

    def state(self, latest):
        """The latest status or None, and kind of message -> s since the latest one of this arm."""
        ages_s = latest.ages_s()
        return (latest.get(self.names["CONTROLLER_STATUS"]),
                {kind: ages_s[name] for kind, name in self.names.items() if name in ages_s})

    def knows_clearance(self, latest):
        return watch.knows_clearance(*self.state(latest))

    def nearest(self, latest, link_poses, obstacles):
        """2 x 3, m: from the link to the obstacle that the controller states to be nearest; None where not drawn."""
        if not self.knows_clearance(latest):
            return None
        status = latest[self.names["CONTROLLER_STATUS"]]
        number = status.nearest_obstacle  # docs/wire.md: -1 is none, -2 the first of `surroundings`
        others = ([obstacle for obstacle in obstacles if obstacle.id == number] if number >= 0 else
                  self.surroundings[-2 - number:][:1] if number <= -2 else [])
        lines = [geometry.nearest_line(shape, link_poses[shape.frame], other) for shape in self.shapes
                 if shape.link == status.nearest_link for other in others]
        return min(lines, key=lambda line: line[0])[1] if lines else None

    def nearest_number(self, latest):
        """The id of the obstacle that the controller states to be nearest; None for another thing."""
        status = latest.get(self.names["CONTROLLER_STATUS"])
        return status.nearest_obstacle if status and status.nearest_obstacle >= 0 else None

    def guide(self, latest):
        status = latest.get(self.names["CONTROLLER_STATUS"])
        guided = status and status.guide_horizon > 0 and is_near(status.guide_tool)
        return [self.point(point) for point in status.guide_tool] if guided else []
