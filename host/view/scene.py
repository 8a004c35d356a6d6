"""Arms, obstacles and paths as nodes of a viser scene. A node is made once; then only what changes is sent."""
import numpy as np
import trimesh

import arm
from wire import obstacle_t

BANDS = [(0.05, (217, 26, 26)), (0.1, (242, 128, 26)), (0.2, (230, 204, 26)), (np.inf, (51, 115, 217))]  # up to, m
MOVING, RESTING = (178, 38, 166), (150, 150, 150)  # obstacles; surroundings rest
MOVING_MPS = 0.01     # speed from which on an obstacle counts as moving
UNKNOWN = (95, 95, 105)  # of a link whose clearance nobody knows
TARGET, TRAIL, GUIDE, NEAREST = (13, 166, 76), (40, 40, 40), (0, 190, 190), (122, 72, 20)
CROSS_M = 0.12          # from the target to each end of its cross hair, which an arm at the target does not hide
MOST_NUMBERS = 12       # obstacles; of more of them, only the nearest has its number
ARROW_S = 0.5           # an arrow is the motion in this time
HEAD_M, BARB_M = 0.06, 0.025  # of an arrow's head: its length, and how far its barbs reach from the line
TRANSPARENT = 0.35      # opacity of the collision shapes over visual meshes
OBSTACLE_KINDS = {obstacle_t.SPHERE: "sphere", obstacle_t.CAPSULE: "capsule", obstacle_t.BOX: "box",
                  obstacle_t.CYLINDER: "cylinder"}
MOST_FACES = 800        # of a visual mesh; the Panda's, which have up to 20,000, lose up to 4 mm by it
NO_LINES = np.zeros((0, 2, 3))


def mesh_of(kind, size):
    """The trimesh of a shape; size as in arm.Shape or obstacle_t. Its centre is the origin, its axis is z.

    Without a GPU, a browser needs most of its time for vertices: there are few.
    """
    if kind == "box":
        return trimesh.creation.box(extents=size)
    if kind == "cylinder":
        return trimesh.creation.cylinder(radius=size[0], height=size[1], sections=16)
    length_m = size[1] if kind == "capsule" else 0.0  # a sphere is a capsule without length
    mesh = trimesh.creation.capsule(radius=size[0], height=length_m, count=[8, 12])
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    return mesh


def mesh_of_file(visual):
    mesh = trimesh.load(visual.file, force="mesh")
    mesh.merge_vertices(merge_tex=True, merge_norm=True)  # a fifth of the vertices, so of the page
    if len(mesh.faces) > MOST_FACES:
        mesh = mesh.simplify_quadric_decimation(face_count=MOST_FACES)
    mesh.apply_scale(visual.scale)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = visual.rotation, visual.position
    return mesh.apply_transform(pose)


def segments(points):
    """N-1 x 2 x 3: the lines from point to point."""
    points = np.asarray(points).reshape(-1, 3)
    return np.stack([points[:-1], points[1:]], axis=1) if len(points) > 1 else NO_LINES


def set_lines(handle, lines):
    handle.visible = len(lines) > 0
    if len(lines):
        handle.points = np.asarray(lines, np.float32)


def band_of(clearance_m):
    return next(colour for most_m, colour in BANDS if not clearance_m > most_m)


class ArmNodes:
    """One arm: a frame for every link, with its meshes below it; target, trail and guide."""

    def __init__(self, scene, one):
        self.shapes = one.shapes
        prefix = f"/{one.name or 'arm'}"
        self.frames = [scene.add_frame(f"{prefix}/{i}", show_axes=False, visible=False)
                       for i in range(len(one.chain) + 1)]
        self.visuals = [(visual.frame, add_mesh(scene, f"{prefix}/{visual.frame}/visual{i}", mesh_of_file(visual)))
                        for i, visual in enumerate(one.visuals)]
        self.solids = [self.add_shape(scene, f"{prefix}/{shape.frame}/shape{i}", shape)
                       for i, shape in enumerate(one.shapes)]
        for i, joint in enumerate(one.chain):  # from joint to joint, where no shape covers the link
            if all(shape.frame != i for shape in one.shapes):
                scene.add_line_segments(f"{prefix}/{i}/axis", np.array([[np.zeros(3), joint.offset]]), RESTING,
                                        line_width=2.0)
        self.target = scene.add_icosphere(f"{prefix}/target", 0.03, color=TARGET, visible=False)
        scene.add_line_segments(f"{prefix}/target/cross", CROSS_M * np.stack([-np.eye(3), np.eye(3)], axis=1), TARGET,
                                line_width=4.0)
        self.trail, self.guide, self.nearest = (
            scene.add_line_segments(f"{prefix}/{name}", NO_LINES, colour, line_width=width, visible=False)
            for name, colour, width in (("trail", TRAIL, 3.0), ("guide", GUIDE, 6.0), ("nearest", NEAREST, 3.0)))
        self.number = scene.add_label(f"{prefix}/number", "", anchor="center-center", visible=False)

    def add_shape(self, scene, name, shape):
        handle = add_mesh(scene, name, mesh_of(shape.kind, shape.size), visible=not self.visuals,
                          opacity=TRANSPARENT if self.visuals else None)
        handle.position, handle.wxyz = shape.position, arm.quaternion_of(shape.rotation)
        return handle

    def place(self, link_poses):
        for frame, (position, rotation) in zip(self.frames, link_poses):
            frame.position, frame.wxyz, frame.visible = position, arm.quaternion_of(rotation), True

    def colour(self, clearances_m):
        """clearances_m: of each shape; a visual mesh has the colour of the least clearance of its link.

        None instead of them: unknown.
        """
        if clearances_m is None:
            for handle in (*self.solids, *(visual for _, visual in self.visuals)):
                paint(handle, UNKNOWN)
            return
        for solid, clearance_m in zip(self.solids, clearances_m):
            paint(solid, band_of(clearance_m))
        for frame, visual in self.visuals:
            own_m = [clearance_m for shape, clearance_m in zip(self.shapes, clearances_m) if shape.frame == frame]
            paint(visual, band_of(min(own_m, default=np.inf)))

    def show(self, visuals, shapes):
        """Which of the two layers are visible."""
        for handles, visible in (([handle for _, handle in self.visuals], visuals), (self.solids, shapes)):
            for handle in handles:
                handle.visible = visible

    def mark(self, target, trail, guide, nearest, number):
        """target: 3 or None; trail and guide: points, m; nearest: 2 x 3, m, or None; number: at its end, or None."""
        self.target.visible = target is not None
        if target is not None:
            self.target.position = target
        set_lines(self.trail, segments(trail))
        set_lines(self.guide, segments(guide))
        set_lines(self.nearest, NO_LINES if nearest is None else [nearest])
        self.number.visible = nearest is not None and number is not None
        if self.number.visible:
            self.number.position = nearest[1]
            if self.number.text != str(number):
                self.number.text = str(number)


def add_mesh(scene, name, mesh, colour=UNKNOWN, **options):
    return scene.add_mesh_simple(name, mesh.vertices, mesh.faces, color=colour, **options)


def paint(handle, colour):
    if handle.color != colour:
        handle.color = colour


class ObstacleNodes:
    """The obstacles by their ids, each with an arrow along its velocity."""

    def __init__(self, scene):
        self.scene, self.nodes = scene, {}
        self.turns = {}  # id -> the orientation that was sent; sending it again would cost as much as a position
        self.arrows = scene.add_line_segments("/velocities", NO_LINES, MOVING, line_width=4.0, visible=False)
        self.shows_arrows = True

    def draw(self, obstacles):
        for gone in self.nodes.keys() - {obstacle.id for obstacle in obstacles}:
            self.nodes.pop(gone)[1].remove()
        for obstacle in obstacles:
            handle = self.handle_of(obstacle, numbered=len(obstacles) <= MOST_NUMBERS)
            handle.position = obstacle.position
            paint(handle, MOVING if moves(obstacle) else RESTING)
            turn = tuple(obstacle.quaternion)
            if obstacle.shape != obstacle_t.SPHERE and self.turns.get(obstacle.id) != turn:
                handle.wxyz = self.turns[obstacle.id] = turn
        set_lines(self.arrows, arrows_of([obstacle for obstacle in obstacles if self.shows_arrows and moves(obstacle)]))

    def handle_of(self, obstacle, numbered):
        """The node of the obstacle, with its id as a label; a new one when its shape has changed."""
        form = (obstacle.shape, *obstacle.size)
        if self.nodes.get(obstacle.id, (None,))[0] != form:
            self.turns.pop(obstacle.id, None)
            mesh = mesh_of(OBSTACLE_KINDS[obstacle.shape], obstacle.size)
            name = f"/obstacles/{obstacle.id}"
            self.nodes[obstacle.id] = form, add_mesh(self.scene, name, mesh, RESTING)
            if numbered and obstacle.id >= 0:
                self.scene.add_label(f"{name}/number", str(obstacle.id), anchor="center-center")
        return self.nodes[obstacle.id][1]


def moves(obstacle):
    return np.linalg.norm(obstacle.velocity) > MOVING_MPS


def arrows_of(obstacles):
    """3 N x 2 x 3: an arrow's line and two barbs for each of the obstacles, all of which move.

    It goes from the centre, past the surface of a sphere, to where the obstacle is ARROW_S later.
    """
    start = np.array([obstacle.position for obstacle in obstacles]).reshape(-1, 3)
    velocity = np.array([obstacle.velocity for obstacle in obstacles]).reshape(-1, 3)
    along = velocity / np.linalg.norm(velocity, axis=1, keepdims=True)
    end = start + along * np.array([obstacle.size[0] for obstacle in obstacles])[:, None] + velocity * ARROW_S
    across = np.cross(along, np.where(np.abs(along[:, 2:]) > 0.9, [1, 0, 0], [0, 0, 1]))  # horizontal, if it can be
    barbs = [np.stack([end, end - HEAD_M * along + BARB_M * side], axis=1) for side in (across, -across)]
    return np.concatenate([np.stack([start, end], axis=1), *barbs])
