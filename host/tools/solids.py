"""Outlines of the solids of a run, in their real shape and size, seen along parallel lines."""
from typing import NamedTuple

import numpy as np

import arm
from runs import ROOT, config_of, load


class Solid(NamedTuple):
    kind: str             # sphere, capsule, cylinder or box
    size: tuple           # m: (radius), (radius, length along z) or the edges
    position: np.ndarray  # 3, m, world frame
    rotation: np.ndarray  # 3x3


class View:
    """A parallel projection; the camera is at this azimuth and elevation, in degrees."""

    def __init__(self, azimuth, elevation):
        a, e = np.radians([azimuth, elevation])
        self.axes = np.array([[-np.sin(a), np.cos(a), 0],
                              [-np.cos(a) * np.sin(e), -np.sin(a) * np.sin(e), np.cos(e)]])  # right, up
        self.towards = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])

    def flat(self, points):
        """N x 2, m, of N x 3 points."""
        return np.asarray(points) @ self.axes.T


FROM_ABOVE, OBLIQUE = View(-90, 90), View(-58, 24)

AROUND, UP = np.mgrid[0:2 * np.pi:33j, 0:np.pi:17j].reshape(2, -1)
BALL = np.stack([np.cos(AROUND) * np.sin(UP), np.sin(AROUND) * np.sin(UP), np.cos(UP)], axis=1)
CORNERS = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T


def reach_m(solid):
    """How far a solid extends from its middle at most."""
    if solid.kind == "box":
        return float(np.linalg.norm(solid.size)) / 2
    half = solid.size[1] / 2 if len(solid.size) > 1 else 0.0
    return solid.size[0] + half


def may_be_within(one, other, distance_m):
    """False if two solids are farther apart for certain, which is cheaper to find than nearest_points()."""
    return np.linalg.norm(one.position - other.position) - reach_m(one) - reach_m(other) < distance_m


def surface(solid):
    """N x 3, m, world frame: points whose convex hull is the solid."""
    radius = solid.size[0]
    if solid.kind == "box":
        points = CORNERS * solid.size
    elif solid.kind == "sphere":
        points = BALL * radius
    else:
        ring = BALL if solid.kind == "capsule" else BALL[np.abs(BALL[:, 2]) < 1e-9]
        ends = np.array([[[0, 0, -0.5]], [[0, 0, 0.5]]]) * solid.size[1]
        points = np.concatenate(ring * radius + ends)
    return points @ solid.rotation.T + solid.position


def visible_parts(solid, view):
    """Point sets whose outlines show the solid: the faces of a box that the camera sees, else all its points."""
    if solid.kind != "box":
        return [surface(solid)]
    corners = surface(solid)
    return [corners[CORNERS[:, axis] * sign > 0] for axis in range(3) for sign in (-1, 1)
            if sign * (solid.rotation[:, axis] @ view.towards) > 1e-6]


def depth_m(solid, points):
    """Signed distance of N x 3 points to the surface, m; negative inside."""
    local = (points - solid.position) @ solid.rotation
    if solid.kind == "box":
        beyond = np.abs(local) - np.array(solid.size) / 2
        return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
    half = solid.size[1] / 2 if len(solid.size) > 1 else 0.0
    if solid.kind == "cylinder":
        beyond = np.stack([np.linalg.norm(local[:, :2], axis=1) - solid.size[0], np.abs(local[:, 2]) - half], axis=1)
        return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
    local[:, 2] -= np.clip(local[:, 2], -half, half)
    return np.linalg.norm(local, axis=1) - solid.size[0]


def outline(points):
    """The convex hull of N x 2 points, counter-clockwise (Andrew's monotone chain)."""
    points = np.unique(np.round(points, 6), axis=0).tolist()

    def half(ordered):
        hull = []
        for x, y in ordered:
            while len(hull) > 1 and ((hull[-1][0] - hull[-2][0]) * (y - hull[-2][1]) <=
                                     (hull[-1][1] - hull[-2][1]) * (x - hull[-2][0])):
                hull.pop()
            hull.append((x, y))
        return hull[:-1]
    return np.array(half(points) + half(points[::-1]))


def base_of(scenario):
    """Position and rotation of the arm's base in the world frame that several arms share; else the origin."""
    neighbours = (load(config_of(scenario)) or {}).get("neighbours") or {}
    return (np.array(neighbours.get("base_position_m", (0, 0, 0)), float),
            arm.rotation_of_rpy(*neighbours.get("base_rpy_rad", (0, 0, 0))))


def in_world(scenario, points):
    position, rotation = base_of(scenario)
    return np.asarray(points) @ rotation.T + position


def arm_solids(run, row):
    """The links of the run's arm at a row of its record."""
    robot, (base_position, base_rotation) = run.scenario["robot"], base_of(run.scenario)
    source = ROOT / robot["urdf"], robot["base"], robot["tip"]
    poses = arm.link_poses(arm.chain(*source), run.joints()[row])
    found = []
    for shape in arm.shapes(*source):
        position, rotation = poses[shape.frame]
        centre = base_rotation @ (position + rotation @ shape.position) + base_position
        found.append(Solid(shape.kind, shape.size, centre, base_rotation @ rotation @ shape.rotation))
    return found


def shape_of(entry):
    """Kind and size of an entry of `obstacles` or `surroundings`."""
    size = entry.get("edges_m") or [entry[key] for key in ("radius_m", "length_m", "height_m") if key in entry]
    return entry["shape"], tuple(size)


def obstacle_solids(run, row):
    """The obstacles at a row."""
    base_position, base_rotation = base_of(run.scenario)
    found = []
    for i, entry in enumerate(run.scenario["obstacles"], 1):
        position = [run.columns[f"o{i}_{axis}_m"][row] for axis in "xyz"]
        rotation = arm.rotation_of_quaternion([run.columns[f"o{i}_q{part}"][row] for part in "wxyz"])
        found.append(Solid(*shape_of(entry), base_rotation @ position + base_position, base_rotation @ rotation))
    return found


def surroundings(run):
    base_position, base_rotation = base_of(run.scenario)
    found = []
    for entry in (load(config_of(run.scenario)) or {}).get("surroundings") or []:
        rotation = arm.rotation_of_quaternion(entry.get("quaternion", (1, 0, 0, 0)))
        found.append(Solid(*shape_of(entry), base_rotation @ entry["position_m"] + base_position,
                           base_rotation @ rotation))
    return found


def foot(solid, point):
    """The point of the solid's surface that is nearest to a point. A box or cylinder that contains it gives it back."""
    local = solid.rotation.T @ (point - solid.position)
    if solid.kind == "box":
        half = np.array(solid.size) / 2
        return solid.rotation @ np.clip(local, -half, half) + solid.position
    half = solid.size[1] / 2 if len(solid.size) > 1 else 0.0
    axis = np.array([0, 0, np.clip(local[2], -half, half)])
    if solid.kind == "cylinder":
        across = local * [1, 1, 0]
        across *= min(1.0, solid.size[0] / max(np.linalg.norm(across), 1e-9))
        return solid.rotation @ (axis + across) + solid.position
    outward = (local - axis) / max(np.linalg.norm(local - axis), 1e-9)
    return solid.rotation @ (axis + outward * solid.size[0]) + solid.position


def nearest_points(solid, other, steps=30):
    """(m, (point of the solid, point of the other)) of two convex solids, by alternating projection.

    Where they overlap the distance is negative, and the points are near the deepest ones.
    """
    on_solid = foot(solid, other.position)
    for _ in range(steps):
        on_other = foot(other, on_solid)
        on_solid = foot(solid, on_other)
    depth = depth_m(other, on_solid[None])[0]
    return min(depth, np.linalg.norm(on_solid - on_other)), (on_solid, on_other)
