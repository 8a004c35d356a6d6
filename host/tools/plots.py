"""Figures of runs: for each scenario one page per law, and one that compares the laws."""
import math
from typing import NamedTuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np

import solids
from runs import FIGURES, LAWS, config_of, load
from solids import FROM_ABOVE, OBLIQUE, in_world

# The palette of Okabe and Ito, which stays distinguishable with every kind of colour vision.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PINK = ("#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2",
                                                      "#D55E00", "#CC79A7")
OBSTACLES = [RED, PINK, SKY, "#7A6A00", "0.35"]
JOINTS = [BLUE, ORANGE, GREEN, RED, PINK, SKY, BLACK]
LAW_COLOURS = {"paper": ORANGE, "sidestep": BLUE}
LAW_LINES = {"paper": dict(color=ORANGE, linewidth=3), "sidestep": dict(color=BLUE, linewidth=1.6)}
TARGET, GUIDE, CONTACT = GREEN, "#7B3FA0", "#C00000"
GREY = "0.55"
NUMBERS = "Numbers"      # key of the metadata of a picture
FAR_M = 0.5            # upper end of the plots of clearance
HARD_CLEARANCE_M = 0.02  # of a configuration without shield.hard_clearance_m
PAGE = dict(figsize=(15, 8.6), layout="constrained")

plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "axes.titlelocation": "left", "axes.grid": True,
                     "grid.color": "0.9", "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
                     "legend.frameon": False, "legend.fontsize": 8, "savefig.dpi": 150, "lines.linewidth": 1.6})


def obstacle_count(run):
    return len(run.scenario["obstacles"])


def obstacle_colour(number):
    return OBSTACLES[number % len(OBSTACLES)]


def obstacle_name(number):
    """The legend entry, which only the first six obstacles get."""
    return f"obstacle {number + 1}" if number < 6 else None


def section(run, name):
    return (load(config_of(run.scenario)) or {}).get(name) or {}


def length(value_m):
    if value_m < 1e-4:
        return "below 0.1 mm"
    return f"{value_m * 1000:.1f} mm" if value_m < 0.1 else f"{value_m:.3f} m"


def finish(axes, title, legend_columns=3, **settings):
    """Title and legend above the panel, where they cover no curve. legend_columns: 0 for no legend."""
    axes.set(**settings)
    entries = len(axes.get_legend_handles_labels()[0])
    rows = math.ceil(entries / legend_columns) if legend_columns else 0
    if rows:
        axes.legend(ncol=legend_columns, loc="lower left", bbox_to_anchor=(-0.01, 1.0), borderaxespad=0.1,
                    columnspacing=1.2, handlelength=1.6, labelspacing=0.3)
    axes.set_title(title, fontweight="bold", pad=6 + 13 * rows)


# Clearance

class Closest(NamedTuple):
    row: int
    clearance_m: float  # to obstacles, surroundings and other arms
    contact: bool
    words: str          # how much and when
    sentence: str


def clearance(run):
    """m, at every row, to obstacles, surroundings and other arms."""
    return np.minimum(run.columns["clearance_m"], run.columns["neighbour_clearance_m"])


def closest(run):
    """The first contact, else the least clearance; None where there is nothing to touch."""
    values_m, t = clearance(run), run.columns["t_s"]
    if not np.isfinite(values_m).any():
        return None
    touching = np.flatnonzero(values_m < 0)
    row = int(touching[0] if touching.size else np.argmin(values_m))
    if touching.size:
        words = sentence = f"contact at {t[row]:.2f} s"
    else:
        words = f"{values_m[row] * 1000:.1f} mm at {t[row]:.2f} s"
        sentence = f"least clearance {words}"
    return Closest(row, values_m[row], bool(touching.size), words, sentence)


def shown_row(run):
    """The row at which the scene is drawn: the first contact, else where an obstacle or another arm is nearest."""
    moment, t = closest(run), run.columns["t_s"]
    if moment is None or moment.contact:
        return moment.row if moment else len(t) // 2
    of_obstacles = run.family(r"o\d+_clearance_m").min(axis=1) if obstacle_count(run) else np.inf
    nearest_m = np.minimum(of_obstacles, run.columns["neighbour_clearance_m"])
    return int(np.argmin(nearest_m)) if np.isfinite(nearest_m).any() else moment.row


# The scene

class Painter:
    """Draws solids and paths in a view; finish() paints them from far to near."""

    def __init__(self, axes, view):
        self.axes, self.view, self.patches, self.extent = axes, view, [], []

    def solid(self, one, colour, alpha, fits=True, behind=False):
        """behind: below all other solids, whatever its depth."""
        points = solids.surface(one)
        flat = self.view.flat(points)
        depth = float(np.mean(points @ self.view.towards)) - 100 * behind
        for part in solids.visible_parts(one, self.view):
            self.patches.append((depth, solids.outline(self.view.flat(part)), colour, alpha))
        if fits:
            self.extent += [flat.min(axis=0), flat.max(axis=0)]

    def line(self, points, fits=True, **style):
        flat = self.view.flat(points)
        self.axes.plot(*flat.T, **style)
        if fits:
            self.extent += [flat.min(axis=0), flat.max(axis=0)]

    def finish(self):
        for order, (_, hull, colour, alpha) in enumerate(sorted(self.patches, key=lambda patch: patch[0])):
            edge = matplotlib.colors.to_rgb(colour)
            self.axes.add_patch(plt.Polygon(hull, facecolor=(*edge, alpha), edgecolor=tuple(0.6 * c for c in edge),
                                            linewidth=0.7, zorder=2 + order * 1e-3))
        low, high = np.min(self.extent, axis=0) - 0.05, np.max(self.extent, axis=0) + 0.05
        self.axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        self.axes.set_aspect("equal", adjustable="box")


def draw_floor(painter, run):
    """A grid of 0.25 m at the height of the base."""
    centre = solids.base_of(run.scenario)[0]
    for k in np.arange(-1.0, 1.01, 0.25):
        for ends in ([[k, -1, 0], [k, 1, 0]], [[-1, k, 0], [1, k, 0]]):
            painter.line(np.array(ends) + centre * [1, 1, 0], fits=False, color="0.88", linewidth=0.7, zorder=0)


def draw_arm(painter, run, row, colour, alpha, label, behind=False):
    for one in solids.arm_solids(run, row):
        painter.solid(one, colour, alpha, behind=behind)
    painter.axes.plot([], [], color=colour, linewidth=6, alpha=alpha, label=label)


def draw_obstacles(painter, run, row):
    """Each obstacle at a row, with its path until the end of the run and an arrow in its direction."""
    near = run.family(r"o\d+_clearance_m")[row] < 0.6 if obstacle_count(run) else []
    for i, one in enumerate(solids.obstacle_solids(run, row)):
        colour, centres = obstacle_colour(i), in_world(run.scenario, run.path(f"o{i + 1}"))
        painter.solid(one, colour, 0.6, fits=near[i])
        moves = np.linalg.norm(centres[-1] - centres[0]) > 0.02
        if moves:
            painter.line(centres, fits=False, color=colour, linestyle=":", linewidth=1.3)
            start, end = painter.view.flat(centres[[max(row - 30, 0), min(row + 30, len(centres) - 1)]])
            along = (end - start) / max(np.linalg.norm(end - start), 1e-9)
            middle = painter.view.flat(one.position)
            painter.axes.annotate("", middle + along * 0.16, middle, zorder=4, annotation_clip=True,
                                  arrowprops=dict(arrowstyle="-|>", color="0.15", linewidth=1.2))
        painter.axes.plot([], [], color=colour, linewidth=6, alpha=0.6, linestyle="-", label=obstacle_name(i))


def draw_guide(painter, run):
    """The guide of foresight that the arm followed longest, as the path of the tool from where the guide began."""
    points = np.stack([run.path(f"guide{k}") for k in range(1, 9)], axis=1)
    guided = run.columns["foresight"] == 1
    # The end of a guide, unless it is replaced by another one, does not change.
    end_s = run.columns["t_s"] + run.columns["guide_horizon_s"]
    new = guided & np.r_[True, ~guided[:-1] | (np.abs(np.diff(end_s)) > 0.02)]
    rows_of = np.cumsum(new) * guided  # number of the guide at every row, 0 without one
    if guided.any():
        row = int(np.flatnonzero(rows_of == np.argmax(np.bincount(rows_of)[1:]) + 1)[0])
        painter.line(in_world(run.scenario, points[row]), fits=False, color=GUIDE, linewidth=1.5,
                     linestyle=(0, (4, 2)), marker=".", markersize=5, zorder=5,
                     label=f"guide, at {run.columns['t_s'][row]:.2f} s")


def plot_scene(axes, run, view, title, with_legend):
    """The whole scene at shown_row(), with the arm at the start and at the end."""
    moment, painter, colour, row = closest(run), Painter(axes, view), LAW_COLOURS[run.law], shown_row(run)
    if view is OBLIQUE:
        draw_floor(painter, run)
    for number, one in enumerate(solids.surroundings(run)):
        painter.solid(one, "0.75", 0.35, fits=max(one.size) < 2.0, behind=True)
        if number == 0:
            axes.plot([], [], color="0.75", linewidth=6, alpha=0.5, label="surroundings")
    draw_arm(painter, run, 0, "0.85", 0.4, "arm at start", behind=True)
    draw_arm(painter, run, -1, "0.45", 0.4, "arm at end", behind=True)
    draw_arm(painter, run, row, colour, 1.0, f"arm at {run.columns['t_s'][row]:.2f} s")
    for other in run.others:
        draw_arm(painter, other, row, "#B8A070", 0.8, f"the other arm at {run.columns['t_s'][row]:.2f} s")
    if obstacle_count(run):
        draw_obstacles(painter, run, row)
    draw_guide(painter, run)
    painter.line(in_world(run.scenario, run.path("target")), color=TARGET, linestyle="--", linewidth=1.4, zorder=6)
    halo = [matplotlib.patheffects.withStroke(linewidth=3.4, foreground="white")]
    painter.line(in_world(run.scenario, run.path("tool")), color=colour, linewidth=2.2, zorder=6,
                 label="path of the tool", path_effects=halo)
    axes.plot(*view.flat(in_world(run.scenario, run.path("target"))[-1]), color=TARGET, marker="*", markersize=12,
              markeredgecolor="white", linestyle="--", zorder=9, label="target, at the end")
    if moment:
        mark_closest(painter, run, row, moment.contact)
    painter.finish()
    finish_scene(axes, view, title, with_legend)


def finish_scene(axes, view, title, with_legend):
    if view is OBLIQUE:
        axes.set_axis_off()
    finish(axes, title, 3 if with_legend else 0, xlabel="x, m", ylabel="y, m")


def mark_closest(painter, run, row, contact):
    """A cross where the arm touches something, or a ring where an obstacle or another arm is nearest to it."""
    others = solids.obstacle_solids(run, row) + [one for other in run.others for one in solids.arm_solids(other, row)]
    if contact or not others:
        others += solids.surroundings(run)
    on_arm, on_other = painter.view.flat(solids.nearest_pair(solids.arm_solids(run, row), others))
    style = dict(marker="X", color=CONTACT, markersize=16, markeredgecolor="white") if contact else dict(
        marker="o", color="none", markersize=11, markeredgecolor=BLACK, markeredgewidth=1.6)
    painter.axes.plot(*zip(on_arm, on_other), color=BLACK, linewidth=1.2, zorder=8)
    painter.axes.plot(*on_arm, zorder=8, linestyle="none", label="contact" if contact else "nearest obstacle", **style)


# Curves over time

def mark_foresight(axes, run):
    """Light grey: foresight guides the arm. Darker grey: foresight has no path yet (WAITING)."""
    t, foresight = run.columns["t_s"], run.columns["foresight"]
    for value, label, alpha in ((1, "foresight: guided", 0.1), (2, "foresight: no path known", 0.25)):
        if (foresight == value).any():
            axes.fill_between(t, 0, 1, where=foresight == value, transform=axes.get_xaxis_transform(), color=BLACK,
                              alpha=alpha, linewidth=0, label=label)


def plot_target_distance(axes, runs):
    for run in runs:
        distance_m = run.columns["target_distance_m"]
        axes.plot(run.columns["t_s"], distance_m, **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: {length(distance_m[-1])} at the end")
    for run in runs:
        mark_foresight(axes, run)
    finish(axes, "Tool to target", 1, xlabel="time, s", ylabel="distance, m", ylim=(0, None), xlim=(0, None))


def finish_clearance(axes, run, lowest_m, title, legend_columns):
    """Lines at contact and at the hard clearance; what is below contact is shaded."""
    low, high = min(-0.03, 1.15 * lowest_m), min(FAR_M, max(axes.get_ylim()[1], 0.1))
    axes.axhspan(low, 0, color=CONTACT, alpha=0.12, linewidth=0)
    axes.axhline(0, color=CONTACT, linewidth=1.2, label="contact")
    hard_m = section(run, "shield").get("hard_clearance_m", HARD_CLEARANCE_M)
    axes.axhline(hard_m, color=BLACK, linewidth=1, linestyle=(0, (5, 3)), label=f"hard clearance, {hard_m * 1000:g} mm")
    finish(axes, title, legend_columns, xlabel="time, s", ylabel="clearance, m", ylim=(low, high), xlim=(0, None))


def curves_of_clearance(run):
    """(label, colour, m at every row) of each obstacle, of the surroundings and of the other arm."""
    columns, count = run.columns, obstacle_count(run)
    curves = [(obstacle_name(i), obstacle_colour(i), columns[f"o{i + 1}_clearance_m"]) for i in range(count)]
    if solids.surroundings(run):
        least_m = columns["clearance_m"]
        nearer = np.all([least_m < values_m for _, _, values_m in curves], axis=0)
        curves.append(("surroundings, where nearer", "0.5", np.where(nearer, least_m, np.nan)))
    if run.others:
        curves.append(("the other arm", "#8A6D2F", columns["neighbour_clearance_m"]))
    return curves


def plot_clearances(axes, run):
    """Of one run: from surface to surface, for each obstacle."""
    moment = closest(run)
    for label, colour, values_m in curves_of_clearance(run):
        axes.plot(run.columns["t_s"], values_m, color=colour, label=label)
    mark = dict(marker="X", color=CONTACT, markersize=9) if moment.contact else dict(
        marker="o", color="none", markeredgecolor=BLACK, markeredgewidth=1.4, markersize=8)
    axes.plot(run.columns["t_s"][moment.row], moment.clearance_m, linestyle="none", zorder=5, label=moment.sentence,
              **mark)
    finish_clearance(axes, run, float(clearance(run).min()), "Clearance between surfaces", 2)


def plot_both_clearances(axes, runs):
    for run in runs:
        values_m = clearance(run)
        axes.plot(run.columns["t_s"], values_m, **LAW_LINES[run.law], label=f"{LAWS[run.law]}: {closest(run).words}")
    finish_clearance(axes, runs[0], min(float(clearance(run).min()) for run in runs),
                     "Least clearance between surfaces", 2)


def is_papers(run):
    """Whether the paper has published a distance for the scenario."""
    return "axis_distance_m" in (run.scenario.get("published") or {})


def plot_axis_distances(axes, runs):
    """The paper's measure: from the centre of the nearest obstacle to the arm's axis."""
    for run in runs:
        distance_m = run.columns["axis_distance_m"]
        axes.plot(run.columns["t_s"], distance_m, **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: least {distance_m.min():.4f} m")
    published_m = runs[0].scenario["published"]["axis_distance_m"]
    axes.axhline(published_m, color=GREEN, linewidth=1.2, linestyle="-.", label=f"published least: {published_m:.4f} m")
    parameters = section(runs[0], "paper")
    for name, key, style in (("$d_1$", "d_1_m", ":"), ("$d_2$", "d_2_m", "--")):
        if key in parameters:
            axes.axhline(parameters[key], color=GREY, linewidth=1.1, linestyle=style,
                         label=f"{name} of the paper: {parameters[key]:g} m")
    finish(axes, "The paper's measure: obstacle centre to arm axis", 2, xlabel="time, s", ylabel="distance, m",
           xlim=(0, None), ylim=(0, None))


def plot_speeds_of_tool(axes, runs):
    for run in runs:
        speed = np.linalg.norm(np.gradient(run.path("tool"), run.columns["t_s"], axis=0), axis=1)
        axes.plot(run.columns["t_s"], speed, **LAW_LINES[run.law], label=f"tool, {LAWS[run.law]}")
    speed = np.linalg.norm(np.gradient(runs[0].path("target"), runs[0].columns["t_s"], axis=0), axis=1)
    axes.plot(runs[0].columns["t_s"], speed, color=TARGET, linestyle="--", label="target")
    finish(axes, "Speed of tool and target (no obstacles)", xlabel="time, s", ylabel="speed, m/s", xlim=(0, None),
           ylim=(0, None))


def plot_joints(axes, run, pattern, label, title):
    values = run.family(pattern)
    for i in range(values.shape[1]):
        axes.plot(run.columns["t_s"], values[:, i], color=JOINTS[i % len(JOINTS)], linewidth=1.3, label=f"$q_{i + 1}$",
                  linestyle="-" if i < len(JOINTS) else "--")
    finish(axes, title, len(JOINTS), xlabel="time, s", ylabel=label, xlim=(0, None))


def plot_fastest_joint(axes, runs):
    for run in runs:
        fastest = np.abs(run.family(r"qd\d+_radps")).max(axis=1)
        axes.plot(run.columns["t_s"], fastest, **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: largest {fastest.max():.2f} rad/s")
    finish(axes, "Fastest joint", 1, xlabel="time, s", ylabel="speed, rad/s", ylim=(0, None), xlim=(0, None))


def plot_both_paths(axes, runs):
    """From above: the paths of both tools and of the obstacles."""
    painter = Painter(axes, FROM_ABOVE)
    for one in solids.surroundings(runs[0]):
        painter.solid(one, "0.75", 0.35, fits=max(one.size) < 2.0, behind=True)
    for i in range(obstacle_count(runs[0])):
        painter.line(in_world(runs[0].scenario, runs[0].path(f"o{i + 1}")), fits=False, color=obstacle_colour(i),
                     linestyle=":")
    for i, one in enumerate(solids.obstacle_solids(runs[0], 0)):
        painter.solid(one, obstacle_colour(i), 0.4, fits=False)
        axes.plot([], [], color=obstacle_colour(i), linewidth=6, alpha=0.4, label=obstacle_name(i))
    draw_arm(painter, runs[0], 0, "0.85", 0.4, "arm")
    painter.line(in_world(runs[0].scenario, runs[0].path("target")), color=TARGET, linestyle="--")
    for run in runs:
        painter.line(in_world(run.scenario, run.path("tool")), **LAW_LINES[run.law], label=f"tool, {LAWS[run.law]}")
    axes.plot(*in_world(runs[0].scenario, runs[0].path("target"))[-1, :2], color=TARGET, marker="*", markersize=12,
              linestyle="--", label="target, at the end")
    painter.finish()
    finish(axes, "From above: the start, and the paths", xlabel="x, m", ylabel="y, m")


# Pages

def scene_title(run):
    moment = closest(run)
    return LAWS[run.law][0].upper() + LAWS[run.law][1:] + (f": {moment.sentence}" if moment else "")


def page(run, file):
    """Writes one PNG of six panels for one run."""
    figure = plt.figure(**PAGE)
    cells = figure.add_gridspec(2, 3, width_ratios=(1.15, 1, 1))
    figure.suptitle(f"{run.scenario['title']} ({LAWS[run.law]})", fontsize=13, fontweight="bold")
    plot_scene(figure.add_subplot(cells[0, 0]), run, OBLIQUE, "The scene (floor: squares of 0.25 m)", True)
    plot_scene(figure.add_subplot(cells[1, 0]), run, FROM_ABOVE, "From above", False)
    second = figure.add_subplot(cells[0, 1])
    plot_clearances(second, run) if closest(run) else plot_speeds_of_tool(second, [run])
    plot_target_distance(figure.add_subplot(cells[1, 1]), [run])
    plot_joints(figure.add_subplot(cells[0, 2]), run, r"q\d+_rad", "angle, rad", "Joint angles")
    largest = np.abs(run.family(r"qd\d+_radps")).max()
    plot_joints(figure.add_subplot(cells[1, 2]), run, r"qd\d+_radps", "speed, rad/s",
                f"Joint speeds (largest {largest:.2f} rad/s)")
    return save(figure, file)


def numbers(runs):
    """The results printed in comparison(), one line for each law."""
    return [f"{LAWS[run.law]}: {closest(run).sentence if closest(run) else 'no obstacles'}"
            f"{'; links touch each other' if run.touching_itself().any() else ''}; "
            f"{run.columns['axis_distance_m'].min():.4f} m; {length(run.columns['target_distance_m'][-1])} at the end; "
            f"{np.abs(run.joints()[-1]).sum():.3f} rad; {np.abs(run.family(r'qd[0-9]+_radps')).max():.2f} rad/s"
            for run in runs]


def comparison(runs, file):
    """Writes one PNG with both laws: their scenes side by side, and their curves in common panels.

    numbers() are in the file too, so that a picture can be compared without drawing it.
    """
    figure, panels = plt.subplots(2, 3, **PAGE)
    figure.suptitle(f"{runs[0].scenario['title']} (both laws)", fontsize=13, fontweight="bold")
    for axes, run in zip(panels[0], runs):
        plot_scene(axes, run, OBLIQUE, scene_title(run), True)
    (plot_axis_distances if is_papers(runs[0]) else plot_both_paths)(panels[0, 2], runs)
    (plot_both_clearances if closest(runs[0]) else plot_speeds_of_tool)(panels[1, 0], runs)
    plot_target_distance(panels[1, 1], runs)
    plot_fastest_joint(panels[1, 2], runs)
    return save(figure, file, {NUMBERS: "\n".join(numbers(runs))})


def pages(runs):
    """Writes a page for each law of one scenario and a page that compares the laws. Returns the files."""
    written = [page(run, FIGURES / f"{run.name}-{run.law}.png") for run in runs]
    return [*written, comparison(runs, FIGURES / f"{runs[0].name}-both.png")]


def save(figure, file, metadata=None):
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, metadata=metadata)
    plt.close(figure)
    return file
