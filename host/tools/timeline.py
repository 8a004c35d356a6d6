"""The curves of a logged run over time, as one SVG: what the controller did, and the limits that it kept."""
import io

import matplotlib
import numpy as np

import plots
import watch
import wire
from plots import BLACK, CONTACT, GREEN, JOINTS, ORANGE, SKY, TARGET, plt

MODE_COLOURS = dict(zip(wire.MODES, ("0.75", SKY, GREEN, ORANGE, CONTACT)))
FORESIGHT = {wire.controller_status_t.GUIDED: ("guided", "0.8"), wire.controller_status_t.WAITING: ("no path known", "0.5")}
REST_CLEARANCE_M = 0.004  # of a configuration without shield.rest_clearance_m
WORD_SHARE = 0.07   # of the time axis: a shorter stretch has no room for its name
ROWS = {"mode": 2, "foresight": 1, "fault": 0}
PANELS = dict(figsize=(11, 14), sharex=True, layout="constrained", gridspec_kw={"height_ratios": [1, 2, 2, 2, 2, 2]})
MOST_ROWS = 20000   # of a curve


def stretches(t_s, values):
    """[(value, from s, duration s)] of equal values in succession; each lasts until the next one begins."""
    starts = np.flatnonzero(np.r_[True, np.diff(values) != 0])
    times_s = np.r_[t_s[starts], t_s[-1]]
    return list(zip(values[starts].astype(int), times_s[:-1], np.diff(times_s)))


def draw_row(axes, run, name, looks):
    """One row of the band. looks: value -> (word, colour); other values are not drawn."""
    t_s = run.columns["t_s"]
    for value, start_s, duration_s in stretches(t_s, run.columns[name]):
        if value not in looks:
            continue
        word, colour = looks[value]
        axes.broken_barh([(start_s, max(duration_s, 0.002 * t_s[-1]))], (ROWS[name] - 0.4, 0.8), color=colour)
        if duration_s > WORD_SHARE * (t_s[-1] - t_s[0]):
            axes.text(start_s + duration_s / 2, ROWS[name], word, ha="center", va="center")


def plot_band(axes, run):
    """Modes, foresight and faults by name."""
    modes = {mode: (name, MODE_COLOURS[mode]) for mode, name in wire.MODES.items()}
    faults = {fault: (text, CONTACT) for fault, text in watch.FAULTS.items() if fault}
    for name, looks in (("mode", modes), ("foresight", FORESIGHT), ("fault", faults)):
        draw_row(axes, run, name, looks)
        for value in np.unique(run.columns[name]).astype(int):
            if value in looks and name != "fault":
                axes.plot([], [], color=looks[value][1], linewidth=6, label=looks[value][0])
    axes.set_yticks(list(ROWS.values()), list(ROWS))
    axes.grid(axis="y", visible=False)
    plots.finish(axes, "Mode, foresight, faults", len(modes) + len(FORESIGHT), ylim=(-0.5, 2.5))


def plot_clearance(axes, run):
    values_m = run.columns["clearance_m"]
    axes.plot(run.columns["t_s"], values_m, color=plots.BLUE, label="nearest obstacle, as the controller knows it")
    rest_m = plots.section(run, "shield").get("rest_clearance_m", REST_CLEARANCE_M)
    axes.axhline(rest_m, color=BLACK, linewidth=1, linestyle=":", label=f"the same to what rests, {rest_m * 1e3:g} mm")
    plots.finish_clearance(axes, run, min(values_m[np.isfinite(values_m)], default=0.0), "Clearance between surfaces", 4)


def plot_target_distance(axes, run):
    axes.plot(run.columns["t_s"], run.columns["target_distance_m"], color=TARGET)
    plots.finish(axes, "Tool to target", 0, ylabel="distance, m", ylim=(0, None))


def plot_cycle_time(axes, run):
    axes.plot(run.columns["t_s"], run.columns["cycle_time_s"] * 1e6, color=plots.BLUE, linewidth=1)
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


def svg(run, limits):
    """run: of logs.run_of(); limits: (positions, velocities), each joints x 2."""
    run = thinned(run)
    figure, panels = plt.subplots(6, **PANELS)
    plot_band(panels[0], run)
    plot_clearance(panels[1], run)
    plot_target_distance(panels[2], run)
    plot_joints(panels[3], run, r"qd\d+_radps", "speed, rad/s", "Joint velocities", limits[1])
    plot_joints(panels[4], run, r"q\d+_rad", "position, rad", "Joint positions", limits[0])
    plot_cycle_time(panels[5], run)
    for axes in panels:
        mark_faults(axes, run)
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("")
    for axes in panels[1:]:
        plots.mark_foresight(axes, run)
    panels[-1].set_xlabel("time, s")
    panels[0].set_xlim(run.columns["t_s"][0], run.columns["t_s"][-1])
    file = io.BytesIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    plt.close(figure)
    return file.getvalue()
