"""What a run came to: how near the arm came to what, whether it touched it, and whether it arrived."""
from typing import NamedTuple

import numpy as np

import arm
import solids
from runs import ROOT

ARRIVED_M = 0.01       # an error at the end that counts as arrived (docs/results.md)
SAME_PAIR_M = 0.005    # a pair of solids whose distance differs by less from the recorded clearance can be its pair
SLOW_MPS = 0.05        # from which on an obstacle needs the full clearance (docs/controller.md)
NEAR_M = 1.3           # an obstacle within this clearance is in the picture
LEAVES_M = 0.01        # what moves has come and left if it is so much farther away at the end
OTHER_ARM, SURROUNDINGS, LINKS = "the other arm", "the surroundings", "links of the arm"


class Closest(NamedTuple):
    row: int
    clearance_m: float
    contact: bool
    name: str           # of what is touched or nearest, LINKS if links touch each other, "" if unknown
    pair: tuple         # 3, m, world frame: the point of the arm, that of the other solid; None if unknown


def obstacle_count(run):
    return len(run.scenario["obstacles"])


def obstacle_name(run, number):
    """number: from 0."""
    entry = run.scenario["obstacles"][number]
    named = f"person ({number + 1})" if entry.get("kind") == "person" else f"obstacle {number + 1}"
    return entry.get("name") or entry.get("body") or named


def bodies(run):
    """The numbers of the obstacles, from 0, as lists: the parts of a person belong together."""
    found = {}
    for number, entry in enumerate(run.scenario["obstacles"]):
        found.setdefault(entry.get("body", number), []).append(number)
    return list(found.values())


def speed_mps(entry):
    """Of an obstacle of the scenario."""
    return np.linalg.norm(entry.get("velocity_mps", (0, 0, 0)))


def is_slow(entry):
    """Whether the arm may pass an obstacle of the scenario at less than the full clearance: it rests or is slow."""
    return entry.get("kind") != "person" and speed_mps(entry) < SLOW_MPS


def has_resting(run):
    """Whether the arm may pass something at less than the full clearance."""
    return bool(solids.surroundings(run)) or any(map(is_slow, run.scenario["obstacles"]))


def slow_speed(run, name):
    """The speed of an obstacle that moves, but too slowly for the full clearance, in brackets; else empty."""
    slow = {obstacle_name(run, i): speed_mps(entry) for i, entry in enumerate(run.scenario["obstacles"])
            if is_slow(entry) and speed_mps(entry) > 0 and moves(run, i)}
    return f"({slow[name]:g} m/s) " if name in slow else ""


def clearance(run):
    """m, at every row, to obstacles, surroundings and other arms."""
    return np.minimum(run.columns["clearance_m"], run.columns["neighbour_clearance_m"])


def grasped(run):
    """The indices of the obstacles that the tool holds at any time."""
    ids = {one for step in run.scenario.get("grasp", []) for one in step.get("held", [])}
    return [i for i, entry in enumerate(run.scenario["obstacles"]) if entry["id"] in ids]


def moves(run, number):
    """Whether an obstacle moves at any time, other than in the gripper."""
    return number not in grasped(run) and bool((np.ptp(run.path(f"o{number + 1}"), axis=0) > 0.005).any())


def clearance_to_movers(run):
    """m, at every row, to what moves by itself."""
    movers = [run.columns[f"o{i + 1}_clearance_m"] for i in range(obstacle_count(run)) if moves(run, i)]
    return np.min([run.columns["neighbour_clearance_m"], *movers], axis=0)


def closest(run):
    """The decisive moment: the first contact, else the first of links with each other, else the least clearance.

    If something that moves comes near and leaves again, its least clearance comes before that to what rests, which says
    less. None where there is nothing to touch.
    """
    values_m, own, movers_m = clearance(run), run.touching_itself(), clearance_to_movers(run)
    if not np.isfinite(values_m).any():
        return None
    if (values_m < 0).any():
        return at_row(run, int(np.argmax(values_m < 0)), values_m)
    if own.any():
        row = int(np.argmax(own))
        return Closest(row, run.columns["self_clearance_m"][row], True, LINKS, touching_links(run, row))
    meeting = movers_m.min() < min(NEAR_M, movers_m[-1] - LEAVES_M)
    return least(run, movers_m if meeting else values_m)


def at_row(run, row, values_m):
    return Closest(row, values_m[row], bool(values_m[row] < 0), *nearest(run, row, values_m[row]))


def least(run, values_m):
    """Where these clearances are least."""
    return at_row(run, int(np.argmin(values_m)), values_m)


def touching_links(run, row):
    """The pair of points of two links that begin to touch each other at a row, None if none is found.

    It is that of the recorded distance one row before, where that distance is not yet a depth.
    """
    row = max(row - 1, 0)
    robot, recorded_m = run.scenario["robot"], run.columns["self_clearance_m"][row]
    frames = [shape.frame for shape in arm.shapes(ROOT / robot["urdf"], robot["base"], robot["tip"])]
    links = list(zip(frames, solids.arm_solids(run, row)))
    found = [solids.nearest_points(one, other) for frame, one in links for beyond, other in links
             if beyond > frame + 1 and solids.may_be_within(one, other, recorded_m + SAME_PAIR_M)]
    distance_m, pair = min(found, key=lambda entry: abs(entry[0] - recorded_m), default=(np.inf, None))
    return pair if abs(distance_m - recorded_m) < SAME_PAIR_M else None


def held(run, row):
    """The indices of the obstacles that the tool holds at a row."""
    steps = [step for step in run.scenario.get("grasp", []) if step["at_s"] <= run.columns["t_s"][row]]
    ids = steps[-1].get("held", []) if steps else []
    return [i for i, entry in enumerate(run.scenario["obstacles"]) if entry["id"] in ids]


def others(run, row):
    """[(name, solid)] of all that the arm has to keep clear of at a row."""
    carried = held(run, row)
    named = [(obstacle_name(run, i), one) for i, one in enumerate(solids.obstacle_solids(run, row)) if i not in carried]
    named += [(SURROUNDINGS, one) for one in solids.surroundings(run)]
    return named + [(OTHER_ARM, one) for other in run.others for one in solids.arm_solids(other, row)]


def nearest(run, row, clearance_m):
    """(name, pair of points) of what has the recorded clearance at a row; the pair is None if none has it.

    The points of an overlap are near the deepest ones, so that its depth is not compared.
    """
    recorded = [(obstacle_name(run, i), run.columns[f"o{i + 1}_clearance_m"][row]) for i in range(obstacle_count(run))]
    recorded.append((OTHER_ARM, run.columns["neighbour_clearance_m"][row]))
    names = [name for name, value_m in recorded if abs(value_m - clearance_m) < 1e-9]
    there = [(name, one) for name, one in others(run, row) if not names or name in names]
    links = solids.arm_solids(run, row) + [solids.obstacle_solids(run, row)[i] for i in held(run, row)]
    found = [(*solids.nearest_points(link, one), name) for name, one in there for link in links
             if solids.may_be_within(link, one, clearance_m + SAME_PAIR_M)]
    distance_m, pair, name = min(found, key=lambda entry: abs(entry[0] - clearance_m), default=(np.inf, None, ""))
    if abs(distance_m - clearance_m) > SAME_PAIR_M and not max(distance_m, clearance_m) < 0:
        return names[0] if names else "", None
    return name, pair


def drawn_row(run):
    """The row at which the scene is drawn: where the arm is closest, else the middle of the run."""
    moment = closest(run)
    return moment.row if moment else len(run.columns["t_s"]) // 2


def at_target(run):
    """[(from s, to s)] when the tool is at its target."""
    t = run.columns["t_s"]
    edges = np.flatnonzero(np.diff(np.r_[False, run.columns["target_distance_m"] < ARRIVED_M, False]))
    return [(t[first], t[end - 1]) for first, end in zip(edges[::2], edges[1::2])]


def arrives(run):
    return bool(run.columns["target_distance_m"][-1] < ARRIVED_M)


def off_at_grasp(run):
    """m from tool to target when the tool is told to hold something: the scenario does so by time. None without."""
    times_s = [step["at_s"] for step in run.scenario.get("grasp", []) if step.get("held")]
    return run.columns["target_distance_m"][np.searchsorted(run.columns["t_s"], times_s[0])] if times_s else None

