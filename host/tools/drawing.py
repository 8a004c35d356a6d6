"""Pictures of a scene: arms, obstacles and paths in their real shape and size, seen along parallel lines."""
import matplotlib
import matplotlib.patheffects
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import outcome
import solids
import words
from labels import Labels
from solids import OBLIQUE, in_world
from style import BLACK, CONTACT, HELD, LAW_COLOURS, MOVING, OTHER_ARM, RESTING, TARGET, plt

SQUARE_M, FLOOR_M = 0.25, 2.5  # edge of a square of the floor, half the edge of the floor
LARGE_M = 2.0     # what is larger may extend beyond the picture
SMALL_M = 0.2     # what is smaller has its name beside it
ARROW_M = 0.16
KINDS = {"moving obstacle": MOVING, "held by the tool": HELD, "at rest": RESTING}  # of obstacles: name -> colour
HALO = [matplotlib.patheffects.withStroke(linewidth=3.4, foreground="white")]


def mixed(colour, share):
    """The colour with white: 1 is the colour itself."""
    return tuple(1 - share * (1 - part) for part in matplotlib.colors.to_rgb(colour))


class Painter:
    """Draws solids and paths in a view; finish() paints them from far to near. legend: label -> handle.

    every_name: all obstacles have their numbers, else only those of which the words above the picture speak.
    """

    def __init__(self, axes, view, every_name=False):
        self.axes, self.view, self.every_name = axes, view, every_name
        self.patches, self.extent, self.legend, self.labels = [], [], {}, Labels()

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
    """The arm at the start, hardly tinted, and at the end as a pale shape."""
    colour = LAW_COLOURS[run.law]
    for depth, row, share, label in ((-300, 0, 0.08, "arm at the start"), (-200, -1, 0.3, "arm at the end")):
        fill = mixed(colour, share)
        painter.silhouette(solids.arm_solids(run, row), mixed(colour, 0.7), fill, depth)
        painter.legend[label] = Patch(facecolor=fill, edgecolor=mixed(colour, 0.7), linewidth=1.5)


def draw_surroundings(painter, run):
    for one in solids.surroundings(run):
        painter.solid(one, RESTING, 0.35, fits=max(one.size) < LARGE_M, behind=True)
        painter.legend["surroundings, in the configuration"] = Patch(facecolor=mixed(RESTING, 0.35), edgecolor="0.4")


def kind_of(run, number, row):
    """The key in KINDS of an obstacle at a row."""
    if number in outcome.held(run, row):
        return "held by the tool"
    return "moving obstacle" if outcome.moves(run, number) else "at rest"


def draw_obstacles(painter, run, row):
    """The obstacles near the arm at a row with their names, and the tracks of those that move."""
    there, text = solids.obstacle_solids(run, row), words.approach(run)
    for parts in outcome.bodies(run):
        first = parts[0]
        centres = in_world(run.scenario, run.path(f"o{first + 1}"))
        if outcome.moves(run, first):
            painter.line(centres, fits=False, color=MOVING, linestyle=(0, (1, 1)), linewidth=2, zorder=1,
                         label="track of an obstacle")
        kind = kind_of(run, first, row)
        if min(run.columns[f"o{i + 1}_clearance_m"][row] for i in parts) > outcome.NEAR_M and "held" not in kind:
            continue
        above_floor = all(solids.surface(there[i])[:, 2].min() > 0 for i in parts)
        for i in parts:
            draw_obstacle(painter, there[i], kind, above_floor)
        if kind == "moving obstacle":
            draw_direction(painter, there[first], centres[max(row - 5, 0)], centres[min(row + 5, len(centres) - 1)])
        name = outcome.obstacle_name(run, first)
        if painter.every_name or kind != "at rest" or name in text:
            draw_name(painter, there[first], name)


def draw_name(painter, one, name):
    """On a large obstacle, beside a small one, which it would hide."""
    if painter.every_name:
        name = name.removeprefix("obstacle ")
    painter.labels.add(painter.view.flat(one.position), name, 0 if max(one.size) > SMALL_M else 16, fontweight="bold",
                       path_effects=HALO, arrowprops=dict(arrowstyle="-", color="0.4", linewidth=0.7))


def draw_obstacle(painter, one, kind, above_floor):
    """The picture is made large enough for it, unless it is large itself."""
    small, colour = max(one.size) < LARGE_M, KINDS[kind]
    if painter.view is OBLIQUE and small and above_floor:
        draw_shadow(painter, one)
    painter.solid(one, colour, 0.6 if kind == "at rest" else 0.75, fits=small)
    painter.legend[kind] = Patch(facecolor=colour, edgecolor="0.3")


def draw_shadow(painter, one):
    """What is straight below a solid on the floor, which shows where it is. What reaches below the floor has none."""
    painter.patch(-1000, solids.surface(one) * [1, 1, 0], True, facecolor="0.9", edgecolor="none")
    painter.legend["below an obstacle, on the floor"] = Patch(facecolor="0.9", edgecolor="none")


def draw_direction(painter, one, before, after):
    """An arrow in the direction in which an obstacle moves at the time."""
    start, end = painter.view.flat([before, after])
    if np.linalg.norm(end - start) > 1e-3:
        middle = painter.view.flat(one.position)
        along = (end - start) / np.linalg.norm(end - start)
        for share in np.linspace(0.4, 1.4, 5):
            painter.labels.keep_free(middle + along * ARROW_M * share, 3)
        painter.axes.annotate("", middle + along * ARROW_M * 1.4, middle + along * ARROW_M * 0.4, zorder=6.5,
                              annotation_clip=True, arrowprops=dict(arrowstyle="-|>", color="0.15", linewidth=1.6))
        painter.legend["direction of motion (not to scale)"] = Line2D([], [], color="0.15", linewidth=1.6, marker=">",
                                                                      markersize=6, markevery=[1])


def mark_contact(painter, pair):
    """A red ring around the place where the arm touches something."""
    ring = dict(marker="o", color="none", markeredgecolor=CONTACT, markeredgewidth=2.5)
    painter.axes.plot(*painter.view.flat(pair[0]), markersize=18, zorder=9, **ring)
    painter.labels.keep_free(painter.view.flat(pair[0]), 11)
    painter.legend["place of contact"] = Line2D([], [], markersize=10, **ring)


def mark_distance(painter, ends):
    line = dict(color=BLACK, linewidth=2, marker=".", markersize=5)
    painter.axes.plot(*zip(*ends), zorder=8, **line)
    painter.legend["shortest distance"] = Line2D([], [], **line)
    for share in np.linspace(0, 1, 5):
        painter.labels.keep_free(ends[0] + share * (ends[1] - ends[0]), 4)


def mark_closest(painter, moment):
    """The place of the moment that is drawn, in words."""
    if not moment or not moment.pair:
        return
    ends = painter.view.flat(moment.pair)
    text = f"{moment.clearance_m * 1000:.1f} mm"
    if moment.contact:
        mark_contact(painter, moment.pair)
        text = "links touch" if moment.name == outcome.LINKS else "first contact"
    else:
        mark_distance(painter, ends)
    painter.labels.add(ends.mean(axis=0), text, 38, color=CONTACT if moment.contact else BLACK, fontweight="bold",
                       bbox=dict(boxstyle="round,pad=0.2", facecolor="white", edgecolor="0.6", alpha=0.9),
                       arrowprops=dict(arrowstyle="-", color=BLACK, linewidth=1))


def draw_scene(painter, run, moment):
    """The scene at the moment that the title names, with the arm at the start and at the end."""
    colour, row = LAW_COLOURS[run.law], outcome.drawn_row(run)
    if painter.view is OBLIQUE:
        draw_floor(painter, run)
        painter.axes.text(0.0, 0.0, f"grid of {SQUARE_M:g} m squares at the height of the base",
                          transform=painter.axes.transAxes, color="0.35", fontsize=9)
        painter.axes.set_axis_off()
    draw_surroundings(painter, run)
    draw_start_and_end(painter, run)
    draw_arm(painter, run, row, colour, 1.0, "arm at the time drawn")
    for other in run.others:
        draw_arm(painter, other, row, OTHER_ARM, 0.75, "the other arm")
    mark_closest(painter, moment)
    if outcome.obstacle_count(run):
        draw_obstacles(painter, run, row)
    target = in_world(run.scenario, run.path("target"))
    painter.line(target, color=TARGET, linestyle="--", linewidth=1.8, zorder=6,
                 label="path of the target" if np.ptp(target, axis=0).max() > 0.01 else None)
    painter.line(in_world(run.scenario, run.path("tool")), color=colour, linewidth=2.2, zorder=6,
                 label="path of the tool", path_effects=HALO)
    painter.line(target[-1:], color=TARGET, marker="*", markersize=13, markeredgecolor="white", linestyle="none",
                 zorder=9, label="target at the end")
    painter.labels.keep_free(painter.view.flat(target[-1]), 8)
    painter.finish()


def same_scale(painters):
    """The same part of the world in several pictures of one view."""
    low, high = zip(*(painter.corners() for painter in painters))
    for painter in painters:
        show(painter.axes, (np.min(low, axis=0), np.max(high, axis=0)))
