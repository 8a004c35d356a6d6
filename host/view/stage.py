"""Arms, obstacles and paths of one world on a viser server: what the latest messages say, live or in a recording."""
from collections import deque
from typing import NamedTuple

import numpy as np

import arm
import geometry
import scene

TRAIL_STEP_M = 0.02
JUMP_M = 0.3          # a tool motion between two drawings that only a new run can cause
AMBIENT = 1.2         # light from everywhere, so that no side of a shape is black
CAMERA_M, LOOK_AT_M, FIELD_RAD = (1.1, -1.6, 1.1), (0.1, 0.0, 0.5), 0.75  # from the middle of the arms' bases
CAMERA_TURNS_RAD = np.deg2rad([0, 45, -45, 90, -90, 135, -135, 180])      # of the camera about the vertical, best first
SEEN_M = np.array([(x, y, z) for x in (-0.3, 0.0, 0.3) for y in (-0.3, 0.0, 0.3) for z in (0.1, 0.5, 0.9)])


class Layers(NamedTuple):
    """What is drawn."""
    visuals: bool
    shapes: bool
    arrows: bool = True
    trail: bool = True


def first_layers(arms):
    """The arms by their visual meshes where one has any, else by the controller's shapes."""
    has_visuals = any(one.visuals for one in arms)
    return Layers(has_visuals, not has_visuals)


def camera_m(middle, surroundings):
    """Where the camera stands, from the middle of the arms' bases, so that surroundings hide least of SEEN_M."""
    def hidden(offset):
        along = np.linspace(0.0, 1.0, 60)[:, None, None]
        lines = middle + (offset + along * (SEEN_M - offset)).reshape(-1, 3)
        inside = [(geometry.distance_m(obstacle, lines) <= 0.0).reshape(60, -1) for obstacle in surroundings]
        return np.any(inside, axis=(0, 1)).sum() if inside else 0
    return min((arm.rotation_of_rpy(0.0, 0.0, turn) @ CAMERA_M for turn in CAMERA_TURNS_RAD), key=hidden)


class Stage:
    """arms: arm_view.ArmView each; all have the same obstacles. trail_points: length of a tool's path, TRAIL_STEP_M."""

    def __init__(self, server, arms, trail_points):
        self.arms = arms
        self.trails = [deque(maxlen=trail_points) for _ in arms]
        self.surroundings = [obstacle for one in arms for obstacle in one.surroundings]
        for i, obstacle in enumerate(self.surroundings):
            obstacle.id = -2 - i  # unique among several arms
        middle = np.mean([one.position for one in arms], axis=0)
        server.initial_camera.position = middle + camera_m(middle, self.surroundings)
        server.initial_camera.look_at = middle + LOOK_AT_M
        server.initial_camera.fov = FIELD_RAD
        # Without a GPU, an environment map takes two thirds of the browser's time, and shadows cost most.
        server.scene.configure_environment_map(None)
        server.scene.configure_default_lights(cast_shadow=False)
        server.scene.add_light_ambient("/light", intensity=AMBIENT)
        server.scene.add_grid("/floor", width=4.0, height=4.0, cell_size=0.25, section_size=1.0)
        self.arm_nodes = [scene.ArmNodes(server.scene, one) for one in arms]
        self.obstacle_nodes = scene.ObstacleNodes(server.scene)

    def draw(self, latest, layers, colours):
        """Draws the wire.Messages and returns the tool positions, 3, m, each None before the arm's first state.

        colours: whether the links' colours are computed, which takes longest.
        """
        obstacles = self.arms[0].obstacles(latest) + self.surroundings
        self.obstacle_nodes.shows_arrows = layers.arrows
        self.obstacle_nodes.draw(obstacles)
        return [self.draw_arm(i, latest, layers, obstacles, colours) for i in range(len(self.arms))]

    def draw_arm(self, i, latest, layers, obstacles, colours):
        """Draws one arm and returns its tool position; None before its first arm state."""
        one, nodes, trail = self.arms[i], self.arm_nodes[i], self.trails[i]
        link_poses = one.link_poses(latest)
        if link_poses is None:
            return None
        extend(trail, link_poses[-1][0])
        nodes.place(link_poses)
        nodes.mark(one.target(latest), trail if layers.trail else [], one.guide(latest),
                   one.nearest(latest, link_poses, obstacles),
                   one.nearest_number(latest) if len(obstacles) > scene.MOST_NUMBERS else None)
        nodes.show(layers.visuals, layers.shapes)
        if colours and not one.knows_clearance(latest):
            nodes.colour(None)
        elif colours:
            others = [link for other in self.arms if other is not one for link in other.links(latest)]
            others += one.links_of_others(latest)
            nodes.colour([geometry.clearance_m(shape, link_poses[shape.frame],
                                               one.avoided(latest, shape.frame, obstacles) + others)
                          for shape in one.shapes])
        return link_poses[-1][0]


def extend(trail, tool):
    if trail and np.linalg.norm(tool - trail[-1]) > JUMP_M:
        trail.clear()
    if not trail or np.linalg.norm(tool - trail[-1]) > TRAIL_STEP_M:
        trail.append(tool)
