#!/usr/bin/env python3
"""Run a scenario: one law in real time, then both laws in lockstep for a table and figures.

The real-time run uses the default LCM network, on which no other controller may run; lcm-spy, watch.py and the send_*
scripts can take part. The exit code is that of the simulator: 0 if the scenario's expectations were met, 1 if not. They
are expectations of Sidestep: a run with the paper's law that does not meet them is shown, and the exit code is 0.
"""
import argparse
from pathlib import Path

import environment
import numpy as np

import network
import plots
import runs
import verdict

TO_AXIS = "least distance, obstacle centre to arm axis"  # the paper's measure, for its scenes
TO_OTHER_ARMS = "least clearance to the other arms"


def metres(value_m):
    return f"{value_m:.4f} m" if np.isfinite(value_m) else "-"


def column(run):
    """The results of one law, in the order of the table's rows."""
    speeds = run.family(r"qd\d+_radps")
    return [metres(run.columns["axis_distance_m"].min()), plots.length(run.columns["target_distance_m"][-1]),
            metres(run.columns["clearance_m"].min()), metres(run.columns["neighbour_clearance_m"].min()),
            f"{np.abs(speeds).max():.2f} rad/s", verdict.contact(run)]


def table(paper, sidestep):
    published = paper.scenario.get("published") or {}
    expected = [metres(published.get("axis_distance_m", np.nan)),
            f"< {published['final_distance_m'] * 1000:g} mm" if "final_distance_m" in published else "-", *"----"]
    rows = [TO_AXIS, "distance to target at the end",
            "least clearance, surface to surface", TO_OTHER_ARMS, "largest joint speed", "contact"]
    lines = [("", "published", "paper's law", "sidestep"), *zip(rows, expected, column(paper), column(sidestep))]
    hidden = {TO_OTHER_ARMS} if "arms" not in paper.scenario else set()
    if not published:
        hidden.add(TO_AXIS)
        lines = [(name, *results) for name, _, *results in lines]
    lines = [line for line in lines if line[0] not in hidden]
    widths = [max(map(len, cells)) for cells in zip(*lines)]
    return "\n".join(" | ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.yaml")
    parser.add_argument("--law", choices=sorted(runs.LAWS), default="sidestep", help="law of the run in real time")
    arguments = parser.parse_args()
    scenario_file = arguments.scenario.absolute()
    scenario, name = runs.load_scenario(scenario_file), scenario_file.stem

    runs.check_ends(scenario_file, scenario)
    network.check_free()
    print(f"{scenario['title']}: {scenario['duration_s']:g} s in real time with {runs.LAWS[arguments.law]}", flush=True)
    record = runs.RECORDS / f"{name}-realtime.csv"
    code = runs.execute(scenario_file, arguments.law, record, lockstep=False, log=record.with_suffix(".lcmlog"))
    if code == runs.BROKEN and arguments.law == "paper":
        print("The expectations above are those of Sidestep; the paper's law does not meet them.")
        code = runs.HELD
    laws = runs.in_parallel(runs.lockstep_runs, [(scenario_file, law, runs.RECORDS / f"{name}-{law}.csv")
                                                 for law in runs.LAWS])
    for both in zip(*laws):
        print(f"\n{both[0].scenario['title']}; both laws, in lockstep:\n{table(*both)}\n", flush=True)
        print("figures of these two runs: " + " ".join(map(runs.shown, plots.pages(both))))
    return code


if __name__ == "__main__":
    runs.main_of(main)
