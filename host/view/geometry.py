"""Surface distances from link shapes to obstacles, sampled: accurate enough to colour a drawing, not for control."""
import numpy as np

import arm
from wire import obstacle_t

SAMPLES = 7  # points along the axis of a link's shape


def axis_points(shape):
    """(points N x 3 in the link's frame, radius m) of the capsule that approximates the shape."""
    if shape.kind == "box":
        return shape.position[None], min(shape.size) / 2
    length_m = shape.size[1] if len(shape.size) > 1 else 0.0
    along_m = np.linspace(-length_m / 2, length_m / 2, SAMPLES)[:, None]
    return shape.position + along_m * shape.rotation[:, 2], shape.size[0]


def distance_m(obstacle, points):
    """From each of the points (N x 3, base frame) to the obstacle's surface, m; negative inside a sphere or capsule."""
    local = (points - np.array(obstacle.position)) @ arm.rotation_of_quaternion(obstacle.quaternion)
    if obstacle.shape == obstacle_t.BOX:
        return np.linalg.norm(np.maximum(np.abs(local) - np.array(obstacle.size) / 2, 0.0), axis=1)
    if obstacle.shape == obstacle_t.CYLINDER:
        across_m = np.maximum(np.linalg.norm(local[:, :2], axis=1) - obstacle.size[0], 0.0)
        return np.hypot(across_m, np.maximum(np.abs(local[:, 2]) - obstacle.size[1] / 2, 0.0))
    half_m = obstacle.size[1] / 2 if obstacle.shape == obstacle_t.CAPSULE else 0.0
    local[:, 2] -= np.clip(local[:, 2], -half_m, half_m)
    return np.linalg.norm(local, axis=1) - obstacle.size[0]


def nearest_line(shape, link_pose, obstacle):
    """(distance m, 2 x 3): between a link's axis and the nearest point of the obstacle or of its axis, and these."""
    position, rotation = link_pose
    points = axis_points(shape)[0] @ rotation.T + position
    turn = arm.rotation_of_quaternion(obstacle.quaternion)
    local = (points - np.array(obstacle.position)) @ turn
    inside = np.array({obstacle_t.BOX: np.array(obstacle.size) / 2, obstacle_t.SPHERE: [0, 0, 0]}.get(
        obstacle.shape, [0, 0, obstacle.size[1] / 2]))
    other = np.clip(local, -inside, inside) @ turn.T + np.array(obstacle.position)
    lengths_m = np.linalg.norm(points - other, axis=1)
    nearest = np.argmin(lengths_m)
    return lengths_m[nearest], np.stack([points[nearest], other[nearest]])


def clearance_m(shape, link_pose, obstacles):
    """From a link's shape to the nearest obstacle, m; infinity without obstacles. link_pose: position, rotation."""
    position, rotation = link_pose
    points, radius_m = axis_points(shape)
    points = points @ rotation.T + position
    return min((distance_m(obstacle, points).min() for obstacle in obstacles), default=np.inf) - radius_m
