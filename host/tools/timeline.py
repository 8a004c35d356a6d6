"""The curves of a logged run over time, as one SVG: what the controller did, and the limits that it kept."""
import io
from typing import NamedTuple

import matplotlib
import numpy as np

import plots
import watch
import wire
from style import BLACK, BLUE, CONTACT, GREEN, JOINTS, ORANGE, SKY, TARGET, YELLOW, plt

GUIDED, WAITING = wire.controller_status_t.GUIDED, wire.controller_status_t.WAITING
REDS = ("#E88080", "#D04040", "#F0B0B0")
# Rows of the band: column of the run -> value -> (word, colour).
BAND = {"fault": {fault: (word, REDS[fault % 3]) for fault, word in watch.FAULTS.items() if fault},
        "foresight": {GUIDED: ("guided", "0.8"), WAITING: ("no path known", "0.5")},
        "mode": dict(zip(wire.MODES, zip(wire.MODES.values(), (YELLOW, SKY, GREEN, ORANGE, REDS[0]))))}
LEAST_SHARE = 0.002  # of the time axis: a shorter stretch is drawn as long
WORD_SHARE = 0.07   # of the time axis: a shorter stretch has no room for its name
PANELS = dict(figsize=(11, 14), sharex=True, layout="constrained", gridspec_kw={"height_ratios": [1, 2, 2, 2, 2, 2]})
MOST_ROWS = 20000   # of a curve


class Curves(NamedTuple):
    svg: bytes
    span_s: tuple   # the time axis: from, to
    span: tuple     # where it begins and ends, as shares of the picture's width


def stretches(t_s, values):
    """[(value, from s, duration s)] of equal values in succession; each lasts until the next one begins."""
    starts = np.flatnonzero(np.r_[True, np.diff(values) != 0])
    times_s = np.r_[t_s[starts], t_s[-1]]
    return list(zip(values[starts].astype(int), times_s[:-1], np.diff(times_s)))


def plot_band(axes, run):
    """Modes, foresight and faults by name; the name of a short stretch is only in the legend."""
    t_s, shown = run.columns["t_s"], set()
    length_s = t_s[-1] - t_s[0]
    for height, (name, looks) in enumerate(BAND.items()):
        for value, start_s, duration_s in stretches(t_s, run.columns[name]):
            if value not in looks:
                continue
            word, colour = looks[value]
            axes.broken_barh([(start_s, max(duration_s, LEAST_SHARE * length_s))], (height - 0.4, 0.8), color=colour,
                             label=None if word in shown else word)
            shown.add(word)
            if duration_s > WORD_SHARE * length_s:
                axes.text(start_s + duration_s / 2, height, word, ha="center", va="center")
    axes.set_yticks(range(len(BAND)), list(BAND))
    axes.grid(axis="y", visible=False)
    plots.finish(axes, "Mode, foresight, faults", 10, ylim=(-0.5, len(BAND) - 0.5))


def plot_clearance(axes, run):
    values_m = run.columns["clearance_m"]
    axes.plot(run.columns["t_s"], values_m, color=BLUE, label="nearest obstacle, as the controller knows it")
    least_m = min(values_m[np.isfinite(values_m)], default=0.0)
    plots.finish_clearance(axes, run, least_m, "Clearance between surfaces", 4)


def plot_target_distance(axes, run):
    axes.plot(run.columns["t_s"], run.columns["target_distance_m"], color=TARGET)
    plots.finish(axes, "Tool to target", 0, ylabel="distance, m", ylim=(0, None))


def plot_cycle_time(axes, run):
    axes.plot(run.columns["t_s"], run.columns["cycle_time_s"] * 1e6, color=BLUE, linewidth=1)
    plots.finish(axes, "CPU time of a whole cycle", 0, ylabel="time, us", ylim=(0, None))


def plot_joints(axes, run, pattern, label, title, limits):
    """limits: joints x 2. A limit of one joint has its colour, one that several joints share is black."""
    plots.plot_joints(axes, run, pattern, label, title)
    for limit in np.unique(limits[np.isfinite(limits)]):
        owners = np.flatnonzero((limits == limit).any(axis=1))
        colour = JOINTS[owners[0] % len(JOINTS)] if len(owners) == 1 else BLACK
        axes.axhline(limit, color=colour, linewidth=1, linestyle=(0, (5, 3)))
    axes.plot([], [], color=BLACK, linewidth=1, linestyle=(0, (5, 3)), label="limits")
    plots.finish(axes, title, len(JOINTS) + 1)


def mark_faults(axes, run):
    """A line wherever a fault begins."""
    faults = run.columns["fault"]
    for t_s in run.columns["t_s"][np.flatnonzero((faults != 0) & (np.diff(faults, prepend=0) != 0))]:
        axes.axvline(t_s, color=CONTACT, linewidth=1, linestyle=":")


def thinned(run):
    step = len(run.columns["t_s"]) // MOST_ROWS + 1
    return run._replace(columns={name: values[::step] for name, values in run.columns.items()})


def draw(run, limits):
    """The Curves of a run: of logs.run_of(); limits: (positions, velocities), each joints x 2."""
    run = thinned(run)
    figure, panels = plt.subplots(6, **PANELS)
    plot_band(panels[0], run)
    plot_clearance(panels[1], run)
    plot_target_distance(panels[2], run)
    plot_joints(panels[3], run, r"qd\d+_radps", "speed, rad/s", "Joint velocities", limits[1])
    plot_joints(panels[4], run, r"q\d+_rad", "position, rad", "Joint positions", limits[0])
    plot_cycle_time(panels[5], run)
    for axes in panels:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("")
    for axes in panels[1:]:
        plots.mark_foresight(axes, run)
        mark_faults(axes, run)
    panels[-1].set_xlabel("time, s")
    panels[0].set_xlim(run.columns["t_s"][0], run.columns["t_s"][-1])
    file = io.BytesIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    plt.close(figure)
    return Curves(file.getvalue(), panels[0].get_xlim(), tuple(panels[0].get_position().intervalx))
