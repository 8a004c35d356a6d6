"""Forward kinematics and collision shapes of a chain of a URDF, for drawing."""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import environment
import numpy as np

import runs
import wire
from errors import reason

CONFIG = runs.ROOT / "firmware/config/lwa3.yaml"
ROBOT = ("urdf", "base", "tip")


def vector(element, tag, attribute, default=(0, 0, 0)):
    child = element.find(tag)
    text = child.get(attribute) if child is not None else None
    return np.array([float(number) for number in text.split()] if text else default, float)


def rotation_about(axis, angle_rad):
    x, y, z = axis / np.linalg.norm(axis)
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle_rad) * skew + (1 - np.cos(angle_rad)) * skew @ skew


def rotation_of_rpy(roll, pitch, yaw):
    x, y, z = np.eye(3)
    return rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)


class Shape(NamedTuple):
    """A collision shape with its pose in the frame of its link."""
    link: str
    frame: int            # index of the link in link_poses()
    kind: str             # sphere, cylinder, capsule or box
    size: tuple           # m: (radius), (radius, length along z) or the edges
    position: np.ndarray  # 3, m
    rotation: np.ndarray  # 3x3


def parse(urdf, base, tip):
    """The joint elements from base to tip, and the link elements by name.

    A wrong URDF ends the script with one line and exit code 1.
    """
    try:
        robot = ElementTree.parse(urdf).getroot()
    except OSError as error:
        sys.exit(reason(error))
    except ElementTree.ParseError as error:
        sys.exit(f"{urdf}: {error}")
    parents = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    joints, link = [], tip
    while link != base:
        if link not in parents:
            sys.exit(f"{urdf}: no chain from {base} to {tip}")
        joints.insert(0, parents[link])
        link = parents[link].find("parent").get("link")
    return joints, {link.get("name"): link for link in robot.findall("link")}


def name(urdf):
    """The robot's name in its URDF; that of the file without one."""
    return ElementTree.parse(urdf).getroot().get("name") or Path(urdf).stem


class Joint(NamedTuple):
    """A joint's frame in the frame of its parent link, and its axis in its own frame."""
    offset: np.ndarray    # 3, m
    rotation: np.ndarray  # 3x3
    axis: np.ndarray      # 3; None if fixed
    prismatic: bool

    def motion(self, q):
        """(translation 3, rotation 3x3) of the child link at this position, rad or m."""
        if self.axis is None:
            return np.zeros(3), np.eye(3)
        if self.prismatic:
            return q * self.axis / np.linalg.norm(self.axis), np.eye(3)
        return np.zeros(3), rotation_about(self.axis, q)


def chain(urdf, base, tip):
    """The Joint of every joint from base to tip."""
    return [Joint(vector(joint, "origin", "xyz"), rotation_of_rpy(*vector(joint, "origin", "rpy")),
                  None if joint.get("type") == "fixed" else vector(joint, "axis", "xyz", (1, 0, 0)),
                  joint.get("type") == "prismatic")
            for joint in parse(urdf, base, tip)[0]]


def limits(urdf, base, tip, settings):
    """(positions, velocities), each joints x 2 with lower and upper: of the section `limits`, else of the URDF."""
    joints = [joint for joint in parse(urdf, base, tip)[0] if joint.get("type") != "fixed"]

    def of(key, attribute, without):
        found = []
        for i, joint in enumerate(joints):
            endless = joint.get("type") == "continuous" and attribute != "velocity"
            of_urdf = without if endless else vector(joint, "limit", attribute, [without])[0]
            given = settings.get(key, of_urdf)
            for_all = of_urdf if joint.get("type") == "prismatic" else given  # one number for all is in rad
            found.append(given[i] if isinstance(given, list) else for_all)
        return np.array(found, float)
    fastest = of("velocity_radps", "velocity", np.nan)
    return (np.stack([of("lower_rad", "lower", -np.inf), of("upper_rad", "upper", np.inf)], axis=1),
            np.stack([-fastest, fastest], axis=1))


def link_poses(links, q_rad):
    """(position 3, rotation 3x3) in the base frame of the base and of every joint's child link; the tip is the last."""
    position, rotation, values = np.zeros(3), np.eye(3), iter(q_rad)
    poses = [(position, rotation)]
    for joint in links:
        translation, turn = joint.motion(0.0 if joint.axis is None else next(values))
        position = position + rotation @ (joint.offset + joint.rotation @ translation)
        rotation = rotation @ joint.rotation @ turn
        poses.append((position, rotation))
    return poses


def goal_m(links, target):
    """Where the tool shall be, base frame, by a target_t or a joint_target_t; None for another number of joints."""
    if hasattr(target, "position"):
        return np.array(target.position)
    if target.num_joints != sum(joint.axis is not None for joint in links):
        return None
    return link_poses(links, target.joint_position)[-1][0]


def size_of(geometry):
    kind = geometry[0].tag
    if kind == "box":
        return kind, tuple(map(float, geometry[0].get("size").split()))
    return kind, tuple(float(geometry[0].get(key)) for key in ("radius", "length") if geometry[0].get(key))


def shapes(urdf, base, tip):
    """The collision shapes of the chain's links. If there are only meshes: a capsule from joint to joint instead."""
    joints, links = parse(urdf, base, tip)
    found = []
    for frame, name in enumerate([base, *(joint.find("child").get("link") for joint in joints)]):
        for collision in links[name].findall("collision"):
            if collision.find("geometry")[0].tag != "mesh":
                found.append(Shape(name, frame, *size_of(collision.find("geometry")),
                                   vector(collision, "origin", "xyz"),
                                   rotation_of_rpy(*vector(collision, "origin", "rpy"))))
    return found or [capsule_to(joint.find("parent").get("link"), frame, vector(joint, "origin", "xyz"))
                     for frame, joint in enumerate(joints) if vector(joint, "origin", "xyz").any()]


def capsule_to(link, frame, end_m, radius_m=0.03):
    """A capsule from the origin of the link to a point in the link's frame."""
    return Shape(link, frame, "capsule", (radius_m, float(np.linalg.norm(end_m))), end_m / 2, rotation_from_z(end_m))


def rotation_from_z(direction):
    """3x3: a rotation that maps the z axis to the direction."""
    z = direction / np.linalg.norm(direction)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def quaternion_of(rotation):
    """w x y z of a 3x3 rotation: the eigenvector of the largest eigenvalue of Bar-Itzhack's matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    _, vectors = np.linalg.eigh([[a + e + i, h - f, c - g, d - b], [h - f, a - e - i, b + d, c + g],
                                 [c - g, b + d, e - a - i, f + h], [d - b, c + g, f + h, i - a - e]])
    return vectors[:, -1]


def rotation_of_quaternion(quaternion):
    """3x3 of w x y z. A zero quaternion, which a sphere may have, gives the identity."""
    norm = np.linalg.norm(quaternion)
    if norm == 0:
        return np.eye(3)
    w, x, y, z = np.asarray(quaternion) / norm
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def section(config, name):
    """A section of the configuration, empty if absent. A wrong file ends the script with one line and exit code 1."""
    try:
        content = runs.load(config)
    except runs.RunFailed as error:
        sys.exit(str(error))
    content = content.get(name) or {} if isinstance(content, dict) else content
    if not isinstance(content, dict):
        sys.exit(f"{config}: not a configuration")
    return content


def robot_of(config, arguments):
    """(URDF, base, tip) of the configuration; arguments override it. A missing one ends the script with exit code 1."""
    robot = section(config, "robot")
    for name in ROBOT:
        if not (getattr(arguments, name) or robot.get(name)):
            sys.exit(f"{config}: robot has no {name}, and there is no --{name}")
    return arguments.urdf or runs.ROOT / robot["urdf"], arguments.base or robot["base"], arguments.tip or robot["tip"]


def add_robot(parser):
    for name in ROBOT:
        parser.add_argument(f"--{name}", help="overrides the configuration")
