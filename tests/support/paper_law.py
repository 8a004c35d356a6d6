#!/usr/bin/env python3
"""The paper's law for the LWA3 in NumPy, an independent reference for the C++, written from the paper notes alone.

  paper_law.py table                        the paper's three simulations, for each reading of V in X = V + F T
  paper_law.py simulate paper-c --csv FILE  one simulation with an ideal plant, in the columns of build/sim --csv
  paper_law.py cases --seed 1 --count 500   random states with the joint velocity that the law must compute, as CSV

"Item" refers to the items of the paper notes.

Columns of `cases`, one header line, SI units, base frame; all but the last are numbers:
  q1..q7, qd1..qd7                   measured joint position and velocity
  target_x..z, target_vx..vz         position and velocity of the target
  tracks_orientation                 1: the task is 6-D, target_q* and target_w* apply; 0: position only
  target_qw..qz, target_wx..wz       orientation (w x y z) and angular velocity of the target
  planned                            1: V of item 4 is planned_v; 0: V is the measured tool velocity
  planned_vx..vz                     X of the previous cycle (zero when not planned)
  obstacles                          0 to 4, number of obstacles (the columns of the others are zero)
  o1_x..z, o1_vx..vz, .. o4_vz       centre and velocity of each obstacle
  expect_qd1..expect_qd7             the law's joint velocity before any joint limit (item 9)
  expect_vx..vz                      X of item 4, clipped to v_max
  expect_beta, expect_damping        beta of item 8 and lambda of item 5
  expect_axis_distance               d_0 of item 7, -1 without obstacles
  kind                               what makes the state difficult, one of KINDS
The parameters are PARAMETERS, the start values of the configuration section `paper:`.
"""
import argparse
import csv
import sys

import numpy as np

PERIOD_S = 0.01
HOME_RAD = np.array([0, np.pi / 2, 0, -np.pi / 2, 0, 0, 0])
ALPHA_RAD = np.deg2rad([0, 90, -90, 90, -90, 90, -90])
OFFSET_M = [0.300, 0, 0.328, 0, 0.2765, 0, 0]
TOOL_M = 0.3372
RADII_M = 0.05 + 0.05  # obstacle and arm
RANK_TOLERANCE = 1e-6  # relative to the largest singular value; `cases` excludes states near it

PARAMETERS = dict(k_pos_per_s2=20.0, k_vel_per_s=8.94, k_rpos_m2ps2=0.5, k_rvel_m2ps2=0.1, rho_0_m=0.25, rho_v_m=0.25,
                  rho_min_m=0.02, v_max_mps=1.0, lambda_0=0.08, sigma_0=0.08, lambda_n=0.05, x_m_mps=0.5, d_m_m=0.3,
                  d_1_m=0.3, d_2_m=0.1, tool_velocity="measured", k_ori_per_s=5.0)
LIMITS = dict(velocity_radps=2.0, acceleration_radps2=10.0,
              upper_rad=np.array([6.25, 1.97, 6.25, 1.97, 6.25, 1.97, 6.25]))
LIMITS["lower_rad"] = -LIMITS["upper_rad"]

_THREE = [dict(position_m=[0.3, 0.2, 0.8], velocity_mps=[0.2, 0, 0], radius_m=0.05),
          dict(position_m=[0.1, 0.1, 0.8], velocity_mps=[0, 0.2, 0], radius_m=0.05),
          dict(position_m=[-0.1, 0.1, 0.8], velocity_mps=[0, 0, 0.2], radius_m=0.05)]
SCENARIOS = {
    "paper-a": dict(title="A", duration_s=2.3, obstacles=[],
                    target=dict(position_m=[0, 0.15, 1.0], velocity_mps=[0, 0.2, 0])),
    "paper-b": dict(title="B", duration_s=8.0, obstacles=_THREE,
                    target=dict(position_m=[0.4, 0.4, 0.8], velocity_mps=[0, 0, 0]),
                    published=dict(axis_distance_m=0.2154)),
    "paper-c": dict(title="C", duration_s=2.8, obstacles=_THREE,
                    target=dict(position_m=[0.1, 0.4, 0.8], velocity_mps=[0.2, 0, 0]),
                    published=dict(axis_distance_m=0.1711, final_distance_m=0.001)),
}


# The arm

def forward_kinematics(q_rad):
    """By Craig's D-H convention. Returns (axes 7x3, origins 7x3, tool point 3, tool rotation 3x3), base frame."""
    pose, axes, origins = np.eye(4), [], []
    for alpha, offset, q in zip(ALPHA_RAD, OFFSET_M, q_rad):
        c, s, ca, sa = np.cos(q), np.sin(q), np.cos(alpha), np.sin(alpha)
        pose = pose @ np.array([[c, -s, 0, 0], [s * ca, c * ca, -sa, -offset * sa],
                                [s * sa, c * sa, ca, offset * ca], [0, 0, 0, 1]])
        axes.append(pose[:3, 2])
        origins.append(pose[:3, 3])
    return np.array(axes), np.array(origins), pose[:3, 3] + TOOL_M * pose[:3, 2], pose[:3, :3]


def jacobian(arm, point, joints=7):
    """3x7: Jacobian of a point on the link that follows joint number `joints`."""
    axes, origins = arm[:2]
    columns = np.zeros((3, 7))
    columns[:, :joints] = np.cross(axes[:joints], point - origins[:joints]).T
    return columns


def moving_segments(arm):
    """(start, end, number of joints that move it) of upper arm, forearm and tool; the base column does not move."""
    origins, tool = arm[1], arm[2]
    return [(origins[0], origins[2], 3), (origins[2], origins[4], 5), (origins[4], tool, 7)]


def nearest_on(segment, point):
    start, along = segment[0], segment[1] - segment[0]
    return start + np.clip((point - start) @ along / (along @ along), 0, 1) * along


def axis_distances(arm, obstacles):
    """For each obstacle: the distances, m, of its centre to the axes of the moving segments."""
    return [[np.linalg.norm(nearest_on(s, o["p"]) - o["p"]) for s in moving_segments(arm)] for o in obstacles]


# The law. Obstacles are dicts of p, v; a target is p, v and, if the orientation is tracked, quaternion and w.

def attraction(target, tool, v_tool, k):                                                            # item 1
    return k["k_pos_per_s2"] * (target["p"] - tool) + k["k_vel_per_s"] * (target["v"] - v_tool)


def repulsion(obstacle, tool, v_tool, k):                                                       # items 2, 3
    away, relative = tool - obstacle["p"], obstacle["v"] - v_tool
    n = away / np.linalg.norm(away)
    rho = max(np.linalg.norm(away), k["rho_min_m"])
    force = np.zeros(3)
    if rho <= k["rho_0_m"]:
        force += k["k_rpos_m2ps2"] * (1 / rho - 1 / k["rho_0_m"]) * n
    if rho <= k["rho_v_m"] and relative @ n > 0:
        force += k["k_rvel_m2ps2"] * (1 / rho - 1 / k["rho_v_m"]) * relative / np.linalg.norm(relative)
    return force


def damping_squared(task_jacobian, k):                                                              # item 5
    smallest = np.linalg.svd(task_jacobian, compute_uv=False)[-1]
    return k["lambda_0"] ** 2 * (1 - smallest / k["sigma_0"]) ** 2 if smallest < k["sigma_0"] else 0.0


def damped_inverse(matrix, squared):
    return matrix.T @ np.linalg.inv(matrix @ matrix.T + squared * np.eye(len(matrix)))


def alpha_of(d_0, k):                                                                               # item 7
    return np.clip(1 - np.sin(np.pi * d_0 / (2 * k["d_m_m"])), 0, 1) if d_0 < k["d_m_m"] else 0.0


def beta_of(d_0, k):                                                                                # item 8
    if d_0 < k["d_2_m"]:
        return 1.0
    if d_0 >= k["d_1_m"]:
        return 0.0
    return 1 - np.sin(np.pi * (d_0 - k["d_2_m"]) / (2 * (k["d_1_m"] - k["d_2_m"])))


def rotation_of(quaternion):
    w, x, y, z = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rotation_vector(rotation):
    """Axis times angle of a rotation whose angle is below pi."""
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    sine, cosine = np.linalg.norm(skew) / 2, (np.trace(rotation) - 1) / 2
    return skew / 2 if sine < 1e-12 else skew / (2 * sine) * np.arctan2(sine, cosine)


def law(q_rad, qd_radps, target, obstacles, k, planned_v=None):
    """Joint velocity of item 9 before any limit, and a dict of intermediate terms."""
    arm = forward_kinematics(q_rad)
    tool = arm[2]
    task = jacobian(arm, tool)
    v_tool = task @ qd_radps
    force = attraction(target, tool, v_tool, k) + sum((repulsion(o, tool, v_tool, k) for o in obstacles), np.zeros(3))
    x = (v_tool if planned_v is None else planned_v) + force * PERIOD_S                             # item 4
    x *= min(1.0, k["v_max_mps"] / max(np.linalg.norm(x), 1e-300))
    nominal = x
    if "quaternion" in target:
        rotation_error = rotation_vector(rotation_of(target["quaternion"]) @ arm[3].T)
        task = np.vstack([task, arm[0].T])
        nominal = np.concatenate([x, target["w"] + k["k_ori_per_s"] * rotation_error])

    squared = damping_squared(task, k)
    tracking = damped_inverse(task, squared) @ nominal
    terms = dict(x=x, beta=0.0, damping=np.sqrt(squared), d_0=-1.0, tool=tool)
    if not obstacles:
        return tracking, terms
    d_0, a_0, centre, joints = min(((np.linalg.norm(a - o["p"]), a, o["p"], s[2]) for o in obstacles       # item 7
                                    for s in moving_segments(arm) for a in [nearest_on(s, o["p"])]),
                                   key=lambda candidate: candidate[0])
    x_0 = alpha_of(d_0, k) * k["x_m_mps"] * (a_0 - centre) / d_0
    null_space = np.eye(7) - np.linalg.pinv(task, rcond=RANK_TOLERANCE) @ task                      # item 6
    j_0, beta = jacobian(arm, a_0, joints), beta_of(d_0, k)
    deviation = damped_inverse(j_0 @ null_space, k["lambda_n"] ** 2) @ (x_0 - j_0 @ tracking)
    terms.update(beta=beta, d_0=d_0)
    return (1 - beta) * tracking + beta * deviation, terms                                          # item 9


def limited(qd_radps, q_rad, previous_radps, limits):
    """Item 10: one scale factor for the velocity limit, then acceleration limit and braking distance per joint."""
    top, step = limits["velocity_radps"], limits["acceleration_radps2"] * PERIOD_S
    qd = qd_radps * min(1.0, top / max(np.max(np.abs(qd_radps)), 1e-300))
    qd = np.clip(qd, previous_radps - step, previous_radps + step)
    distance = np.maximum([q_rad - limits["lower_rad"], limits["upper_rad"] - q_rad], 0)
    down, up = np.minimum(np.sqrt(2 * limits["acceleration_radps2"] * distance), distance / PERIOD_S)
    return np.clip(qd, -down, up)


# Simulation with an ideal plant

def columns_of(obstacle_count):
    """The header of build/sim --csv."""
    joints, xyz = range(1, 8), "xyz"
    names = ["t_s", *(f"q{j}_rad" for j in joints), *(f"qd{j}_radps" for j in joints),
             *(f"command_qd{j}_radps" for j in joints), *(f"tool_{a}_m" for a in xyz), *(f"target_{a}_m" for a in xyz),
             "target_distance_m", "clearance_m", "axis_distance_m"]
    for i in range(1, obstacle_count + 1):
        names += [*(f"o{i}_{a}_m" for a in xyz), f"o{i}_axis_distance_m", f"o{i}_clearance_m"]
    return names + ["mode", "cycle_time_s", "beta", "damping"]


def simulate(scenario, k=PARAMETERS, limits=LIMITS):
    """(column names, rows): a row per cycle from t = 0 to the duration inclusive, in the columns of build/sim --csv."""
    goal, *spheres = ((np.array(body["position_m"], float), np.array(body.get("velocity_mps", [0, 0, 0]), float))
                      for body in [scenario["target"], *scenario["obstacles"]])
    q, qd, planned_v, rows = np.array(scenario.get("start_rad", HOME_RAD), float), np.zeros(7), None, []
    for step in range(round(scenario["duration_s"] / PERIOD_S) + 1):
        t = step * PERIOD_S
        target = dict(p=goal[0] + goal[1] * t, v=goal[1])
        obstacles = [dict(p=p + v * t, v=v) for p, v in spheres]
        nominal, terms = law(q, qd, target, obstacles, k, planned_v)
        command = limited(nominal, q, qd, limits)
        distances = [min(d) for d in axis_distances(forward_kinematics(q), obstacles)]
        least = min(distances, default=np.inf)
        row = [t, *q, *qd, *command, *terms["tool"], *target["p"], np.linalg.norm(target["p"] - terms["tool"]),
               least - RADII_M, least]
        for obstacle, distance in zip(obstacles, distances):
            row += [*obstacle["p"], distance, distance - RADII_M]
        rows.append([*row, 2, 0.0, terms["beta"], terms["damping"]])
        q, qd = q + command * PERIOD_S, command
        planned_v = terms["x"] if k["tool_velocity"] == "planned" else None
    return columns_of(len(spheres)), rows


def table():
    readings = [("measured", {}), ("measured, k_pos 10, k_vel 6.32", dict(k_pos_per_s2=10.0, k_vel_per_s=6.32)),
                ("planned", dict(tool_velocity="planned"))]
    print("| | A, error at 2.3 s | B, least distance; error at 8 s | C, least distance; error at 2.8 s |")
    print("|---|---|---|---|")
    for name, changes in readings:
        error_m, least_m = {}, {}
        for key, scenario in SCENARIOS.items():
            names, rows = simulate(scenario, PARAMETERS | changes)
            error_m[key] = rows[-1][names.index("target_distance_m")]
            least_m[key] = min(row[names.index("axis_distance_m")] for row in rows)
        print(f"| {name} | {error_m['paper-a'] * 1e3:.2f} mm "
              f"| {least_m['paper-b']:.4f} m; {error_m['paper-b'] * 1e3:.3f} mm "
              f"| {least_m['paper-c']:.4f} m; {error_m['paper-c'] * 1e3:.2f} mm |")


# Random states for the check of the C++

KINDS = ["anywhere", "home", "near home", "stretched", "nearly stretched", "upright", "obstacle at link",
         "obstacle at tool", "obstacle on tool", "fast", "planned", "orientation", "orientation at home",
         "orientation and obstacles", "far target", "crossing d_1"]


def random_unit(random, size=3):
    vector = random.normal(size=size)
    return vector / np.linalg.norm(vector)


def draw(random, kind):
    """A random state of a kind: (q, qd, target, obstacles, planned V or None)."""
    q = random.uniform(-0.8, 0.8, 7) * LIMITS["upper_rad"]
    qd = random.uniform(-1, 1, 7) * (2.0 if kind == "fast" else 0.5)
    if "home" in kind:
        q = HOME_RAD + (random.normal(size=7) * 0.05 if kind == "near home" else 0)
        qd = qd * 0 if kind != "near home" else qd
    if "stretched" in kind:
        q[[3, 5]] = random.choice([-1, 1], 2) * random.uniform(1e-3, 0.03, 2) if kind == "nearly stretched" else 0
    if kind == "upright":
        q[[1, 3, 5]] = 0
    arm = forward_kinematics(q)
    far = 3.0 if kind == "far target" else 0.4
    target = dict(p=arm[2] + random_unit(random) * random.uniform(0, far),
                  v=random_unit(random) * random.uniform(0, 0.3))
    if "orientation" in kind:
        target.update(quaternion=random_unit(random, 4), w=random.normal(size=3) * 0.2)
    obstacles = [] if kind in ("orientation", "orientation at home") and random.random() < 0.5 else [
        dict(p=random.uniform([-0.8, -0.8, 0], [0.8, 0.8, 1.3]), v=random_unit(random) * random.uniform(0, 1))
        for _ in range(random.integers(0, 5))]
    near_m = {"obstacle at link": (0.01, 0.1), "obstacle at tool": (0.02, 0.25), "obstacle on tool": (0.001, 0.02),
              "crossing d_1": (0.1, 0.32)}.get(kind)
    if near_m:
        segment = moving_segments(arm)[random.integers(0, 3)]
        point = arm[2] if "tool" in kind else segment[0] + random.random() * (segment[1] - segment[0])
        p = point + random_unit(random) * random.uniform(*near_m)
        obstacles = [dict(p=p, v=random_unit(random) * random.uniform(0, 1)), *obstacles[:3]]
    planned_v = random_unit(random) * random.uniform(0, 1.2) if kind == "planned" else None
    return q, qd, target, obstacles, planned_v


def well_defined(q, qd, target, obstacles):
    """False if two results are equally correct: a tie for the nearest point, or a singular value at a threshold."""
    arm = forward_kinematics(q)
    task = jacobian(arm, arm[2])
    if "quaternion" in target:
        if np.linalg.norm(rotation_vector(rotation_of(target["quaternion"]) @ arm[3].T)) > np.pi - 0.05:
            return False
        task = np.vstack([task, arm[0].T])
    values = np.linalg.svd(task, compute_uv=False)
    if np.any((values > 1e-9 * values[0]) & (values < 1e-4 * values[0])):
        return False
    for d in axis_distances(arm, obstacles):  # elbow and wrist each belong to two links, which makes a tie
        if any(abs(a - b) < 1e-6 for i, a in enumerate(d) for b in d[:i]):
            return False
    least = sorted(min(d) for d in axis_distances(arm, obstacles))
    if least and (least[0] < 1e-4 or (len(least) > 1 and least[1] - least[0] < 1e-6)):
        return False
    v_tool = jacobian(arm, arm[2]) @ qd
    return all(abs((o["v"] - v_tool) @ (arm[2] - o["p"])) > 1e-6 for o in obstacles)


def case(q, qd, target, obstacles, planned_v, kind):
    expected, terms = law(q, qd, target, obstacles, PARAMETERS, planned_v)
    empty = dict(p=np.zeros(3), v=np.zeros(3))
    padded = [*obstacles, *[empty] * (4 - len(obstacles))]
    return [*q, *qd, *target["p"], *target["v"], int("quaternion" in target), *target.get("quaternion", [1, 0, 0, 0]),
            *target.get("w", [0, 0, 0]), int(planned_v is not None), *(np.zeros(3) if planned_v is None else planned_v),
            len(obstacles), *(number for o in padded for part in (o["p"], o["v"]) for number in part),
            *expected, *terms["x"], terms["beta"], terms["damping"], terms["d_0"], kind]


def case_columns():
    joints, xyz = range(1, 8), "xyz"
    return [*(f"q{j}" for j in joints), *(f"qd{j}" for j in joints), *(f"target_{a}" for a in xyz),
            *(f"target_v{a}" for a in xyz), "tracks_orientation", *(f"target_q{a}" for a in "wxyz"),
            *(f"target_w{a}" for a in xyz), "planned", *(f"planned_v{a}" for a in xyz), "obstacles",
            *(f"o{i}_{part}{a}" for i in range(1, 5) for part in ("", "v") for a in xyz),
            *(f"expect_qd{j}" for j in joints), *(f"expect_v{a}" for a in xyz), "expect_beta", "expect_damping",
            "expect_axis_distance", "kind"]


def cases(seed, count):
    """`count` rows, the kinds in turn. Equal seeds give equal rows."""
    random = np.random.default_rng(seed)
    rows = []
    while len(rows) < count:
        kind = KINDS[len(rows) % len(KINDS)]
        state = draw(random, kind)
        if well_defined(*state[:4]):
            rows.append(case(*state, kind))
    return rows


def write(names, rows, stream):
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([repr(float(v)) if isinstance(v, float) else v for v in row] for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("table", help="print the table of the three simulations")
    one = commands.add_parser("simulate", help="run one simulation")
    one.add_argument("scenario", choices=SCENARIOS)
    one.add_argument("--tool-velocity", choices=["measured", "planned"], default="measured")
    one.add_argument("--csv", type=argparse.FileType("w"), default=sys.stdout, metavar="FILE")
    some = commands.add_parser("cases", help="print random states and the joint velocities of the law")
    some.add_argument("--seed", type=int, default=1)
    some.add_argument("--count", type=int, default=500)
    arguments = parser.parse_args()
    if arguments.command == "table":
        table()
    elif arguments.command == "simulate":
        write(*simulate(SCENARIOS[arguments.scenario], PARAMETERS | dict(tool_velocity=arguments.tool_velocity)),
              arguments.csv)
    else:
        write(case_columns(), cases(arguments.seed, arguments.count), sys.stdout)


if __name__ == "__main__":
    main()
