"""Where an arm's joints and link shapes are: the chain of a URDF, for drawing."""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import numpy as np

import bus
import runs

ROOT = Path(__file__).resolve().parents[2]
CONFIG = ROOT / "firmware/config/lwa3.yaml"
ROBOT = ("urdf", "base", "tip")


def vector(joint, tag, attribute, default=(0, 0, 0)):
    element = joint.find(tag)
    text = element.get(attribute) if element is not None else None
    return np.array([float(number) for number in text.split()] if text else default, float)


def rotation_about(axis, angle_rad):
    x, y, z = axis / np.linalg.norm(axis)
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle_rad) * skew + (1 - np.cos(angle_rad)) * skew @ skew


def rotation_of(roll, pitch, yaw):
    x, y, z = np.eye(3)
    return rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)


class Shape(NamedTuple):
    """A collision shape at a place in the frame of a link."""
    link: str
    frame: int          # of the link in frames()
    kind: str           # sphere, cylinder, capsule or box
    size: tuple         # m: (radius), (radius, length along z) or the edges
    place: np.ndarray   # 3
    turn: np.ndarray    # 3x3


def path(urdf, base, tip):
    """The joint elements from base to tip, and the link elements by name; or one line and exit code 1."""
    try:
        robot = ElementTree.parse(urdf).getroot()
    except (OSError, ElementTree.ParseError) as error:
        sys.exit(f"{urdf}: {error}")
    parents = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    joints, link = [], tip
    while link != base:
        if link not in parents:
            sys.exit(f"{urdf}: no chain from {base} to {tip}")
        joints.insert(0, parents[link])
        link = parents[link].find("parent").get("link")
    return joints, {link.get("name"): link for link in robot.findall("link")}


def chain(urdf, base, tip):
    """(offset 3, rotation 3x3, axis or None if fixed) of every joint from base to tip."""
    return [(vector(joint, "origin", "xyz"), rotation_of(*vector(joint, "origin", "rpy")),
             vector(joint, "axis", "xyz", (1, 0, 0)) if joint.get("type") in ("revolute", "continuous") else None)
            for joint in path(urdf, base, tip)[0]]


def frames(links, q_rad):
    """(place 3, turn 3x3) in the base frame: of the base, then of every joint's child, and so of the tip."""
    place, turn, angles = np.zeros(3), np.eye(3), iter(q_rad)
    placed = [(place, turn)]
    for offset, rotation, axis in links:
        place = place + turn @ offset
        turn = turn @ rotation @ (np.eye(3) if axis is None else rotation_about(axis, next(angles)))
        placed.append((place, turn))
    return placed


def joint_points(links, q_rad):
    """N x 3: the base, every joint's origin, and so the tip, m, in the base frame."""
    return np.array([place for place, _ in frames(links, q_rad)])


def size_of(geometry):
    kind = geometry[0].tag
    if kind == "box":
        return kind, tuple(map(float, geometry[0].get("size").split()))
    return kind, tuple(float(geometry[0].get(key)) for key in ("radius", "length") if geometry[0].get(key))


def shapes(urdf, base, tip):
    """The collision shapes of the chain's links; rods from joint to joint where all that there is are meshes."""
    joints, links = path(urdf, base, tip)
    found = []
    for frame, name in enumerate([base, *(joint.find("child").get("link") for joint in joints)]):
        for collision in links[name].findall("collision"):
            if collision.find("geometry")[0].tag != "mesh":
                found.append(Shape(name, frame, *size_of(collision.find("geometry")),
                                   vector(collision, "origin", "xyz"), rotation_of(*vector(collision, "origin", "rpy"))))
    return found or [rod(joint.find("parent").get("link"), frame, vector(joint, "origin", "xyz"))
                     for frame, joint in enumerate(joints) if vector(joint, "origin", "xyz").any()]


def rod(link, frame, to, radius_m=0.03):
    return Shape(link, frame, "capsule", (radius_m, float(np.linalg.norm(to))), to / 2, turn_of_z(to))


def turn_of_z(direction):
    """3x3: a rotation that takes z into the direction."""
    z = direction / np.linalg.norm(direction)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def quaternion_of(turn):
    """w x y z of a 3x3 rotation: the eigenvector of its largest eigenvalue (Bar-Itzhack)."""
    (a, b, c), (d, e, f), (g, h, i) = turn
    _, vectors = np.linalg.eigh([[a + e + i, h - f, c - g, d - b], [h - f, a - e - i, b + d, c + g],
                                 [c - g, b + d, e - a - i, f + h], [d - b, c + g, f + h, i - a - e]])
    return vectors[:, -1]


def turn_of(quaternion):
    """3x3 of w x y z; the identity where it is zero, as a sphere's may be."""
    norm = np.linalg.norm(quaternion)
    if norm == 0:
        return np.eye(3)
    w, x, y, z = np.asarray(quaternion) / norm
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def section(config, name):
    """What the configuration says there, which may be nothing; or one line and exit code 1."""
    try:
        said = runs.load(config)
    except runs.RunFailed as error:
        sys.exit(str(error))
    said = said.get(name) or {} if isinstance(said, dict) else said
    if not isinstance(said, dict):
        sys.exit(f"{config}: not a configuration")
    return said


def robot_of(config, arguments):
    """(URDF, base, tip): the configuration's, and over it what the arguments say; or one line and exit code 1."""
    said = section(config, "robot")
    for name in ROBOT:
        if not (getattr(arguments, name) or said.get(name)):
            sys.exit(f"{config}: robot has no {name}, and there is no --{name}")
    return arguments.urdf or ROOT / said["urdf"], arguments.base or said["base"], arguments.tip or said["tip"]


def channels_of(config):
    """Name on the network -> one of bus.TYPES, as the configuration names them."""
    said = section(config, "channels")
    return {said.get(name.lower(), name): name for name in bus.TYPES}


def add_robot(parser):
    for name in ROBOT:
        parser.add_argument(f"--{name}", help="over the configuration's")
