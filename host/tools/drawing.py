"""Pictures of a scene: arms, obstacles and paths in their real shape and size, seen along parallel lines."""
import matplotlib
import matplotlib.patheffects
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import outcome
import solids
from solids import OBLIQUE, in_world
from style import BLACK, CONTACT, LAW_COLOURS, MOVING, OTHER_ARM, RESTING, TARGET, plt

SQUARE_M, FLOOR_M = 0.25, 2.5  # edge of a square of the floor, half the edge of the floor
NEAR_M = 1.0      # an obstacle within this clearance is in the picture
LARGE_M = 2.0     # what is larger may extend beyond the picture
ARROW_M = 0.16
AT_REST = "at rest"
HALO = [matplotlib.patheffects.withStroke(linewidth=3.4, foreground="white")]


def mixed(colour, share):
    """The colour with white: 1 is the colour itself."""
    return tuple(1 - share * (1 - part) for part in matplotlib.colors.to_rgb(colour))


class Painter:
    """Draws solids and paths in a view; finish() paints them from far to near. legend: label -> handle."""

    def __init__(self, axes, view):
        self.axes, self.view, self.patches, self.extent, self.legend = axes, view, [], [], {}

    def solid(self, one, colour, alpha, fits=True, behind=False):
        """behind: below all other solids, whatever its depth."""
        depth = float(np.mean(solids.surface(one) @ self.view.towards)) - 100 * behind
        edge = tuple(0.6 * part for part in matplotlib.colors.to_rgb(colour))
        for part in solids.visible_parts(one, self.view):
            self.patch(depth, part, fits, facecolor=(*matplotlib.colors.to_rgb(colour), alpha), edgecolor=edge,
                       linewidth=0.7)

    def silhouette(self, several, line, fill, depth):
        """The common outline of solids, below all others; of two silhouettes the one with more depth is above."""
        for one in several:
            for order, width in enumerate((3, 0)):
                self.patch(depth + 0.5 * order, solids.surface(one), True, facecolor=fill, edgecolor=line,
                           linewidth=width)

    def patch(self, depth, points, fits, **style):
        flat = self.view.flat(points)
        self.patches.append((depth, solids.outline(flat), style))
        if fits:
            self.extent += [flat.min(axis=0), flat.max(axis=0)]

    def line(self, points, fits=True, label=None, **style):
        flat = self.view.flat(points)
        self.axes.plot(*flat.T, **style)
        if label:
            self.legend[label] = Line2D([], [], **style)
        if fits:
            self.extent += [flat.min(axis=0), flat.max(axis=0)]

    def finish(self):
        for order, (_, hull, style) in enumerate(sorted(self.patches, key=lambda patch: patch[0])):
            self.axes.add_patch(plt.Polygon(hull, zorder=2 + order * 1e-3, **style))
        show(self.axes, self.corners())

    def corners(self):
        return np.min(self.extent, axis=0) - 0.05, np.max(self.extent, axis=0) + 0.05


def show(axes, corners):
    """Shows at least what is between the corners, m, and as much more as fills the panel."""
    low, high = corners
    shape = axes.bbox.size
    half = shape * np.max((high - low) / shape) / 2
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    axes.set(xlim=(left, right), ylim=(bottom, top))
    axes.set_aspect("equal", adjustable="box")


def draw_floor(painter, run):
    """A grid at the height of the base."""
    centre = solids.base_of(run.scenario)[0]
    for k in np.arange(-FLOOR_M, FLOOR_M + 0.01, SQUARE_M):
        for ends in ([[k, -FLOOR_M, 0], [k, FLOOR_M, 0]], [[-FLOOR_M, k, 0], [FLOOR_M, k, 0]]):
            painter.line(np.array(ends) + centre * [1, 1, 0], fits=False, color="0.88", linewidth=0.7, zorder=0)


def draw_arm(painter, run, row, colour, alpha, label):
    for one in solids.arm_solids(run, row):
        painter.solid(one, colour, alpha)
    painter.legend[label] = Patch(facecolor=colour, edgecolor="0.3", alpha=alpha)


def draw_start_and_end(painter, run):
    """The arm at the start as an outline, and at the end as a pale shape."""
    colour = LAW_COLOURS[run.law]
    for depth, row, share, label in ((-300, 0, 0.0, "arm at the start"), (-200, -1, 0.3, "arm at the end")):
        fill = mixed(colour, share)
        painter.silhouette(solids.arm_solids(run, row), mixed(colour, 0.7), fill, depth)
        painter.legend[label] = Patch(facecolor=fill, edgecolor=mixed(colour, 0.7), linewidth=1.5)


def draw_surroundings(painter, run):
    for one in solids.surroundings(run):
        painter.solid(one, RESTING, 0.35, fits=max(one.size) < LARGE_M, behind=True)
        painter.legend[AT_REST] = Patch(facecolor=RESTING, edgecolor="0.4")


def moves(run, number):
    """Whether an obstacle moves at any time."""
    return bool((np.ptp(run.path(f"o{number + 1}"), axis=0) > 0.005).any())


def draw_obstacles(painter, run, row):
    """The obstacles near the arm at a row with their numbers, and the tracks of those that move."""
    there = solids.obstacle_solids(run, row)
    for parts in outcome.bodies(run):
        first = parts[0]
        centres = in_world(run.scenario, run.path(f"o{first + 1}"))
        if moves(run, first):
            painter.line(centres, fits=False, color=MOVING, linestyle=(0, (1, 1)), linewidth=2, zorder=1,
                         label="track of an obstacle")
        away_m = [run.columns[f"o{i + 1}_clearance_m"][row] for i in parts]
        if min(away_m) > NEAR_M:
            continue
        for i, part_away_m in zip(parts, away_m):
            draw_obstacle(painter, there[i], moves(run, first), part_away_m < NEAR_M)
        if moves(run, first):
            draw_direction(painter, there[first], centres[max(row - 5, 0)], centres[min(row + 5, len(centres) - 1)])
        name = outcome.obstacle_name(run, first).removeprefix("obstacle ")
        painter.axes.text(*painter.view.flat(there[first].position), name, fontweight="bold", ha="center", va="center",
                          zorder=7, path_effects=HALO, clip_on=True)


def draw_obstacle(painter, one, moving, near):
    """near: the picture is made large enough for it, unless it is large itself."""
    small = max(one.size) < LARGE_M
    if painter.view is OBLIQUE and small:
        draw_shadow(painter, one, near)
    painter.solid(one, MOVING if moving else RESTING, 0.75 if moving else 0.6, fits=small and near)
    painter.legend["moving obstacle" if moving else AT_REST] = Patch(facecolor=MOVING if moving else RESTING,
                                                                     edgecolor="0.3" if moving else "0.4")


def draw_shadow(painter, one, fits):
    """What is straight below a solid on the floor, which shows where it is."""
    painter.patch(-1000, solids.surface(one) * [1, 1, 0], fits, facecolor="0.9", edgecolor="none")
    painter.legend["below an obstacle, on the floor"] = Patch(facecolor="0.9", edgecolor="none")


def draw_direction(painter, one, before, after):
    """An arrow in the direction in which an obstacle moves at the time."""
    start, end = painter.view.flat([before, after])
    if np.linalg.norm(end - start) > 1e-3:
        middle = painter.view.flat(one.position)
        along = (end - start) / np.linalg.norm(end - start)
        painter.axes.annotate("", middle + along * ARROW_M * 1.4, middle + along * ARROW_M * 0.4, zorder=6.5,
                              annotation_clip=True, arrowprops=dict(arrowstyle="-|>", color="0.15", linewidth=1.6))


def mark_contact(painter, pair):
    """A red ring around the place where the arm touches something."""
    painter.axes.plot(*painter.view.flat(pair[0]), marker="o", markersize=18, color="none", markeredgecolor=CONTACT,
                      markeredgewidth=2.5, zorder=9)


def mark_closest(painter, moment):
    """The place that the title names, with its distance in words."""
    if not moment or not moment.pair:
        return
    on_arm, on_other = painter.view.flat(moment.pair)
    if moment.contact:
        mark_contact(painter, moment.pair)
    else:
        painter.axes.plot(*zip(on_arm, on_other), color=BLACK, linewidth=2, marker=".", markersize=5, zorder=8)
    low, high = painter.corners()
    place = (on_arm + on_other) / 2
    away = np.where(place > (low + high) / 2, -1, 1)  # toward the middle of the picture, which contains the text
    painter.axes.annotate("first contact" if moment.contact else f"{moment.clearance_m * 1000:.1f} mm", place,
                          away * [46, 34], textcoords="offset points", ha="center", va="center", zorder=10,
                          color=CONTACT if moment.contact else BLACK, fontweight="bold",
                          bbox=dict(boxstyle="round,pad=0.2", facecolor="white", edgecolor="0.6", alpha=0.9),
                          arrowprops=dict(arrowstyle="-", color=BLACK, linewidth=1))


def draw_scene(painter, run, moment):
    """The scene at the moment that the title names, with the arm at the start and at the end."""
    colour, row = LAW_COLOURS[run.law], outcome.drawn_row(run)
    if painter.view is OBLIQUE:
        draw_floor(painter, run)
        painter.axes.text(0.0, 0.0, f"floor squares: {SQUARE_M:g} m", transform=painter.axes.transAxes, color="0.35",
                          fontsize=9)
        painter.axes.set_axis_off()
    draw_surroundings(painter, run)
    draw_start_and_end(painter, run)
    draw_arm(painter, run, row, colour, 1.0, "arm at the time drawn")
    for other in run.others:
        draw_arm(painter, other, row, OTHER_ARM, 0.75, "the other arm")
    if outcome.obstacle_count(run):
        draw_obstacles(painter, run, row)
    target = in_world(run.scenario, run.path("target"))
    painter.line(target, color=TARGET, linestyle="--", linewidth=1.8, zorder=6,
                 label="path of the target" if np.ptp(target, axis=0).max() > 0.01 else None)
    painter.line(in_world(run.scenario, run.path("tool")), color=colour, linewidth=2.2, zorder=6,
                 label="path of the tool", path_effects=HALO)
    painter.line(target[-1:], color=TARGET, marker="*", markersize=13, markeredgecolor="white", linestyle="none",
                 zorder=9, label="target at the end")
    mark_closest(painter, moment)
    painter.finish()


def same_scale(painters):
    """The same part of the world in several pictures of one view."""
    low, high = zip(*(painter.corners() for painter in painters))
    for painter in painters:
        show(painter.axes, (np.min(low, axis=0), np.max(high, axis=0)))
