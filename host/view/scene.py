"""The arm, the obstacles and the paths as messages of Drake's viewer.

The viewer rebuilds the whole scene after a load message; poses are cheap. Hence frequent changes use poses only: a link
has one copy for every colour, an obstacle's velocity is a row of arrowheads, a path is a string of beads, and the parts
that are not shown now have the pose HIDDEN.
"""
import numpy as np

import arm
import geometry
from wire import obstacle_t  # before drake: wire adds the path of the generated types
from drake import lcmt_viewer_draw, lcmt_viewer_geometry_data as part_t, lcmt_viewer_link_data, lcmt_viewer_load_robot

ARM_COLOURS = [(0.85, 0.1, 0.1), (0.95, 0.5, 0.1), (0.9, 0.8, 0.1), (0.2, 0.45, 0.85)]  # small to large clearance
COLOUR_ENDS_M = [0.05, 0.1, 0.2]  # clearance up to which each colour but the last applies
OBSTACLE, SURROUNDING = (0.7, 0.15, 0.65), (0.6, 0.6, 0.6)
TARGET, TRAIL, GUIDE = (0.05, 0.65, 0.3), (0.1, 0.1, 0.1), (1.0, 0.45, 0.0)
ARROW_TIMES_S = [0.15, 0.3, 0.45]
TRAIL_BEADS = 120
GUIDE_BEADS = 8  # length of controller_status_t.guide_tool
HIDDEN = (np.array([0.0, 0.0, -1e4]), np.eye(3))
KINDS = {"sphere": part_t.SPHERE, "cylinder": part_t.CYLINDER, "capsule": part_t.CAPSULE, "box": part_t.BOX}
OBSTACLE_KINDS = {obstacle_t.SPHERE: ("sphere", 1), obstacle_t.CAPSULE: ("capsule", 2), obstacle_t.BOX: ("box", 3),
                  obstacle_t.CYLINDER: ("cylinder", 2)}


def arrowhead(length_m=0.05, radius_m=0.018, sides=12):
    """A cone along z as mesh data of the viewer: counts, corners, triangles."""
    angles = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([radius_m * np.cos(angles), radius_m * np.sin(angles), np.zeros(sides)], axis=1)
    corners = np.concatenate([[[0, 0, length_m], [0, 0, 0]], ring])
    around = [(2 + i, 2 + (i + 1) % sides) for i in range(sides)]
    triangles = [(0, a, b) for a, b in around] + [(1, b, a) for a, b in around]
    return [len(corners), len(triangles), *corners.ravel(), *np.ravel(triangles)]


def part(kind, sizes, colour, position=(0, 0, 0), rotation=np.eye(3)):
    made = part_t()
    made.type, made.color, made.string_data = kind, [*colour, 1.0], ""
    made.position, made.quaternion = list(position), list(arm.quaternion_of(rotation))
    made.num_float_data, made.float_data = len(sizes), list(sizes)
    return made


def beads(name, count, radius_m, colour):
    """Parts for a path of at most `count` points; bead_poses() of the same name gives their poses."""
    return {f"{name}::{i}": [part(part_t.SPHERE, [radius_m], colour)] for i in range(count)}


def bead_poses(name, count, points):
    points = list(points)[-count:]
    return {f"{name}::{i}": (points[i], np.eye(3)) if i < len(points) else HIDDEN for i in range(count)}


def arm_parts(shapes):
    return {f"arm::{i}::{band}": [part(KINDS[shape.kind], shape.size, colour, shape.position, shape.rotation)]
            for i, shape in enumerate(shapes) for band, colour in enumerate(ARM_COLOURS)}


def arm_poses(shapes, link_poses, obstacles):
    """Poses of all copies of all shapes; only the copy whose colour fits the clearance is visible."""
    poses = {}
    for i, shape in enumerate(shapes):
        pose = link_poses[shape.frame]
        visible = np.searchsorted(COLOUR_ENDS_M, geometry.clearance_m(shape, pose, obstacles))
        poses |= {f"arm::{i}::{band}": pose if band == visible else HIDDEN for band in range(len(ARM_COLOURS))}
    return poses


def obstacle_parts(obstacles):
    parts = {}
    for obstacle in obstacles:
        kind, numbers = OBSTACLE_KINDS[obstacle.shape]
        colour = SURROUNDING if obstacle.id < 0 else OBSTACLE
        parts[f"obstacle::{obstacle.id}"] = [part(KINDS[kind], obstacle.size[:numbers], colour)]
        for i in range(len(ARROW_TIMES_S)):
            parts[f"arrow::{obstacle.id}::{i}"] = [part(part_t.MESH, arrowhead(), OBSTACLE)]
    return parts


def obstacle_poses(obstacle):
    """Poses of the obstacle and of the arrowheads: in front of its surface, extrapolated by ARROW_TIMES_S."""
    position, velocity = np.array(obstacle.position), np.array(obstacle.velocity)
    poses = {f"obstacle::{obstacle.id}": (position, arm.rotation_of_quaternion(obstacle.quaternion))}
    speed = np.linalg.norm(velocity)
    for i, ahead_s in enumerate(ARROW_TIMES_S):
        tip = position + velocity * ahead_s + velocity / max(speed, 1e-9) * obstacle.size[0]
        poses[f"arrow::{obstacle.id}::{i}"] = (tip, arm.rotation_from_z(velocity)) if speed > 0.01 else HIDDEN
    return poses


def load_message(parts):
    message = lcmt_viewer_load_robot()
    for name, geometry_data in parts.items():
        link = lcmt_viewer_link_data()
        link.name, link.num_geom, link.geom = name, len(geometry_data), geometry_data
        message.link.append(link)
    message.num_links = len(message.link)
    return message


def draw_message(poses, time_s):
    message = lcmt_viewer_draw()
    message.timestamp, message.num_links = int(time_s * 1000), len(poses)
    message.link_name, message.robot_num = list(poses), [0] * len(poses)
    message.position = [list(position) for position, _ in poses.values()]
    message.quaternion = [list(arm.quaternion_of(rotation)) for _, rotation in poses.values()]
    return message
