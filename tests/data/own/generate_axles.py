"""Answers for axles whose sides differ: five links, and semi-trailing arms.

Both wheels are solved together in the vehicle's own axes (x forward, y left, z up), the right one with its true
coordinates: nothing is mirrored. Unknowns of a wheel on links: position of the wheel centre and a quaternion; of a wheel on
an arm: the arm's angle. Equations: lengths of the links, length of the quaternion, mean height of the wheel centres, and that the lowest
points of both discs over the ground are on one plane of the given roll. Newton's method on difference quotients at 60 digits; derivatives
are central differences of order four over 1e-9. 20 digits are stored.

    python3 generate_axles.py        writes five-link-axle.json and semi-trailing-axle.json beside itself
"""

import json
import os
from mpmath import mp, mpf, matrix, lu_solve, sqrt, sin, cos, atan2, asin, pi

mp.dps = 60
STEP = mpf(10) ** -9


def vec(p):
    return [mpf(repr(float(c))) if not isinstance(c, mpf) else c for c in p]


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def times(a, k):
    return [x * k for x in a]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return times(a, 1 / sqrt(dot(a, a)))


def rotated(q, v):
    """v turned by the quaternion q (not necessarily of length one)."""
    w, u = q[0], q[1:]
    t = times(cross(u, v), 2)
    return add(add(v, times(t, w)), cross(u, t))


def about(axis, angle, v):
    c, s = cos(angle), sin(angle)
    return add(add(times(v, c), times(cross(axis, v), s)), times(axis, dot(axis, v) * (1 - c)))


class Links:
    """A wheel on five links; unknowns: wheel centre, quaternion."""

    NAMES = ["upper_front_link", "upper_rear_link", "lower_front_link", "lower_rear_link", "toe_link"]

    def __init__(self, points):
        p = {name: vec(v) for name, v in points.items()}
        self.p = p
        self.centre = p["wheel_centre"]
        self.axis = unit(sub(self.centre, p["spindle_inner"]))
        self.count = 7
        self.start = list(self.centre) + [mpf(1), mpf(0), mpf(0), mpf(0)]

    def place(self, x, point):
        return add(x[:3], rotated(x[3:], sub(point, self.centre)))

    def residuals(self, x):
        found = [dot(x[3:], x[3:]) - 1]
        for name in self.NAMES:
            inner, outer = self.p[name + "_inner"], self.p[name + "_outer"]
            now, before = sub(self.place(x, outer), inner), sub(outer, inner)
            found.append((dot(now, now) - dot(before, before)) / 1000)
        return found

    def wheel(self, x):
        return x[:3], rotated(x[3:], self.axis)

    def carried(self, x, y, point):
        """Where the point that is at `point` in x is in y."""
        conjugate = [x[3], -x[4], -x[5], -x[6]]
        local = rotated(conjugate, sub(point, x[:3]))
        return add(y[:3], rotated(y[3:], local))


class Arm:
    """A wheel on an arm; unknown: the arm's angle."""

    def __init__(self, points):
        p = {name: vec(v) for name, v in points.items()}
        self.pivot = p["arm_pivot_inner"]
        self.hinge = unit(sub(p["arm_pivot_outer"], self.pivot))
        self.centre = p["wheel_centre"]
        self.axis = unit(sub(self.centre, p["spindle_inner"]))
        self.count = 1
        self.start = [mpf(0)]

    def residuals(self, x):
        return []

    def wheel(self, x):
        lever = about(self.hinge, x[0], sub(self.centre, self.pivot))
        return add(self.pivot, lever), about(self.hinge, x[0], self.axis)

    def carried(self, x, y, point):
        return add(self.pivot, about(self.hinge, y[0] - x[0], sub(point, self.pivot)))


def newton(f, x):
    for _ in range(60):
        r = f(x)
        h = mpf(10) ** -30
        jacobian = matrix(len(r), len(x))
        for j in range(len(x)):
            y = list(x)
            y[j] += h
            for i, (a, b) in enumerate(zip(f(y), r)):
                jacobian[i, j] = (a - b) / h
        step = lu_solve(jacobian, matrix([-v for v in r]))
        x = [a + b for a, b in zip(x, step)]
        if max(abs(v) for v in step) < mpf(10) ** -50:
            return x
    raise RuntimeError("no root")


class Axle:
    def __init__(self, kind, left, right, radius):
        self.wheels = [kind(left), kind(right)]
        self.radius = mpf(repr(float(radius)))

    def split(self, x):
        n = self.wheels[0].count
        return [x[:n], x[n:]]

    def contact(self, side, x, phi):
        n = [mpf(0), sin(phi), cos(phi)]
        centre, a = self.wheels[side].wheel(x)
        return sub(centre, times(unit(sub(n, times(a, dot(n, a)))), self.radius))

    def travel(self, side, x):
        wheel = self.wheels[side]
        return wheel.wheel(x)[0][2] - wheel.centre[2]

    def at(self, heave, phi, start):
        n = [mpf(0), sin(phi), cos(phi)]

        def f(x):
            parts = self.split(x)
            found = []
            for wheel, part in zip(self.wheels, parts):
                found += wheel.residuals(part)
            found.append((self.travel(0, parts[0]) + self.travel(1, parts[1])) / 2 - heave)
            heights = [dot(n, self.contact(s, parts[s], phi)) for s in (0, 1)]
            found.append(heights[0] - heights[1])
            return found

        return newton(f, start)

    def at_travel(self, side, travel, start):
        wheel = self.wheels[side]
        return newton(lambda x: wheel.residuals(x) + [self.travel(side, x) - travel], start)

    def simple(self, x, phi):
        n = [mpf(0), sin(phi), cos(phi)]
        out = {}
        for side, (name, sign) in enumerate([("left", 1), ("right", -1)]):
            part = self.split(x)[side]
            _, a = self.wheels[side].wheel(part)
            out["travel_" + name] = self.travel(side, part)
            out["camber_" + name] = -asin(a[2])
            out["camber_to_road_" + name] = -asin(dot(a, n))
            out["steer_" + name] = atan2(-sign * a[0], sign * a[1])
        return out

    def values(self, x, heave, phi):
        n, e = [mpf(0), sin(phi), cos(phi)], [mpf(0), cos(phi), -sin(phi)]
        out = self.simple(x, phi)
        parts = self.split(x)
        contacts = [self.contact(s, parts[s], phi) for s in (0, 1)]
        jacking = []
        for side, (name, sign) in enumerate([("left", 1), ("right", -1)]):
            z = self.travel(side, parts[side])
            at = lambda k: self.wheels[side].carried(
                parts[side], self.at_travel(side, z + k * STEP, parts[side]), contacts[side]
            )
            velocity = times(
                sub(times(sub(at(1), at(-1)), mpf(8)), sub(at(2), at(-2))), 1 / (12 * STEP)
            )
            jacking.append(sign * dot(velocity, e) / dot(velocity, n))
            out["jacking_coefficient_" + name] = jacking[side]
        track = dot(e, sub(contacts[0], contacts[1]))
        out["track"] = track
        out["roll_centre_height"] = track * jacking[0] * jacking[1] / (jacking[0] + jacking[1])
        out["roll_centre_lateral"] = track / 2 * (jacking[0] - jacking[1]) / (jacking[0] + jacking[1])
        out["force_roll_centre_height"] = track / 4 * (jacking[0] + jacking[1])
        step = mpf(10) ** -9
        at = lambda k: self.simple(self.at(heave, phi + k * step, x), phi + k * step)
        around = {k: at(k) for k in (-2, -1, 1, 2)}
        for name in ("left", "right"):
            for new, old in [("roll_camber_", "camber_"), ("roll_steer_", "steer_")]:
                old += name
                rise = 8 * (around[1][old] - around[-1][old]) - (around[2][old] - around[-2][old])
                out[new + name] = rise / (12 * step)
        out["mean_steer"] = (out["steer_left"] + out["steer_right"]) / 2
        return out


def mirrored(points, changes):
    right = {name: [x, -y, z] for name, (x, y, z) in points.items()}
    right.update(changes)
    return right


FIVE = {
    "upper_front_link_inner": [190, 500, 478], "upper_front_link_outer": [45, 655, 490],
    "upper_rear_link_inner": [-50, 420, 478], "upper_rear_link_outer": [-25, 645, 495],
    "lower_front_link_inner": [280, 480, 225], "lower_front_link_outer": [60, 695, 205],
    "lower_rear_link_inner": [-95, 330, 205], "lower_rear_link_outer": [-55, 705, 190],
    "toe_link_inner": [-180, 345, 262], "toe_link_outer": [-165, 700, 250],
    "wheel_centre": [0, 760, 310], "spindle_inner": [-0.2, 660, 308.2],
}
ARM = {
    "arm_pivot_inner": [260, 210, 270], "arm_pivot_outer": [400, 590, 262],
    "wheel_centre": [0, 735, 305], "spindle_inner": [-0.4, 640, 303.2],
}
CASES = {
    "five-link-axle": (Links, "five_link", FIVE,
                       {"toe_link_inner": [-180, -347, 262], "upper_rear_link_outer": [-24, -644, 497]}, 310),
    "semi-trailing-axle": (Arm, "semi_trailing_arm", ARM, {"arm_pivot_outer": [398, -592, 265]}, 305),
}
STATES = [(0, 0), (2, 0), (-3, 15), (1, -25)]

for name, (kind, topology, left, changes, radius) in CASES.items():
    axle = Axle(kind, left, mirrored(left, changes), radius)
    x0 = axle.wheels[0].start + axle.wheels[1].start
    states = []
    for roll, heave in STATES:
        # Roll angle as a double, as the program converts it from the degrees of the study.
        import math

        phi = mpf(math.radians(roll))
        x = x0
        for part in range(1, 5):
            x = axle.at(mpf(heave) * part / 4, phi * part / 4, x)
        values = axle.values(x, mpf(heave), phi)
        states.append({"roll_deg": roll, "heave": heave,
                       "values": {k: mp.nstr(v, 20) for k, v in values.items()}})
    text = {
        "made_by": "tests/data/own/generate_axles.py, mpmath at 60 digits", "topology": topology,
        "left": left, "right": changes, "radius": radius, "states": states,
    }
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), name + ".json")
    with open(path, "w") as out:
        json.dump(text, out, indent=1)
        out.write("\n")
    print(name, states[1]["values"]["roll_centre_height"])
