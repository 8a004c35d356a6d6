#!/usr/bin/env python3
"""Draw the scenarios under both laws, and the paper's trade-off over a sweep of its gains."""
import argparse
from pathlib import Path

import environment
import plots
import runs
import tradeoff

SCENARIOS = [runs.ROOT / f"host/scenarios/{name}.yaml" for name in runs.ending_scenarios()]


def draw(scenario_file):
    """Run a scenario with both laws in lockstep and draw it. Returns the files written."""
    name = scenario_file.stem
    laws = runs.in_parallel(runs.lockstep_runs, [(scenario_file, law, runs.RECORDS / f"{name}-{law}.csv")
                                                 for law in runs.LAWS])
    return [file for both in zip(*laws) for file in plots.pages(both)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", type=Path, action="append", metavar="FILE",
                        help="draw only this scenario, without the trade-off (may be repeated)")
    chosen = parser.parse_args().scenario
    for scenario_file in chosen or SCENARIOS:
        for file in draw(scenario_file.absolute()):
            print(f"wrote {runs.shown(file)}", flush=True)
    if not chosen:
        print(f"wrote {runs.shown(tradeoff.draw())}")


if __name__ == "__main__":
    runs.main_of(main)
