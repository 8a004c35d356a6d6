#!/usr/bin/env python3
"""Make the tables and pictures of README.md and docs/results.md that come from scenarios, in lockstep.

A table or sentence stands between the lines `<!-- make docs: NAME -->` and `<!-- end -->`. A picture has the results
that are printed in it as metadata. With --check nothing is written: every difference is printed, and the exit code is 1
if there is one. The picture of the live view has the key of its colours as metadata; tests/view/picture.py makes it.
"""
import argparse
import difflib
import re
import sys
import textwrap
from pathlib import Path

import environment
import numpy as np
import yaml
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "host/view"))
import animation
import panel
import play
import plots
import runs

PAGES = [runs.ROOT / "README.md", runs.ROOT / "docs/results.md"]
# Picture -> its scenario, and what draws it from both runs.
PICTURES = {runs.ROOT / "host/scenarios/closing-gap.gif": ("closing-gap", animation.save),
            runs.ROOT / "host/scenarios/closing-gap.png": ("closing-gap", plots.comparison),
            runs.ROOT / "host/scenarios/paper-c.png": ("paper-c", plots.comparison)}
VIEW, KEY = runs.ROOT / "host/scenarios/view.png", "key"
EXAMPLES = {"parked-obstacle": "", "closing-gap": "", "pillar": "", "two-people": "", "moving-shelf": "",
            "table": " (static surroundings)", "iiwa-crossing": " (KUKA LBR iiwa 14)",
            "panda-crossing": " (Franka Panda)", "shelf-pick": " (Franka Panda)", "box": " (Franka Panda)",
            "under-table": " (Franka Panda)", "home-from-under-table": " (Franka Panda)",
            "shelf-with-a-visitor": " (Franka Panda)", "fetch": " (Franka Panda)", "kitchen": " (Franka Panda)"}
PLANNED = "planned"  # the paper's law with the other reading of its tool velocity
BLOCK = re.compile(r"(<!-- make docs: ([\w-]+) -->\n)(.*?)(<!-- end -->)", re.S)


class NotRun(Exception):
    pass


class Done(dict):
    """(scenario, law) -> the Run of every arm."""

    def __missing__(self, key):
        raise NotRun(key)


def planned_config():
    """lwa3.yaml with `paper: {tool_velocity: planned}`."""
    config = runs.load(runs.ROOT / "firmware/config/lwa3.yaml")
    config["paper"] = (config.get("paper") or {}) | {"tool_velocity": "planned"}
    file = runs.RECORDS / "planned.yaml"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(yaml.safe_dump(config))
    return file


def runs_of(names):
    """(scenario, law) -> the Run of every arm, for these scenarios."""
    jobs = {(name, law): (law, None) for name in names for law in runs.LAWS}
    planned = planned_config()
    jobs |= {(name, PLANNED): ("paper", planned) for name in names if name.startswith("paper-")}
    results = runs.in_parallel(runs.lockstep_runs, [
        (runs.ROOT / f"host/scenarios/{name}.yaml", law, runs.RECORDS / f"docs-{name}-{kind}.csv", config)
        for (name, kind), (law, config) in jobs.items()], done=runs.progress("lockstep runs"))
    return Done(zip(jobs, results))


def least(all_arms, column):
    return min(run.columns[column].min() for run in all_arms)


def mm(value_m):
    return "< 0.1 mm" if abs(value_m) < 1e-4 else f"{value_m * 1000:.1f} mm"


def error(all_arms):
    """The distance to the target at the end, of the arm for which it is largest."""
    value_m = max(run.columns["target_distance_m"][-1] for run in all_arms)
    return mm(value_m) if value_m < 0.1 else f"{value_m:.3f} m"


def table(head, rows):
    lines = ["| " + " | ".join(cells) + " |" for cells in [head, *rows]]
    return "\n".join([lines[0].replace("|  |", "| |"), "|---" * len(head) + "|", *lines[1:]])


def run_table(done):
    text = play.table(done["paper-c", "paper"][0], done["paper-c", "sidestep"][0])
    return textwrap.indent(text, "    ")


def paper_table(done):
    def row(title, kind):
        a, b, c = (done[f"paper-{letter}", kind] for letter in "abc")
        return [title, error(a), *(f"{least(one, 'axis_distance_m'):.4f} m; {error(one)}" for one in (b, c))]
    published = [done[f"paper-{letter}", "paper"][0].scenario["published"] for letter in "bc"]
    return table(["", "A: error at 2.3 s", "B: least distance; error at 8 s", "C: least distance; error at 2.8 s"], [
        row("paper's law, `tool_velocity: measured`", "paper"), row("paper's law, `tool_velocity: planned`", PLANNED),
        row("sidestep", "sidestep"), ["published", "-", f"{published[0]['axis_distance_m']:.4f} m",
                                      f"{published[1]['axis_distance_m']:.4f} m; < 1 mm"]])


def speed_sentence(done):
    paper, sidestep = (np.abs(done["paper-a", law][0].family(r"qd\d+_radps")).max() for law in runs.LAWS)
    return ("In A the paper reports joint speeds below 0.06 rad/s, which is impossible for this arm; the largest joint "
            f"speed is {paper:.2f} rad/s with the law `paper` (`measured`) and {sidestep:.2f} rad/s with `sidestep`.")


def scenes_table(done):
    def cell(all_arms):
        itself = " (links touch each other)" if any(run.touching_itself().any() for run in all_arms) else ""
        return f"{mm(least(all_arms, 'clearance_m'))}{itself}; {error(all_arms)}"
    return table(["scene", "paper's law: least clearance; error at the end",
                  "sidestep: least clearance; error at the end"],
                 [[f"`{name}`{remark}", *(cell(done[name, law]) for law in runs.LAWS)]
                  for name, remark in EXAMPLES.items()])


def guided_sentence(done):
    shares = {name: np.mean(done[name, "sidestep"][0].columns["foresight"] == 1) for name in EXAMPLES}
    guided = [f"{share * 100:.0f} % of the time in `{name}`" for name, share in shares.items() if share > 0]
    listed = " and ".join([", ".join(guided[:-1]), guided[-1]] if guided[1:] else guided)
    return f"Foresight guides the arm for {listed}, and never in the other scenes of this table."


def two_arms_table(done):
    laws = [done["two-arms", law] for law in runs.LAWS]
    contacts = ["yes" if any(run.touching().any() for run in arms) else "no" for arms in laws]
    return table(["", "paper's law", "sidestep"], [
        ["least clearance to the other arm", *(mm(least(arms, "neighbour_clearance_m")) for arms in laws)],
        ["least clearance to ball and bar", *(mm(least(arms, "clearance_m")) for arms in laws)],
        ["target distance at the end", *map(error, laws)], ["contact", *contacts]])


MAKERS = {"run": run_table, "paper": paper_table, "speed": speed_sentence, "scenes": scenes_table,
          "guided": guided_sentence, "two-arms": two_arms_table}


def wrapped(text):
    return text if text.startswith(("|", "    ")) else textwrap.fill(text, 118, break_on_hyphens=False)


def made(text, done):
    """The page with every block as this version gives it; blocks about scenarios that were not run stay as they are."""
    def block(match):
        try:
            return f"{match[1]}{wrapped(MAKERS[match[2]](done))}\n{match[4]}"
        except NotRun:
            return match[0]
    return BLOCK.sub(block, text)


def numbers_of(picture):
    """plots.numbers() of a picture that PICTURES names; nothing for another file."""
    try:
        information = Image.open(picture).info
        return information.get(plots.NUMBERS, information.get("comment", b"").decode()).splitlines()
    except OSError:
        return []


def key_of(picture):
    """The key of the colours that a picture of the view shows, as panel.key() made it."""
    with Image.open(picture) as image:
        return image.info.get(KEY, "")


def differences(name, there, now):
    return list(difflib.unified_diff(there, now, f"{name}, there", f"{name}, this version", lineterm="", n=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; exit code 1 if anything is not up to date")
    parser.add_argument("--scenario", action="append", metavar="NAME",
                        help="only what is about this scenario (may be repeated)")
    arguments = parser.parse_args()
    check, names = arguments.check, arguments.scenario or runs.ending_scenarios()
    done, different = runs_of(names), []
    for file in PAGES:
        there = file.read_text()
        now = made(there, done)
        different += differences(runs.shown(file), there.splitlines(), now.splitlines())
        if not check:
            file.write_text(now)
    for picture, (name, draw) in PICTURES.items():
        if name not in names:
            continue
        both = [done[name, law][0] for law in runs.LAWS]
        different += differences(runs.shown(picture), numbers_of(picture), plots.numbers(both))
        if not check:
            draw(both, picture)
    different += differences(runs.shown(VIEW), [key_of(VIEW)], [panel.key()])
    print("\n".join(different) if different else "everything is up to date")
    if check and different:
        print("run make docs; the picture of the view: make view-test, and copy it from build/figures", file=sys.stderr)
    return int(check and bool(different))


if __name__ == "__main__":
    runs.main_of(main)
