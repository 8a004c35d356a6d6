"""Figures of runs: for each scenario one page per law, and one that compares the laws."""
import numpy as np
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D

import drawing
import outcome
import solids
import words
from labels import Labels
from outcome import closest, clearance
from runs import FIGURES, LAWS, config_of, load
from solids import FROM_ABOVE, OBLIQUE
from style import BLACK, CONTACT, GREEN, GREY, JOINTS, LAW_LINES, MOVING, OTHER_ARM, TARGET, finish, plt, save
from words import length

NUMBERS = "Numbers"      # key of the metadata of a picture
FAR_M = 0.3              # upper end of the plots of clearance
MOST_NAMES = 4           # at curves of clearance to what rests
HARD_CLEARANCE_M, REST_CLEARANCE_M = 0.02, 0.004  # of a configuration without the keys in shield:
CONTACT_TEXT = (0.82, 0.88, 0.94)  # of the width of a panel: where "contact: overlap" stands
STYLES = ["-", "--", "-.", ":"]  # of the curves of one colour
HEADROOM = 1.15          # above the largest value, for the names of events
LEAST_DISTANCE_M = 1e-3  # lower end of the plots of the distance to the target
JUMP_M = 0.05            # in one period of a target


def section(run, name):
    return (load(config_of(run.scenario)) or {}).get(name) or {}


# Curves over time

# Value of the column -> (name, look)
FORESIGHT = {1: ("Sidestep follows a path that foresight has planned", dict(facecolor="0.93", edgecolor="none")),
             2: ("Sidestep waits or makes room: foresight knows no path yet", dict(facecolor="0.78", edgecolor="none"))}


def stretches(wanted):
    """[(first row, row after the last)] of every stretch of true values."""
    edges = np.flatnonzero(np.diff(np.r_[False, wanted, False]))
    return list(zip(edges[::2], edges[1::2]))


def mark_foresight(axes, run):
    t = run.columns["t_s"]
    for value, (name, look) in FORESIGHT.items():
        for i, (first, end) in enumerate(stretches(run.columns["foresight"] == value)):
            axes.axvspan(t[first], t[min(end, len(t) - 1)], linewidth=0, zorder=0.5, **look,
                         label=None if i else name)


def write(axes, t_s, name, **style):
    """A text at a time, at the upper end of a panel."""
    axes.text(t_s, 0.98, name, transform=axes.get_xaxis_transform(), va="top", fontsize=8.5, color="0.25", zorder=4,
              bbox=dict(boxstyle="square,pad=0.1", facecolor="white", edgecolor="none", alpha=0.75), **style)


def events(run):
    """[(s, name)]: the tool grasps and releases something, the target jumps."""
    found, held = [], set()
    for step in run.scenario.get("grasp", []):
        now = set(step.get("held", []))
        found += [(step["at_s"], "grasps")] if now - held else [(step["at_s"], "releases")] if held - now else []
        held = now
    jumps = np.linalg.norm(np.diff(run.path("target"), axis=0), axis=1) > JUMP_M
    return found + [(run.columns["t_s"][row + 1], "target jumps") for row in np.flatnonzero(jumps)]


def mark_events(axes, run, label=None):
    """label: of the lines, in the legend."""
    for i, (t_s, name) in enumerate(events(run)):
        axes.axvline(t_s, color="0.3", linewidth=1, linestyle=":", label=None if i else label)
        write(axes, t_s, name, ha="center")


def mark_changes(axes, run):
    """Where the clearance jumps: what the tool may touch, as a can and what it stands on, does not count."""
    label = "from here on the tool may touch other things: the curve jumps"
    mark_events(axes, run, label if outcome.grasped(run) else None)


def plot_target_distance(axes, runs):
    """On a logarithmic scale, on which the distance of arrival can be seen."""
    highest_m = max(run.columns["target_distance_m"].max() for run in runs)
    axes.axhspan(LEAST_DISTANCE_M / 2, outcome.ARRIVED_M, color=TARGET, alpha=0.12, linewidth=0)
    for run in runs:
        distance_m = run.columns["target_distance_m"]
        axes.plot(run.columns["t_s"], np.maximum(distance_m, LEAST_DISTANCE_M), **LAW_LINES[run.law],
                  label=f"{LAWS[run.law]}: {length(distance_m[-1])} at the end")
        mark_foresight(axes, run)
    mark_events(axes, runs[0])
    axes.set_yscale("log")
    axes.set_yticks([0.001, 0.01, 0.1, 1], ["up to\n1 mm", "10 mm", "100 mm", "1 m"])
    finish(axes, f"Tool to target (green: arrived, below {outcome.ARRIVED_M * 1000:g} mm)", 1, xlabel="time, s",
           xlim=(0, None), ylim=(0.7 * LEAST_DISTANCE_M, 2.5 * highest_m))


def mark_limits(axes, run, resting):
    """The clearances that the shield keeps: to what moves, and, if there is something at rest, a band down to that.

    Nothing for the paper's law, which has no shield.
    """
    if run.law == "paper":
        return
    hard_m, rest_m = (section(run, "shield").get(key, default_m) for key, default_m in (
        ("hard_clearance_m", HARD_CLEARANCE_M), ("rest_clearance_m", REST_CLEARANCE_M)))
    axes.axhline(hard_m, color=BLACK, linewidth=1, linestyle=(0, (5, 3)),
                 label=f"Sidestep keeps {hard_m * 1000:g} mm to what moves\n"
                       f"(at {outcome.SLOW_MPS:g} m/s or faster) or is uncertain")
    if resting and rest_m < hard_m:
        axes.axhspan(rest_m, hard_m, color=BLACK, alpha=0.18, linewidth=0,
                     label=f"nearer only to what is slower; to what rests {rest_m * 1000:g} mm")


def finish_clearance(axes, run, lowest_m, title, legend_columns, resting=True):
    """Contact, below which it is shaded, and the clearances that the shield keeps.

    resting: whether the arm may pass something at the smaller of these clearances.
    """
    highest_m = axes.get_ylim()[1]
    low, high = min(-0.03, 1.15 * lowest_m), min(FAR_M, max(HEADROOM * highest_m, 0.1))
    axes.axhspan(low, 0, color=CONTACT, alpha=0.12, linewidth=0)
    axes.axhline(0, color=CONTACT, linewidth=1.2)
    axes.text(0.995, low / 2, "contact: overlap", transform=axes.get_yaxis_transform(), ha="right", va="center",
              fontsize=8.5, color=CONTACT)
    mark_limits(axes, run, resting)
    axes.yaxis.set_major_formatter(lambda value, _position: f"{value * 1000:g}")
    finish(axes, title, legend_columns, xlabel="time, s",
           ylabel=f"clearance, mm{f' (cut at {FAR_M * 1000:g})' if highest_m > FAR_M else ''}", ylim=(low, high),
           xlim=(0, None))


def curves_of_clearance(run):
    """(label, text at the curve, colour, m at every row) of every obstacle or person, the surroundings, the other arm.

    The recorded clearance to what the tool grasps has the allowed touch in it. As that to the surroundings it is drawn
    only where no other explains the least clearance.
    """
    columns, curves, least_m = run.columns, [], run.columns["clearance_m"]
    for parts in outcome.bodies(run):
        label, colour = ("moving obstacle", MOVING) if outcome.moves(run, parts[0]) else ("obstacle at rest", GREY)
        name = outcome.obstacle_name(run, parts[0]).removeprefix("obstacle ")
        values_m = np.min([columns[f"o{i + 1}_clearance_m"] for i in parts], axis=0)
        if parts[0] not in outcome.grasped(run):
            curves.append((label, name, colour, values_m))
    rest = ["surroundings"] * bool(solids.surroundings(run)) + ["what it grasps"] * bool(outcome.grasped(run))
    if rest:
        nearer = np.all([least_m < values_m for *_, values_m in curves], axis=0)
        curves.append((f"{' or '.join(rest)}, where nearest", "", BLACK, np.where(nearer, least_m, np.nan)))
    if run.others:
        curves.append((outcome.OTHER_ARM, "", OTHER_ARM, columns["neighbour_clearance_m"]))
    return curves


def plot_clearances(axes, run):
    """Of one run: from surface to surface, for each obstacle. What moves or comes nearest has its name there."""
    t, moment, known, names, far = run.columns["t_s"], closest(run), {}, Labels(), []
    curves = curves_of_clearance(run)
    nearest_m = sorted(np.min(values_m, where=np.isfinite(values_m), initial=FAR_M) for *_, values_m in curves)
    for label, text, colour, values_m in curves:
        row = int(np.nanargmin(values_m)) if np.isfinite(values_m).any() else 0
        if not values_m[row] < FAR_M:
            far += [text] * bool(text)
            continue
        known[label] = known.get(label, 0) + 1
        axes.plot(t, values_m, color=colour, linestyle=STYLES[(known[label] - 1) % len(STYLES)],
                  label=": ".join(filter(None, (label, text))) if known[label] <= len(STYLES) else None)
        if values_m[row] < 0.9 * FAR_M and (values_m[row] in nearest_m[:MOST_NAMES] or colour == MOVING):
            names.add((t[row], values_m[row]), text, 1, fontweight="bold", path_effects=drawing.HALO,
                      arrowprops=dict(arrowstyle="-", color="0.4", linewidth=0.7))
    if far:
        axes.plot([], [], " ", label=f"always farther away: {', '.join(far[:MOST_NAMES])}" +
                  ", ..." * (len(far) > MOST_NAMES))
    mark_moment(axes, run, moment)
    mark_touching_links(axes, run)
    mark_changes(axes, run)
    finish_clearance(axes, run, float(clearance(run).min()), title_of_clearance(run), 1, outcome.has_resting(run))
    for share in CONTACT_TEXT:
        names.keep_free((share * axes.get_xlim()[1], axes.get_ylim()[0] / 2), 10)
    names.place(axes)


def mark_moment(axes, run, moment):
    style = dict(marker="o", color="none", markeredgecolor=CONTACT if moment.contact else BLACK, markeredgewidth=1.6,
                 markersize=9)
    height_m = clearance(run)[moment.row] if moment.name == outcome.LINKS else moment.clearance_m
    axes.plot(run.columns["t_s"][moment.row], min(height_m, FAR_M), linestyle="none", zorder=5, clip_on=False,
              label="time drawn in the picture", **style)


def mark_touching_links(axes, run):
    """Red over the curve while links touch each other, which no curve shows: clearances are to other things."""
    own, values_m = run.touching_itself(), np.minimum(clearance(run), FAR_M)
    if own.any():
        axes.plot(run.columns["t_s"], np.where(own, values_m, np.nan), color=CONTACT, linewidth=9, alpha=0.4,
                  solid_capstyle="round", zorder=1.5, label=f"links touch each other ({LAWS[run.law]})")


def title_of_clearance(run):
    return "Least clearance to " + ("what the arm may not touch" if outcome.grasped(run) else "obstacles")


def plot_both_clearances(axes, runs):
    for run in runs:
        values_m = clearance(run)
        least_mm = values_m.min() * 1000
        axes.plot(run.columns["t_s"], values_m, **LAW_LINES[run.law], label=f"{LAWS[run.law]}: " + (
            f"least {least_mm:.1f} mm" if least_mm >= 0 else f"deepest overlap {-least_mm:.1f} mm"))
        mark_touching_links(axes, run)
    mark_changes(axes, runs[0])
    finish_clearance(axes, runs[-1], min(float(clearance(run).min()) for run in runs),
                     title_of_clearance(runs[0]), 1, outcome.has_resting(runs[0]))


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
    axes.axhline(published_m, color=GREEN, linewidth=1.2, linestyle="-.",
                 label=f"published least: {published_m:.4f} m\n(with unpublished gains and tool)")
    parameters = section(runs[0], "paper")
    for name, key, style in (("$d_1$", "d_1_m", ":"), ("$d_2$", "d_2_m", "--")):
        if key in parameters:
            axes.axhline(parameters[key], color=GREY, linewidth=1.1, linestyle=style,
                         label=f"{name} of the paper: {parameters[key]:g} m")
    finish(axes, "Obstacle centre to arm axis (paper)", 1, xlabel="time, s", ylabel="distance, m", xlim=(0, None),
           ylim=(0, None))


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


# Pages

class Sheet:
    """A page of panels at fixed places, in inches from the upper left corner."""

    def __init__(self, scenario, height, width=12.0):
        self.width, self.height = width, height
        self.figure = plt.figure(figsize=(width, height))
        self.write(width / 2, 0.12, scenario["title"], fontsize=13, fontweight="bold", ha="center")
        self.write(width / 2, 0.4, scenario.get("task", ""), fontsize=10, ha="center", color="0.3")

    def write(self, left, top, text, **style):
        self.figure.text(left / self.width, 1 - top / self.height, text, va="top", **style)

    def panel(self, left, top, width, height):
        return self.figure.add_axes((left / self.width, 1 - (top + height) / self.height, width / self.width,
                                     height / self.height))

    def row(self, count, top, height):
        """Panels for curves side by side, with room for labels between them."""
        pitch = self.width / count
        return [self.panel(k * pitch + 0.7, top, pitch - 0.95, height) for k in range(count)]


def describe(sheet, left, run):
    """Above a scene: the verdict, what the arm came how near to, and where it ends."""
    sheet.write(left, 0.75, words.verdict(run), fontsize=11.5, fontweight="bold")
    sheet.write(left, 1.0, f"{words.approach(run)}\n{words.ending(run)}", fontsize=10)


def look(handle):
    """What distinguishes two entries of a legend that have the same label."""
    return handle.get_color() if isinstance(handle, Line2D) else (handle.get_facecolor(), handle.get_edgecolor())


def explain(sheet, painters, top):
    """One legend for several pictures. An entry that looks different in them shows all its looks."""
    entries = {}
    for painter in painters:
        for label, handle in painter.legend.items():
            entries.setdefault(label, {}).setdefault(look(handle), handle)
    sheet.figure.legend([tuple(handles.values()) for handles in entries.values()], list(entries), ncol=4,
                        handlelength=2.6, columnspacing=1.4, loc="upper center", borderaxespad=0,
                        bbox_to_anchor=(0.5, 1 - top / sheet.height),
                        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.2)})


def plot_scenes(sheet, places, views, same_scale=False, every_name=False):
    """One picture for each (left, top, width, height) and (run, view), and below them their legend."""
    painters = [drawing.Painter(sheet.panel(*place), view, every_name) for place, (_, view) in zip(places, views)]
    for painter, (run, _) in zip(painters, views):
        drawing.draw_scene(painter, run, closest(run))
    if same_scale:
        drawing.same_scale(painters)
    for painter in painters:
        painter.labels.place(painter.axes)
    explain(sheet, painters, places[0][1] + places[0][3] + 0.1)
    return painters


def page(run, file):
    """Writes one PNG for one run: the scene from the side and from above, and its curves."""
    sheet = Sheet(run.scenario, 15.4)
    describe(sheet, 0.2, run)
    _, above = plot_scenes(sheet, [(0.1, 1.7, 5.9, 4.9), (6.7, 1.7, 5.1, 4.5)], [(run, OBLIQUE), (run, FROM_ABOVE)],
                           every_name=True)
    finish(above.axes, "From above", 0, xlabel="x, m", ylabel="y, m")
    upper, lower = sheet.row(2, 9.3, 2.3), sheet.row(2, 12.6, 2.3)
    plot_clearances(upper[0], run) if closest(run) else plot_speeds_of_tool(upper[0], [run])
    plot_target_distance(upper[1], [run])
    plot_joints(lower[0], run, r"q\d+_rad", "angle, rad", "Joint angles")
    largest = np.abs(run.family(r"qd\d+_radps")).max()
    plot_joints(lower[1], run, r"qd\d+_radps", "speed, rad/s", f"Joint speeds (largest {largest:.2f} rad/s)")
    return save(sheet.figure, file)


def numbers(runs):
    """The results printed in comparison(), and a sum of the joint angles at the end, one line for each law."""
    return [f"{words.verdict(run)}; {words.approach(run)}; {words.ending(run)}; ".replace("\n", "; ") +
            f"{run.columns['axis_distance_m'].min():.4f} m; {np.abs(run.joints()[-1]).sum():.3f} rad" for run in runs]


def comparison(runs, file):
    """Writes one PNG with both laws: their scenes side by side, and their curves in common panels.

    numbers() are in the file too, so that a picture can be compared without drawing it.
    """
    sheet = Sheet(runs[0].scenario, 11.7)
    plot_scenes(sheet, [(0.1, 1.75, 5.85, 4.8), (6.05, 1.75, 5.85, 4.8)], [(run, OBLIQUE) for run in runs], True)
    for left, run in zip((0.2, 6.15), runs):
        describe(sheet, left, run)
    curves = [plot_both_clearances if closest(runs[0]) else plot_speeds_of_tool, plot_target_distance]
    curves += [plot_axis_distances] if is_papers(runs[0]) else []
    for axes, plot in zip(sheet.row(len(curves), 9.1, 2.1), curves):
        plot(axes, runs)
    return save(sheet.figure, file, {NUMBERS: "\n".join(numbers(runs))})


def pages(runs):
    """Writes a page for each law of one scenario and a page that compares the laws. Returns the files."""
    written = [page(run, FIGURES / f"{run.name}-{run.law}.png") for run in runs]
    return [*written, comparison(runs, FIGURES / f"{runs[0].name}-both.png")]
