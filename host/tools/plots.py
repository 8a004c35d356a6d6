"""Figures of runs, one page per scenario and law, in the manner of figures 5 to 7 of the paper."""
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MultipleLocator

import arm
from runs import FIGURES, LAWS, ROOT, config_of, load

# The palette of Okabe and Ito, which stays distinguishable with every kind of colour vision.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PINK = ("#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2",
                                                      "#D55E00", "#CC79A7")
OBSTACLES = [RED, PINK, SKY, "#7A6A00", "0.35"]
JOINTS = [BLUE, ORANGE, GREEN, RED, PINK, SKY, BLACK]
LAW_COLOURS = {"paper": ORANGE, "sidestep": BLUE}
LAW_LINES = {"paper": dict(color=ORANGE, linewidth=3), "sidestep": dict(color=BLUE, linewidth=1.6)}
TARGET = GREEN
GREY = "0.55"
FAR_M = 0.7  # upper end of the plots of obstacle distance

plt.rcParams.update({"font.size": 9, "axes.titlesize": 10, "axes.grid": True, "grid.color": "0.9",
                     "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
                     "legend.frameon": False, "legend.fontsize": 8, "savefig.dpi": 150, "lines.linewidth": 1.6})


def family(columns, pattern):
    """The columns whose names match, N x count, in the order of their numbers."""
    names = sorted((name for name in columns if re.fullmatch(pattern, name)),
                   key=lambda name: int(re.search(r"\d+", name)[0]))
    return np.stack([columns[name] for name in names], axis=1) if names else np.empty((len(columns["t_s"]), 0))


def path(columns, what):
    return np.stack([columns[f"{what}_{axis}_m"] for axis in "xyz"], axis=1)


def obstacle_count(columns):
    return family(columns, r"o\d+_x_m").shape[1]


def obstacle_colour(number):
    return OBSTACLES[number % len(OBSTACLES)]


def obstacle_name(number):
    """The legend entry, which only the first six obstacles get."""
    return f"obstacle {number + 1}" if number < 6 else None


def arm_at(run, row):
    robot = run.scenario["robot"]
    links = arm.chain(ROOT / robot["urdf"], robot["base"], robot["tip"])
    return arm.joint_points(links, family(run.columns, r"q\d+_rad")[row])


def law_parameters(run):
    return (load(config_of(run.scenario)) or {}).get("paper", {})


def draw_sphere(axes, centre, radius_m, colour, alpha):
    around, up = np.mgrid[0:2 * np.pi:17j, 0:np.pi:9j]
    ball = np.stack([np.cos(around) * np.sin(up), np.sin(around) * np.sin(up), np.cos(up)]) * radius_m
    axes.plot_surface(*(ball + centre[:, None, None]), color=colour, alpha=alpha, linewidth=0)


def radius_of(run, number):
    """m, of the sphere that represents the obstacle. For a box: half its shortest edge."""
    obstacle = run.scenario["obstacles"][number]
    return obstacle["radius_m"] if "radius_m" in obstacle else min(obstacle["edges_m"]) / 2


def equal_scale(axes, points):
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, np.maximum((high - low) / 2 * 1.02, 0.35)
    axes.set(**{f"{name}lim": (m - h, m + h) for name, m, h in zip("xyz", middle, half)})
    axes.set_box_aspect(half, zoom=1.08)


def plot_space(axes, run):
    """Paths of tool, target and obstacles, and the arm at the start and at the end."""
    columns, all_points = run.columns, []
    for row, colour, width, name in ((0, GREY, 3, "arm at start"), (-1, BLACK, 3, "arm at end")):
        points = arm_at(run, row)
        all_points.append(points)
        axes.plot(*points.T, color=colour, linewidth=width, marker="o", markersize=4, label=name)
    tool, target = path(columns, "tool"), path(columns, "target")
    axes.plot(*tool.T, color=LAW_COLOURS[run.law], linewidth=2.2, label="tool")
    axes.plot(*target.T, color=TARGET, linestyle="--", label="target")
    axes.scatter(*target[-1], color=TARGET, marker="*", s=70)
    all_points += [tool, target]
    for i in range(obstacle_count(columns)):
        centre, colour = path(columns, f"o{i + 1}"), obstacle_colour(i)
        shown = centre[:max(2, int(np.searchsorted(columns["t_s"], 2.0)))]  # a whole path would leave the picture
        axes.plot(*shown.T, color=colour, linestyle=":", label=obstacle_name(i))
        draw_sphere(axes, centre[0], radius_of(run, i), colour, 0.55)
        if np.linalg.norm(shown[-1] - shown[0]) > 0.02:
            axes.quiver(*shown[-1], *(shown[-1] - shown[0]) / np.linalg.norm(shown[-1] - shown[0]) * 0.08, color=colour,
                        arrow_length_ratio=0.6, linewidth=1.6)
        all_points.append(shown)
    equal_scale(axes, np.concatenate(all_points))
    axes.set(xlabel="x, m", ylabel="y, m", zlabel="z, m",
             title="Paths" + (" (obstacles: at the start, and their first 2 s)" if obstacle_count(columns) else ""))
    axes.tick_params(pad=-1, labelsize=8)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MultipleLocator(0.2))
    axes.view_init(24, -58)
    axes.legend(loc="upper left", bbox_to_anchor=(-0.28, 1.0))


def plot_top(axes, run):
    """The same paths from above, with each obstacle where it is nearest to the arm's axis."""
    columns = run.columns
    tool, target = path(columns, "tool"), path(columns, "target")
    for row, colour in ((0, GREY), (-1, BLACK)):
        axes.plot(*arm_at(run, row)[:, :2].T, color=colour, linewidth=3, marker="o", markersize=4)
    for i in range(obstacle_count(columns)):
        centre, colour = path(columns, f"o{i + 1}"), obstacle_colour(i)
        axes.plot(*centre[:, :2].T, color=colour, linestyle=":")
        nearest = int(np.argmin(columns[f"o{i + 1}_axis_distance_m"]))
        axes.add_patch(plt.Circle(centre[nearest, :2], radius_of(run, i), color=colour, alpha=0.55, linewidth=0))
        axes.annotate(f"{columns['t_s'][nearest]:.2f} s", centre[nearest, :2], textcoords="offset points",
                      xytext=(9, 7), color=colour, fontsize=8)
    axes.plot(*tool[:, :2].T, color=LAW_COLOURS[run.law], linewidth=2.2)
    axes.plot(*target[:, :2].T, color=TARGET, linestyle="--")
    axes.plot(*target[-1, :2], color=TARGET, marker="*", markersize=10)
    points = np.concatenate([tool, target, arm_at(run, 0), arm_at(run, -1)])[:, :2]
    low, high = points.min(axis=0) - 0.15, points.max(axis=0) + 0.15
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x, m", ylabel="y, m")
    axes.set_aspect("equal", adjustable="box")
    axes.set_title("From above" + (" (each obstacle where it is nearest)" if obstacle_count(columns) else ""))


def mark_foresight(axes, run):
    """Light grey: foresight guides the arm. Darker grey: foresight has no path yet (WAITING)."""
    t, foresight = run.columns["t_s"], run.columns["foresight"]
    for value, label, alpha in ((1, "foresight: guided", 0.12), (2, "foresight: no path known", 0.3)):
        if (foresight == value).any():
            axes.fill_between(t, 0, 1, where=foresight == value, transform=axes.get_xaxis_transform(), color=BLACK,
                              alpha=alpha, linewidth=0, label=label)


def plot_target_distance(axes, runs):
    for run in runs:
        mark_foresight(axes, run)
        distance_m = run.columns["target_distance_m"]
        axes.plot(run.columns["t_s"], distance_m, **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: {length(distance_m[-1])} at the end")
    axes.set(xlabel="time, s", ylabel="distance, m", title="Tool to target", ylim=(0, None), xlim=(0, None))
    axes.legend()


def length(value_m):
    if value_m < 1e-4:
        return "below 0.1 mm"
    return f"{value_m * 1000:.1f} mm" if value_m < 0.1 else f"{value_m:.3f} m"


def plot_obstacle_distances(axes, run):
    """Distance from obstacle centre to arm axis, as in the paper's figures."""
    columns, t = run.columns, run.columns["t_s"]
    for i in range(obstacle_count(columns)):
        axes.plot(t, columns[f"o{i + 1}_axis_distance_m"], color=obstacle_colour(i), label=obstacle_name(i))
    least = int(np.argmin(columns["axis_distance_m"]))
    axes.plot(t[least], columns["axis_distance_m"][least], "o", color=BLACK, markersize=5, zorder=5,
              label=f"least: {columns['axis_distance_m'][least]:.4f} m")
    mark_radii(axes, run)
    axes.set(xlabel="time, s", ylabel="distance, m", title="Obstacle centre to arm axis", xlim=(0, None))
    cut_at_far(axes)


def cut_at_far(axes):
    """Cuts the plot at FAR_M and puts the legend above it, where it covers no curve."""
    axes.set_ylim(0, min(axes.get_ylim()[1], FAR_M))
    axes.set_title(axes.get_title(), pad=34)
    axes.legend(ncol=3 if len(axes.get_legend_handles_labels()[0]) > 4 else 2, loc="lower center",
                bbox_to_anchor=(0.5, 1.0))


def mark_radii(axes, run):
    parameters, published = law_parameters(run), run.scenario.get("published") or {}
    for name, key in (("$d_1$", "d_1_m"), ("$d_2$", "d_2_m")):
        if key in parameters:
            axes.axhline(parameters[key], color=GREY, linewidth=1, linestyle="--")
            axes.annotate(f"{name} = {parameters[key]:g} m", (1, parameters[key]), xycoords=("axes fraction", "data"),
                          ha="right", va="bottom", color="0.35", fontsize=8,
                          bbox=dict(facecolor="white", edgecolor="none", alpha=0.7, pad=0.5))
    if "axis_distance_m" in published:
        axes.axhline(published["axis_distance_m"], color=GREEN, linewidth=1.2, linestyle="-.",
                     label=f"published least: {published['axis_distance_m']:.4f} m")


def plot_speeds_of_tool(axes, run):
    t = run.columns["t_s"]
    for what, colour, style in (("tool", LAW_COLOURS[run.law], "-"), ("target", TARGET, "--")):
        speed = np.linalg.norm(np.gradient(path(run.columns, what), t, axis=0), axis=1)
        axes.plot(t, speed, color=colour, linestyle=style, label=what)
    axes.set(xlabel="time, s", ylabel="speed, m/s", title="Tool and target speed (no obstacles)", xlim=(0, None))
    axes.legend()


def plot_joints(axes, run, pattern, label, title):
    values = family(run.columns, pattern)
    for i in range(values.shape[1]):
        axes.plot(run.columns["t_s"], values[:, i], color=JOINTS[i % len(JOINTS)], linewidth=1.3, label=f"$q_{i + 1}$",
                  linestyle="-" if i < len(JOINTS) else "--")
    axes.set(xlabel="time, s", ylabel=label, title=title, xlim=(0, None))
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top + (top - bottom) * 0.14)
    axes.legend(ncol=min(values.shape[1], len(JOINTS)), loc="upper center", columnspacing=0.9, handlelength=1.3)
    return values


def page(run, file):
    """Writes one PNG of six panels for one run."""
    figure = plt.figure(figsize=(15, 8.6), layout="constrained")
    cells = figure.add_gridspec(2, 3, width_ratios=(1.15, 1, 1))
    figure.suptitle(f"{run.scenario['title']} ({LAWS[run.law]})", fontsize=13, fontweight="bold")
    plot_space(figure.add_subplot(cells[0, 0], projection="3d"), run)
    plot_target_distance(figure.add_subplot(cells[0, 1]), [run])
    third = figure.add_subplot(cells[0, 2])
    plot_obstacle_distances(third, run) if obstacle_count(run.columns) else plot_speeds_of_tool(third, run)
    plot_top(figure.add_subplot(cells[1, 0]), run)
    plot_joints(figure.add_subplot(cells[1, 1]), run, r"q\d+_rad", "angle, rad", "Joint angles")
    speeds = figure.add_subplot(cells[1, 2])
    values = plot_joints(speeds, run, r"qd\d+_radps", "speed, rad/s", "")
    speeds.set_title(f"Joint speeds (largest {np.abs(values).max():.2f} rad/s)")
    return save(figure, file)


def plot_least_distance(axes, runs):
    for run in runs:
        distance_m = run.columns["axis_distance_m"]
        axes.plot(run.columns["t_s"], distance_m, **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: least {distance_m.min():.4f} m")
    mark_radii(axes, runs[0])
    axes.set(xlabel="time, s", ylabel="distance, m", title="Nearest obstacle centre to arm axis", xlim=(0, None))
    cut_at_far(axes)


def plot_fastest_joint(axes, runs):
    for run in runs:
        fastest = np.abs(family(run.columns, r"qd\d+_radps")).max(axis=1)
        axes.plot(run.columns["t_s"], fastest, **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: largest {fastest.max():.2f} rad/s")
    axes.set(xlabel="time, s", ylabel="speed, rad/s", title="Fastest joint", ylim=(0, None), xlim=(0, None))
    axes.legend()


def plot_both_paths(axes, runs):
    columns = runs[0].columns
    for i in range(obstacle_count(columns)):
        axes.plot(*path(columns, f"o{i + 1}")[:, :2].T, color=obstacle_colour(i), linestyle=":",
                  label=obstacle_name(i))
    axes.plot(*path(columns, "target")[:, :2].T, color=TARGET, linestyle="--", label="target")
    axes.plot(*path(columns, "target")[-1, :2], color=TARGET, marker="*", markersize=10)
    for run in runs:
        axes.plot(*path(run.columns, "tool")[:, :2].T, **LAW_LINES[run.law], label=LAWS[run.law])
    points = np.concatenate([path(run.columns, what)[:, :2] for run in runs for what in ("tool", "target")])
    low, high = points.min(axis=0) - 0.1, points.max(axis=0) + 0.1
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x, m", ylabel="y, m")
    axes.set_title("Tool paths from above")
    axes.set_aspect("equal", adjustable="box")
    axes.legend()


def comparison(runs, file):
    """Writes one PNG with the curves of both laws in common panels."""
    figure, panels = plt.subplots(2, 2, figsize=(11, 8), layout="constrained")
    figure.suptitle(f"{runs[0].scenario['title']} (both laws)", fontsize=13, fontweight="bold")
    plot_both_paths(panels[0, 0], runs)
    plot_target_distance(panels[0, 1], runs)
    if obstacle_count(runs[0].columns):
        plot_least_distance(panels[1, 0], runs)
    else:
        panels[1, 0].set_axis_off()
        panels[1, 0].text(0.5, 0.5, "no obstacles", ha="center", color=GREY)
    plot_fastest_joint(panels[1, 1], runs)
    return save(figure, file)


def pages(runs):
    """Writes a page for each law of one scenario and a page that compares the laws. Returns the files."""
    written = [page(run, FIGURES / f"{run.name}-{run.law}.png") for run in runs]
    return [*written, comparison(runs, FIGURES / f"{runs[0].name}-both.png")]


def save(figure, file):
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)
    plt.close(figure)
    return file
