"""Where an arm's joints are: the chain of a URDF, for drawing."""
import xml.etree.ElementTree as ElementTree

import numpy as np


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


def chain(urdf, base, tip):
    """(offset 3, rotation 3x3, axis or None if fixed) of every joint from base to tip."""
    joints = {joint.find("child").get("link"): joint for joint in ElementTree.parse(urdf).getroot().findall("joint")}
    links, link = [], tip
    while link != base:
        if link not in joints:
            raise ValueError(f"{urdf}: no chain from {base} to {tip}")
        joint = joints[link]
        moves = joint.get("type") in ("revolute", "continuous")
        links.insert(0, (vector(joint, "origin", "xyz"), rotation_of(*vector(joint, "origin", "rpy")),
                         vector(joint, "axis", "xyz", (1, 0, 0)) if moves else None))
        link = joint.find("parent").get("link")
    return links


def joint_points(links, q_rad):
    """N x 3: the base, every joint's origin, and so the tip, m, in the base frame."""
    place, turn, points, angles = np.zeros(3), np.eye(3), [np.zeros(3)], iter(q_rad)
    for offset, rotation, axis in links:
        place = place + turn @ offset
        turn = turn @ rotation @ (np.eye(3) if axis is None else rotation_about(axis, next(angles)))
        points.append(place)
    return np.array(points)
