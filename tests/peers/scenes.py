#!/usr/bin/env python3
"""Check that arms of example-robot-data run witnessed scenes (build/campaign) without contact of their meshes."""
import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from kinematics import ROOT
from meshes import ARMS

PLAYED = ["panda", "xarm7"]


def contacts(arm, arguments):
    """Runs the scenes of an arm and prints their table. Returns the names of the scenes with a contact."""
    urdf, base, tip = ARMS[arm]
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder) / "rows.csv"
        subprocess.run(["nice", ROOT / "build/campaign", "--urdf", urdf, "--base", base, "--tip", tip, "--csv", rows,
                        "--family", arguments.family, "--count", str(arguments.count), "--seed", str(arguments.seed),
                        "--quiet"], check=True)
        played = list(csv.DictReader(rows.open()))
    if len(played) != arguments.count:
        sys.exit(f"{arm}: {len(played)} scenes in the results")
    return [f"{row['family']}:{row['seed']}" for row in played
            if float(row["clearance_m"]) < 0.0 or float(row["self_clearance_m"]) <= 0.0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="scenes for each arm (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--family", default="chase",
                        help="family of scenes (default %(default)s: with a moving target)")
    arguments = parser.parse_args()
    failed = 0
    for arm in PLAYED:
        scenes = contacts(arm, arguments)
        failed += bool(scenes)
        print(f"{'FAIL' if scenes else 'ok':4}  {arm}: contact in {len(scenes)} of {arguments.count} scenes",
              *scenes, flush=True)
    print(f"{len(PLAYED) - failed} passed, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    os.chdir(ROOT)
    main()
