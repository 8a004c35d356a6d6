"""Moving obstacles to send. A crowd is a function from seconds since its start to a list of obstacle_t."""
import csv
import math
import random

from wire import finite, obstacle_id, obstacle_t


def obstacle(number, shape, size, position, velocity, about_y=(0.0, 0.0)):
    """about_y: angle about the y axis, rad, and its rate, rad/s."""
    made = obstacle_t()
    made.id, made.shape, made.size = number, shape, [*size, 0.0, 0.0][:3]
    made.position, made.velocity = list(position), list(velocity)
    made.quaternion = [math.cos(about_y[0] / 2), 0.0, math.sin(about_y[0] / 2), 0.0]
    made.angular_velocity = [0.0, about_y[1], 0.0]
    return made


def sphere(number, x, y, z, radius, vx=0.0, vy=0.0, vz=0.0):
    return obstacle(number, obstacle_t.SPHERE, [radius], [x, y, z], [vx, vy, vz])


def radius(text):
    """The controller rejects a whole set with a negative radius in it, hence the check here."""
    if (value := finite(text)) < 0.0:
        raise ValueError(f"radius {text} is below 0")
    return value


def straight(spheres):
    """Spheres of constant velocity, each given by seven numbers: centre, radius, velocity."""
    return lambda t: [sphere(i, *(p + v * t for p, v in zip(s, s[4:])), *s[3:]) for i, s in enumerate(spheres)]


def wandering(count, seed):
    """Spheres of 5 cm radius that oscillate about random points near the arm, up to about 0.4 m/s along each axis."""
    generator = random.Random(seed)
    oscillations = [[(generator.uniform(*interval), generator.uniform(0.1, 0.3), generator.uniform(0.3, 1.3),
                      generator.uniform(0, 6.28))
                     for interval in ((-0.9, 0.9), (-0.9, 0.9), (0.4, 1.2))] for _ in range(count)]

    def at(t):
        return [sphere(i, *(c + a * math.sin(w * t + p) for c, a, w, p in axes), 0.05,
                       *(a * w * math.cos(w * t + p) for c, a, w, p in axes)) for i, axes in enumerate(oscillations)]
    return at


def from_csv(file):
    """Columns t_s, id, x_m, y_m, z_m, radius_m: spheres on straight lines from row to row, at rest after the last."""
    tracks = {}
    with open(file, newline="") as stream:
        rows = csv.DictReader(stream)
        for row in rows:
            try:
                if None in row.values():
                    raise ValueError("too few columns")
                t_s, *centre = (finite(row[name]) for name in ("t_s", "x_m", "y_m", "z_m"))
                point = [*centre, radius(row["radius_m"])]
                tracks.setdefault(obstacle_id(row["id"]), []).append((t_s, point))
            except (TypeError, ValueError) as error:
                raise ValueError(f"{file}, line {rows.line_num}: {error}") from None
    if not tracks:  # an empty set would report to the controller that there are no obstacles
        raise ValueError(f"{file}: no rows")
    tracks = {number: sorted(track) for number, track in tracks.items()}
    return lambda t: [sphere(number, *on_track(track, t)) for number, track in tracks.items()]


def on_track(track, t):
    """Centre, radius and velocity."""
    for (t0, a), (t1, b) in zip(track, track[1:]):
        if t0 <= t < t1:
            share = (t - t0) / (t1 - t0)
            return *(p + share * (q - p) for p, q in zip(a, b)), *((q - p) / (t1 - t0) for p, q in zip(a[:3], b))
    return *(track[0] if t < track[0][0] else track[-1])[1], 0.0, 0.0, 0.0


# The limbs of a person: radius m, length between the cap centres m, upper end (sideways, up) m, swing amplitude rad.
LIMBS = [(0.15, 0.40, 0.00, 1.35, 0.0), (0.07, 0.75, 0.10, 0.85, 0.45), (0.07, 0.75, -0.10, 0.85, -0.45),
         (0.05, 0.50, 0.23, 1.35, -0.5), (0.05, 0.50, -0.23, 1.35, 0.5)]
HEAD_M, HEAD_UP_M = 0.12, 1.62
STEPS_RADPS, WALK_RADPS = 5.0, 0.5


def walking(y_m=0.9, reach_m=1.2):
    """A person who walks back and forth along x past the arm, with swinging arms and legs: five capsules and a head."""
    def at(t):
        x, vx = reach_m * math.sin(WALK_RADPS * t), reach_m * WALK_RADPS * math.cos(WALK_RADPS * t)
        parts = [limb(i, x, vx, y_m, t, *one) for i, one in enumerate(LIMBS)] + \
                [sphere(len(LIMBS), x, y_m, HEAD_UP_M, HEAD_M, vx)]
        for part in parts:
            part.kind = obstacle_t.PERSON
        return parts
    return at


def limb(number, x, vx, y, t, radius, length, side, up, swing):
    angle, rate = swing * math.sin(STEPS_RADPS * t), swing * STEPS_RADPS * math.cos(STEPS_RADPS * t)
    half = length / 2
    centre = [x - half * math.sin(angle), y + side, up - half * math.cos(angle)]
    velocity = [vx - half * rate * math.cos(angle), 0.0, half * rate * math.sin(angle)]
    return obstacle(number, obstacle_t.CAPSULE, [radius, length], centre, velocity, (angle, rate))
