"""The curves of a logged run over time, as one SVG: what the controller did, and the limits that it kept."""
import io
from typing import NamedTuple

import matplotlib
import numpy as np

import plots
import watch
import wire
from style import BLACK, BLUE, CONTACT, GREEN, GREY, JOINTS, ORANGE, SKY, TARGET, YELLOW, plt

GUIDED, WAITING = wire.controller_status_t.GUIDED, wire.controller_status_t.WAITING
REDS = ("#E88080", "#D04040", "#F0B0B0")
# Rows of the band: column of the run -> value -> (word, colour).
BAND = {"fault": {fault: (word, REDS[fault % 3]) for fault, word in watch.FAULTS.items() if fault},
        "foresight": {GUIDED: ("guided", "0.8"), WAITING: ("no path known", "0.5")},
        "mode": dict(zip(wire.MODES, zip(wire.MODES.values(), (YELLOW, SKY, GREEN, ORANGE, REDS[0]))))}
LEAST_SHARE = 0.002  # of the time axis: a shorter stretch is drawn as long
LETTER_SHARE = 0.009  # of the time axis, for each letter of a name
NAME_SHARE = 0.02   # of the time axis: the height of the letters of a name beside a line
PANELS = dict(figsize=(11, 14), sharex=True, layout="constrained", gridspec_kw={"height_ratios": [1, 2, 2, 2, 2, 2]})
MOST_ROWS = 20000   # of a curve
LOWEST_M = -0.1     # of the panel of the clearance
GAP_S, GAP_STEPS = 0.05, 3  # between two rows: what is longer than both is no measurement, and no line crosses it
DASHED = dict(color=BLACK, linewidth=1, linestyle=(0, (5, 3)))


class Curves(NamedTuple):
    svg: bytes
    span_s: tuple   # the time axis: from, to
    span: tuple     # where it begins and ends, as shares of the picture's width


def gaps(t_s):
    """Whether nothing is known between a row and the next one."""
    steps_s = np.diff(t_s)
    return steps_s > max(GAP_S, GAP_STEPS * np.median(steps_s)) if len(steps_s) else np.zeros(0, bool)


def broken(run):
    """The run with a row without numbers in every gap, where lines break."""
    t_s = run.columns["t_s"]
    after = np.flatnonzero(gaps(t_s)) + 1
    columns = {name: np.insert(values.astype(float), after, np.nan) for name, values in run.columns.items()}
    return run._replace(columns=columns | {"t_s": np.insert(t_s, after, t_s[after])})


def stretches(t_s, values):
    """[(value, from s, duration s)] of equal values in succession; each lasts until the next one or a gap begins."""
    gap = gaps(t_s)
    starts = np.flatnonzero(np.r_[True, (np.diff(values) != 0) | gap])
    ends = np.r_[starts[1:], len(t_s) - 1]
    ends_s = np.where(np.r_[False, gap][ends], t_s[ends - 1], t_s[ends])
    return list(zip(values[starts].astype(int), t_s[starts], ends_s - t_s[starts]))


def plot_stretch(axes, length_s, height, stretch, look):
    """One stretch of the band, named in it if there is room. A short one is drawn over the others."""
    (_, start_s, duration_s), (word, colour) = stretch, look
    least_s = LEAST_SHARE * length_s
    known = word in axes.get_legend_handles_labels()[1]
    axes.broken_barh([(start_s, max(duration_s, least_s))], (height - 0.4, 0.8), color=colour,
                     zorder=2 if duration_s > least_s else 3, label=None if known else word)
    if duration_s > LETTER_SHARE * len(word) * length_s:
        axes.text(start_s + duration_s / 2, height, word, ha="center", va="center", zorder=4)


def plot_band(axes, run):
    """Modes, foresight and faults by name, as far as there are any; a short stretch is named only in the legend."""
    t_s = run.columns["t_s"]
    rows = {name: [stretch for stretch in stretches(t_s, run.columns[name]) if stretch[0] in looks]
            for name, looks in BAND.items()}
    rows = {name: found for name, found in rows.items() if found}
    for height, (name, found) in enumerate(rows.items()):
        for stretch in found:
            plot_stretch(axes, t_s[-1] - t_s[0], height, stretch, BAND[name][stretch[0]])
    for i, row in enumerate(np.flatnonzero(gaps(t_s))):
        axes.axvspan(t_s[row], t_s[row + 1], facecolor="none", edgecolor=GREY, hatch="//", linewidth=0,
                     label=None if i else "nothing logged")
    axes.set_yticks(range(len(rows)), list(rows))
    axes.grid(axis="y", visible=False)
    absent = ", ".join(f"no {name}" for name in BAND if name not in rows)
    title = ", ".join(reversed(rows)).capitalize() + (f" ({absent} in this run)" if absent else "")
    plots.finish(axes, title, 10, ylim=(-0.5, max(len(rows), 1) - 0.5))


def plot_clearance(axes, run):
    """What is only possible, while the obstacles are silent, is no measurement: a thin line, which may be cut."""
    t_s, values_m, possible_m = (run.columns[name] for name in ("t_s", "clearance_m", "possible_clearance_m"))
    axes.plot(t_s, values_m, color=BLUE, label="nearest obstacle, as the controller knows it")
    if np.isfinite(possible_m).any():
        axes.plot(t_s, possible_m, color=GREY, linewidth=1, linestyle="--",
                  label="obstacles silent: what is possible, not measured")
    least_m = min(values_m[np.isfinite(values_m)], default=0.0)
    plots.finish_clearance(axes, run, max(least_m, LOWEST_M), "Clearance between surfaces", 2)


def plot_target_distance(axes, run):
    axes.plot(run.columns["t_s"], run.columns["target_distance_m"], color=TARGET)
    plots.finish(axes, "Tool to target", 0, ylabel="distance, m", ylim=(0, None))


def plot_cycle_time(axes, run, period_s):
    """The period, in which a cycle has to end, is a line where it is near enough to be drawn."""
    times_us = run.columns["cycle_time_s"] * 1e6
    longest_us = max(times_us[np.isfinite(times_us)], default=0.0)
    axes.plot(run.columns["t_s"], times_us, color=BLUE, linewidth=1, label=f"longest: {longest_us:.0f} us")
    title = "CPU time of a whole cycle"
    if longest_us > 0.3e6 * period_s > 0:
        axes.axhline(period_s * 1e6, **DASHED, label=f"period: {period_s * 1e6:.0f} us")
    elif period_s > 0:
        title += f" (period: {period_s * 1e6:.0f} us)"
    plots.finish(axes, title, 2, ylabel="time, us", ylim=(0, None))


def plot_joints(axes, run, pattern, label, title, limits):
    """limits: joints x 2. A limit of one joint has its colour, one that several joints share is black."""
    plots.plot_joints(axes, run, pattern, label, title)
    for limit in np.unique(limits[np.isfinite(limits)]):
        owners = np.flatnonzero((limits == limit).any(axis=1))
        colour = JOINTS[owners[0] % len(JOINTS)] if len(owners) == 1 else BLACK
        axes.axhline(limit, **DASHED | {"color": colour})
    axes.plot([], [], **DASHED, label="limits (black: shared by several joints)")
    plots.finish(axes, title, len(JOINTS) + 1)


def mark_faults(axes, run):
    """A line wherever a fault begins, with its name where no other name is."""
    faults, named_s = run.columns["fault"], -np.inf
    for row in np.flatnonzero((faults != 0) & (np.diff(faults, prepend=0) != 0)):
        t_s = run.columns["t_s"][row]
        axes.axvline(t_s, color=CONTACT, linewidth=1, linestyle=":")
        if t_s > named_s + NAME_SHARE * np.ptp(run.columns["t_s"]):
            plots.write(axes, t_s, watch.FAULTS.get(faults[row], "fault"), ha="right", rotation=90)
            named_s = t_s


def thinned(run):
    step = len(run.columns["t_s"]) // MOST_ROWS + 1
    return run._replace(columns={name: values[::step] for name, values in run.columns.items()})


def draw(run, limits):
    """The Curves of a run: of logs.run_of(); limits: (positions, velocities), each joints x 2."""
    period_s = np.median(np.diff(run.columns["t_s"])) if len(run.columns["t_s"]) > 1 else 0.0  # a row is a cycle
    run = thinned(run)
    curves = broken(run)
    figure, panels = plt.subplots(6, **PANELS)
    plot_band(panels[0], run)
    plot_clearance(panels[1], curves)
    plot_target_distance(panels[2], curves)
    plot_joints(panels[3], curves, r"qd\d+_radps", "speed, rad/s", "Joint velocities", limits[1])
    plot_joints(panels[4], curves, r"q\d+_rad", "position, rad", "Joint positions", limits[0])
    plot_cycle_time(panels[5], curves, period_s)
    for axes in panels:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("")
    for axes in panels[1:]:
        plots.mark_foresight(axes, run)
        mark_faults(axes, run)
    panels[-1].set_xlabel("time since the first status of the controller, s")
    panels[0].set_xlim(run.columns["t_s"][0], run.columns["t_s"][-1])
    file = io.BytesIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    plt.close(figure)
    return Curves(file.getvalue(), panels[0].get_xlim(), tuple(panels[0].get_position().intervalx))
