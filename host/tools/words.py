"""The outcome of a run in words, for figures."""
import numpy as np

import outcome
from runs import LAWS

SHORTEST_STAY_S = 0.1  # at the target
APPROACHING_M, LAST_S = 0.01, 1.0  # a tool that came so much nearer in the last time is still approaching


def length(value_m):
    if value_m < 1e-4:
        return "below 0.1 mm"
    return f"{value_m * 1000:.1f} mm" if value_m < 0.1 else f"{value_m:.3f} m"


def approach(run):
    """How near the arm came to what and when, or what it touched; one or two lines."""
    moment = outcome.closest(run)
    if not moment:
        return f"no obstacles (drawn: {run.columns['t_s'][outcome.drawn_row(run)]:.2f} s)"

    def at(row):
        return f"at {run.columns['t_s'][row]:.2f} s" + " (drawn)" * (row == moment.row)
    nearest_one = outcome.least(run, outcome.clearance(run))
    if nearest_one.contact:
        return (f"touches {moment.name} {at(moment.row)}\n"
                f"deepest: {-nearest_one.clearance_m * 1000:.1f} mm in {nearest_one.name} {at(nearest_one.row)}")
    text = (f"nearest: {nearest_one.clearance_m * 1000:.1f} mm to {nearest_one.name or 'what it may not touch'} "
            f"{outcome.slow_speed(run, nearest_one.name)}{at(nearest_one.row)}")
    if moment.contact:
        return f"links touch each other {at(moment.row)}\n{text}"
    if moment.row != nearest_one.row:
        text += f"\nnearest of what moves: {moment.clearance_m * 1000:.1f} mm to {moment.name} {at(moment.row)}"
    return text


def missing(run):
    """How far the tool is from its target at the end, and what it was before."""
    t, distance_m = run.columns["t_s"], run.columns["target_distance_m"]
    text = f"{length(distance_m[-1]).replace('below', 'less than')} from the target at the end"
    stays = [end_s for start_s, end_s in outcome.at_target(run) if end_s - start_s >= SHORTEST_STAY_S]
    if not outcome.arrives(run) and stays:
        return f"at the target until {stays[-1]:.2f} s, {text}"
    before_m = distance_m[np.searchsorted(t, t[-1] - LAST_S)]
    return text + ", still approaching" * (not outcome.arrives(run) and bool(before_m - distance_m[-1] > APPROACHING_M))


def ending(run):
    off_m = outcome.off_at_grasp(run)
    if off_m is None or off_m < outcome.ARRIVED_M:
        return missing(run)
    return f"{missing(run)}\ngrasps by the clock, {length(off_m)} away from where it should grasp"


def arrival(run):
    if outcome.arrives(run):
        stays = outcome.at_target(run)
        at_s = f"at {stays[-1][0]:.2f} s"
        return f"arrives {at_s}" if len(stays) == 1 else f"arrives again {at_s} and stays"
    return "arrives, but leaves again" if outcome.at_target(run) else "does not arrive"


def verdict(run):
    """Contact and arrival in a few words."""
    moment, own = outcome.closest(run), run.touching_itself().any()
    touched = ["contact"] * bool(moment and moment.contact and moment.name != outcome.LINKS)
    touched += ["links touch each other"] * bool(own)
    name = LAWS[run.law]
    return f"{name[0].upper()}{name[1:]}: {', '.join(touched) or 'no contact'}, {arrival(run)}"
