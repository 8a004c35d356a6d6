#!/usr/bin/env python3
"""Draw the trade-off of the paper's law between distance and accuracy over a sweep of its gains.

Every run is build/controller --law paper with build/sim in lockstep. build/figures/tradeoff.csv stores the results with
a hash of everything that they depend on.
"""
import argparse
import csv
import functools
import hashlib

import environment
import numpy as np
import yaml

import runs
import style
from style import plt

SETS_PER_READING = 75
CONTACT_M = 0.1  # sum of the radii of obstacle and arm, 0.05 m each
FLOOR_MM = 0.1   # smaller errors are drawn here, because the axis is logarithmic
READINGS = {"measured": (style.ORANGE, "o"), "planned": (style.SKY, "^")}
SCENARIOS = {name: runs.ROOT / f"host/scenarios/{name}.yaml" for name in ("paper-b", "paper-c")}
CACHE = runs.FIGURES / "tradeoff.csv"
FIGURE = runs.FIGURES / "tradeoff.png"
FOLDER = runs.RECORDS / "tradeoff"
COLUMNS = ["key", "scenario", "law", "tool_velocity", "is_start", "least_m", "error_m"]


def gain_sets(start):
    """Configuration sections `paper:` for both readings of V: the start values, and random sets."""
    generator = np.random.default_rng(1)

    def between(low, high):
        return round(float(np.exp(generator.uniform(np.log(low), np.log(high)))), 4)

    sets = [{}]
    while len(sets) < SETS_PER_READING:
        k_pos, d_1 = between(5, 60), between(0.15, 0.4)
        sets.append(dict(k_pos_per_s2=k_pos, k_vel_per_s=round(2 * k_pos ** 0.5, 4), x_m_mps=between(0.2, 2.0),
                         d_1_m=d_1, d_m_m=d_1, k_rpos_m2ps2=between(0.05, 5.0)))
    return [start | gains | {"tool_velocity": reading} for reading in READINGS for gains in sets]


@functools.cache
def hash_of(file):
    return hashlib.sha256(file.read_bytes()).digest()


def key_of(config, law, files):
    """A hash of everything that the result depends on."""
    parts = [hashlib.sha256(f"{law}\n{config}".encode()).digest(), *map(hash_of, files)]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:24]


def jobs():
    """(row without its results, configuration text) for every run of the sweep, and for the run of Sidestep."""
    work = []
    for name, scenario_file in SCENARIOS.items():
        scenario = runs.load_scenario(scenario_file)
        files = [scenario_file, runs.ROOT / scenario["robot"]["urdf"], runs.BUILD / "controller", runs.BUILD / "sim"]
        if missing := next((file for file in files if not file.exists()), None):
            raise runs.RunFailed(f"{runs.shown(missing)} is missing: run make")
        base = runs.load(runs.config_of(scenario))
        wanted = [("paper", base | {"paper": gains}) for gains in gain_sets(base["paper"])] + [("sidestep", base)]
        for law, settings in wanted:
            config = yaml.safe_dump(settings)
            is_start = all(settings["paper"][key] == value for key, value in base["paper"].items()
                           if key != "tool_velocity")
            work.append((dict(key=key_of(config, law, files), scenario=name, law=law,
                              tool_velocity=settings["paper"]["tool_velocity"], is_start=str(is_start)), config))
    return work


def run(row, config):
    """Completes a row with the least distance and the error at the end."""
    files = [FOLDER / f"{row['key']}{ending}" for ending in (".yaml", ".csv", ".controller.log", ".sim.log")]
    FOLDER.mkdir(parents=True, exist_ok=True)
    files[0].write_text(config)
    columns = runs.lockstep_run(SCENARIOS[row["scenario"]], row["law"], files[1], files[0]).columns
    for file in files:
        file.unlink(missing_ok=True)
    return row | dict(least_m=columns["axis_distance_m"].min(), error_m=columns["target_distance_m"][-1])


def results():
    """Every row of the sweep, from the cache where its key is unchanged."""
    known = {}
    if CACHE.exists():
        with open(CACHE, newline="") as stream:
            known = {row["key"]: row for row in csv.DictReader(stream)}
    work = jobs()
    missing = [job for job in work if job[0]["key"] not in known]
    for row in runs.in_parallel(run, missing, done=runs.progress("gains")):
        known[row["key"]] = row
    rows = [known[row["key"]] for row, _ in work]
    CACHE.parent.mkdir(parents=True, exist_ok=True)
    unfinished = CACHE.with_suffix(".new")
    with open(unfinished, "w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    unfinished.replace(CACHE)
    return [row | dict(least_m=float(row["least_m"]), error_mm=max(float(row["error_m"]) * 1e3, FLOOR_MM))
            for row in rows]


def scatter(axes, rows, size, colour, marker, label, **more):
    axes.scatter([row["least_m"] for row in rows], [row["error_mm"] for row in rows], s=size, color=colour,
                 marker=marker, label=label, **more)


def plot(axes, name, rows):
    scenario = runs.load_scenario(SCENARIOS[name])
    published = scenario.get("published") or {}
    for reading, (colour, marker) in READINGS.items():
        swept = [row for row in rows if (row["law"], row["tool_velocity"]) == ("paper", reading)]
        scatter(axes, [row for row in swept if row["is_start"] == "False"], 26, colour, marker,
                f"paper's law, {reading} V", alpha=0.65, linewidth=0)
        scatter(axes, [row for row in swept if row["is_start"] == "True"], 120, colour, marker,
                f"paper's law, {reading} V, start values", edgecolor=style.BLACK, zorder=3)
    scatter(axes, [row for row in rows if row["law"] == "sidestep"], 60, style.BLUE, "D", "Sidestep",
            edgecolor=style.BLACK, zorder=4)
    axes.scatter(published["axis_distance_m"], max(published.get("final_distance_m", 0) * 1e3, FLOOR_MM), s=200,
                 color=style.GREEN, marker="*", edgecolor=style.BLACK, zorder=5, label="published")
    axes.axvline(CONTACT_M, color=style.GREY, linewidth=1, linestyle="--")
    axes.annotate("contact", (CONTACT_M, 0.85), xycoords=("data", "axes fraction"), rotation=90, ha="right",
                  va="center", color="0.35")
    axes.set(yscale="log", xlabel="least distance, obstacle centre to arm axis, m",
             ylabel=f"tool to target at the end, mm (at {FLOOR_MM:g}: at most that)", title=scenario["title"])
    axes.yaxis.set_major_formatter(lambda value, _position: f"{value:g}")


def draw():
    """Do the runs that the cache lacks and draw the figure. Returns its file."""
    rows = results()
    figure, panels = plt.subplots(1, len(SCENARIOS), figsize=(13, 6.2), layout="constrained", sharex=True,
                                  sharey=True)
    figure.suptitle("Least distance against final error over the gains of the paper's law", fontsize=13,
                    fontweight="bold")
    for axes, name in zip(panels, SCENARIOS):
        plot(axes, name, [row for row in rows if row["scenario"] == name])
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncol=3)
    return style.save(figure, FIGURE)


def main():
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    print(f"wrote {runs.shown(draw())}")


if __name__ == "__main__":
    runs.main_of(main)
