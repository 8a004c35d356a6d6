"""What a run came to: how near the arm came to what, whether it touched it, and whether it arrived."""
from typing import NamedTuple

import numpy as np

import solids
from runs import LAWS

ARRIVED_M = 0.01       # an error at the end that counts as arrived (docs/results.md)
SAME_PAIR_M = 0.005    # a pair of solids whose distance differs by less from the recorded clearance can be its pair
SLOW_MPS = 0.05        # from which on an obstacle needs the full clearance (docs/controller.md)
OTHER_ARM, SURROUNDINGS = "the other arm", "the surroundings"


class Closest(NamedTuple):
    row: int            # of the first contact, else of the least clearance
    clearance_m: float  # to obstacles, surroundings and other arms
    contact: bool
    name: str           # of what is touched or nearest, "" if unknown
    pair: tuple         # 3, m, world frame: the point of the arm, that of the other solid; None if unknown


def length(value_m):
    if value_m < 1e-4:
        return "below 0.1 mm"
    return f"{value_m * 1000:.1f} mm" if value_m < 0.1 else f"{value_m:.3f} m"


def obstacle_count(run):
    return len(run.scenario["obstacles"])


def obstacle_name(run, number):
    """number: from 0."""
    entry = run.scenario["obstacles"][number]
    return entry.get("body") or f"{'person' if entry.get('kind') == 'person' else 'obstacle'} {number + 1}"


def bodies(run):
    """The numbers of the obstacles, from 0, as lists: the parts of a person belong together."""
    found = {}
    for number, entry in enumerate(run.scenario["obstacles"]):
        found.setdefault(entry.get("body", number), []).append(number)
    return list(found.values())


def has_resting(run):
    """Whether the arm may pass something at less than the full clearance, because it rests or is slow."""
    return bool(solids.surroundings(run)) or any(
        entry.get("kind") != "person" and np.linalg.norm(entry.get("velocity_mps", (0, 0, 0))) < SLOW_MPS
        for entry in run.scenario["obstacles"])


def clearance(run):
    """m, at every row, to obstacles, surroundings and other arms."""
    return np.minimum(run.columns["clearance_m"], run.columns["neighbour_clearance_m"])


def closest(run):
    """The first contact, else the least clearance; None where there is nothing to touch."""
    values_m = clearance(run)
    if not np.isfinite(values_m).any():
        return None
    touching = np.flatnonzero(values_m < 0)
    row = int(touching[0] if touching.size else np.argmin(values_m))
    name, pair = nearest(run, row, values_m[row])
    return Closest(row, values_m[row], bool(touching.size), name, pair)


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
    arm = solids.arm_solids(run, row) + [solids.obstacle_solids(run, row)[i] for i in held(run, row)]
    found = [(*solids.nearest_points(link, one), name) for name, one in there for link in arm]
    distance_m, pair, name = min(found, key=lambda entry: abs(entry[0] - clearance_m), default=(np.inf, None, ""))
    if abs(distance_m - clearance_m) > SAME_PAIR_M and not max(distance_m, clearance_m) < 0:
        return names[0] if names else "", None
    return name, pair


def drawn_row(run):
    """The row at which the scene is drawn: where the arm is closest, else the middle of the run."""
    moment = closest(run)
    return moment.row if moment else len(run.columns["t_s"]) // 2


def approach(run):
    """How near the arm came to what and when, or what it touched."""
    moment = closest(run)
    if not moment:
        return f"no obstacles (drawn: {run.columns['t_s'][drawn_row(run)]:.2f} s)"
    at = f"at {run.columns['t_s'][moment.row]:.2f} s (drawn)"
    if moment.contact:
        return f"touches {moment.name} {at}, at worst {-clearance(run).min() * 1000:.1f} mm deep"
    return f"nearest: {moment.clearance_m * 1000:.1f} mm to {moment.name or 'what it may not touch'} {at}"


def ending(run):
    return f"ends {length(run.columns['target_distance_m'][-1]).replace('below', 'less than')} from the target"


def verdict(run):
    """Contact and arrival in a few words."""
    own = run.touching_itself().any()
    if closest(run) and closest(run).contact:
        touched = "contact" + (", links touch each other" if own else "")
    else:
        touched = "links touch each other" if own else "no contact"
    arrives = run.columns["target_distance_m"][-1] < ARRIVED_M
    name = LAWS[run.law]
    return f"{name[0].upper()}{name[1:]}: {touched}, {'arrives' if arrives else 'does not arrive'}"
