"""Answers at 100 digits for struts that are hard to solve: `python3 generate.py` (needs mpmath, takes minutes).

The formulation is none of the program's. Unknown are the position r of the lower ball joint, a quaternion q
for the knuckle's turn and the distance s by which the strut has slid:

    |r - p1|^2, |r - p2|^2            as in the design        arm
    |r + R(q) (p8 - p5) - p3|^2       as in the design        tie rod
    r + R(q) (p4 - p5 + s u) = p4     u along p7 - p6: strut, three equations
    |q|^2 = 1
    z of p10 = design + travel; or for a turn t of the arm about its unit axis e, from a to b = e x a,
    (r - p1) . (b cos t - a sin t) = 0

Eight equations in eight unknowns, solved by Newton's method with the Jacobian from forward differences of
1e-50 at 120 digits. A state is reached from the design position in steps along which the determinant keeps
its sign and Newton's first correction stays small against the step. Derivatives by the drive are central
differences of order four, sensitivities (of value, first and second derivative) central differences by the
hardpoint coordinate of the same, all with steps of 1e-18: their own errors are below 1e-40.
"""

import json
import os
import sys

from mpmath import cos, lu_solve, matrix, mp, mpf, nstr, pi, sin, sqrt, asin, atan2, det

mp.dps = 120
TINY = mpf(10) ** -50
STEP = mpf(10) ** -18
HERE = os.path.dirname(os.path.abspath(__file__))
POINTS = ["p5", "p6", "p7", "p8", "p9", "p10", "p11"]
NAMES = ["p%d" % i for i in range(1, 12)]


def add(a, b, f=1):
    return [x + f * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turned(q, v):
    """R(q) v for a unit quaternion."""
    w, axis = q[0], q[1:]
    t = [2 * c for c in cross(axis, v)]
    return add(add(v, t, w), cross(axis, t))


class Strut:
    def __init__(self, points):
        self.p = points
        p = points
        e = add(p["p2"], p["p1"], -1)
        e = [c / sqrt(dot(e, e)) for c in e]
        a = add(p["p5"], p["p1"], -1)
        a = add(a, e, -dot(a, e))
        self.arm = (a, cross(e, a))
        u = add(p["p7"], p["p6"], -1)
        self.u = [c / sqrt(dot(u, u)) for c in u]
        self.start = p["p5"] + [mpf(1), mpf(0), mpf(0), mpf(0), mpf(0)]

    def image(self, x, name):
        p = self.p
        if name == "p9":  # on the rod, which hangs in p4
            return add(p["p4"], turned(x[3:7], add(p["p9"], p["p4"], -1)))
        return add(x[:3], turned(x[3:7], add(p[name], p["p5"], -1)))

    def equations(self, x, drive, value, rack):
        p, r, q, s = self.p, x[:3], x[3:7], x[7]

        def longer(now, before):
            return dot(now, now) - dot(before, before)

        p3 = [p["p3"][0], p["p3"][1] + rack, p["p3"][2]]
        base = add(p["p4"], p["p5"], -1)
        strut = add(add(r, turned(q, add(base, self.u, s))), p["p4"], -1)
        if drive == "travel":
            driven = self.image(x, "p10")[2] - p["p10"][2] - value
        elif drive == "arm_delta":
            a, b = self.arm
            driven = dot(add(r, p["p1"], -1), add([cos(value) * c for c in b], a, -sin(value)))
        else:  # signed distance of p8 from the plane of p5, p4, p3, times twice the triangle's area
            d = add(p["p4"], r, -1)
            driven = dot(add(self.image(x, "p8"), r, -1), cross(d, add(p3, r, -1))) - value
        return [
            longer(add(r, p["p1"], -1), add(p["p5"], p["p1"], -1)),
            longer(add(r, p["p2"], -1), add(p["p5"], p["p2"], -1)),
            longer(add(self.image(x, "p8"), p3, -1), add(p["p8"], p["p3"], -1)),
            strut[0],
            strut[1],
            strut[2],
            dot(q, q) - 1,
            driven,
        ]

    def jacobian(self, x, *motion):
        f = self.equations(x, *motion)
        j = matrix(8, 8)
        for k in range(8):
            y = list(x)
            y[k] += TINY
            for i, g in enumerate(self.equations(y, *motion)):
                j[i, k] = (g - f[i]) / TINY
        return f, j

    def solve(self, x, *motion, limit=None):
        """The solution next to x; None if the first correction is larger than `limit`."""
        for i in range(30):
            f, j = self.jacobian(x, *motion)
            d = lu_solve(j, matrix(f))
            size = max(abs(c) for c in d)
            if limit is not None and i == 0 and size > limit:
                return None
            x = [a - b for a, b in zip(x, d)]
            if size < mpf(10) ** -95:
                return x
            if size > 10:
                break
        if limit is not None:
            return None
        raise ArithmeticError("Newton's method does not settle")

    def determinant(self, x, *motion):
        return det(self.jacobian(x, *motion)[1])

    def follow(self, x, drive, start, end):
        """From the solution x at `start`, a (value, rack), to `end`; steps halve where the path turns."""
        change = [b - a for a, b in zip(start, end)]
        at = lambda t: [a + t * c for a, c in zip(start, change)]
        here, step = mpf(0), mpf(1) / 8
        sign = self.determinant(x, drive, *start)
        while here < 1:
            there = min(mpf(1), here + step)
            # Predictor along the tangent. The derivative with respect to the motion is a difference quotient.
            f, j = self.jacobian(x, drive, *at(here))
            g = self.equations(x, drive, *at(here + TINY))
            v = lu_solve(j, matrix([(a - b) / TINY for a, b in zip(f, g)]))
            length = (there - here) * max(abs(c) for c in v)
            guess = [a + (there - here) * b for a, b in zip(x, v)]
            found = None
            if length < mpf("0.1"):
                found = self.solve(guess, drive, *at(there), limit=length / 10)
            now = self.determinant(found, drive, *at(there)) if found else mpf(0)
            if found and mpf("0.3") < now / sign < 3:
                x, here, sign, step = found, there, now, 2 * step
            else:
                step = (there - here) / 2
                if step < mpf(10) ** -25:
                    raise ArithmeticError("cannot be followed beyond %s" % nstr(at(here)[0], 20))
        return x

    def reach(self, drive, value, rack):
        x = self.start
        for start, end in (((0, 0), (0, rack)), ((0, rack), (value, rack))):
            if start != end:
                x = self.follow(x, drive, [mpf(c) for c in start], [mpf(c) for c in end])
        return x

    def outputs(self, x):
        values = [c for name in POINTS for c in self.image(x, name)]
        a = add(self.image(x, "p10"), self.image(x, "p11"), -1)
        a = [c / sqrt(dot(a, a)) for c in a]
        k = add(self.p["p4"], x[:3], -1)
        return values + [-asin(a[2]), atan2(a[0], a[1]), atan2(-k[1], k[2]), atan2(-k[0], k[2])]

    def series(self, x, drive, value, rack):
        """Outputs with first and second derivative by the drive."""
        y = [self.outputs(self.solve(x, drive, value + n * STEP, rack)) for n in (-2, -1, 0, 1, 2)]
        first = [(a - 8 * b + 8 * d - e) / (12 * STEP) for a, b, c, d, e in zip(*y)]
        second = [(-a + 16 * b - 30 * c + 16 * d - e) / (12 * STEP**2) for a, b, c, d, e in zip(*y)]
        return [y[2], first, second]


ANGLES = ["camber", "toe", "kpi", "caster"]
OUTPUTS = ["%s.%s" % (p, c) for p in POINTS for c in "xyz"] + ANGLES


def text(value, digits=34):
    return nstr(value, digits, min_fixed=-3, max_fixed=6)


def moved(points, name, axis, by):
    points = {k: list(v) for k, v in points.items()}
    points[name][axis] += by
    return points


def state(points, drive, value, rack, sensitivities):
    strut = Strut(points)
    value, rack = mpf(value), mpf(float(rack))
    x = strut.reach(drive, value, rack)
    found = strut.series(x, drive, value, rack)
    answer = {
        "drive": {"kind": drive, "value": text(value, 40), "rack": text(rack, 40)},
        "exists": True,
    }
    for key, values in zip(("positions", "d1", "d2"), found):
        answer[key] = {
            p: [text(c) for c in values[3 * i : 3 * i + 3]] for i, p in enumerate(POINTS)
        }
    answer["angles"] = {
        a: {"d%d" % k: text(values[21 + i]) for k, values in enumerate(found)}
        for i, a in enumerate(ANGLES)
    }
    if sensitivities:
        params, rows = [], []
        for name in NAMES:
            for axis in range(3):
                ends = []
                for sign in (1, -1):
                    other = Strut(moved(points, name, axis, sign * STEP))
                    ends.append(other.series(other.solve(list(x), drive, value, rack), drive, value, rack))
                params.append("%s.%s" % (name, "xyz"[axis]))
                rows.append([[(a - b) / (2 * STEP) for a, b in zip(*pair)] for pair in zip(*ends)])
        answer["sens"] = {"params": params, "outputs": OUTPUTS}
        for k in range(3):
            answer["sens"]["d%d" % k] = [[text(c, 24) for c in row[k]] for row in rows]
    return answer


def refusal(drive, value, limit):
    return {
        "drive": {"kind": drive, "value": text(value, 40), "rack": "0.0"},
        "exists": False,
        "limit": text(limit, 40),
    }


NOMINAL = {
    "p1": [0.12, 0.36, 0.195],
    "p2": [-0.26, 0.35, 0.205],
    "p3": [-0.11, 0.33, 0.243],
    "p4": [-0.035, 0.575, 0.85],
    "p5": [0.005, 0.705, 0.19],
    "p6": [-0.011, 0.623, 0.37],
    "p7": [-0.017, 0.611, 0.49],
    "p8": [-0.13, 0.69, 0.24],
    "p9": [-0.029, 0.587, 0.73],
    "p10": [0.0, 0.76, 0.3],
    "p11": [-0.0002, 0.66, 0.2991],
}


def exact(points):
    return {k: [mpf(float(c)) for c in v] for k, v in points.items()}


def with_points(**changes):
    return {**NOMINAL, **changes}


def half_turn():
    """The arm within a nanoradian of half a turn, where the tangent of half its angle is infinite."""
    near = float(pi) - 1e-9
    return NOMINAL, [("arm_delta", -near, 0, True), ("arm_delta", near, 0, False)], []


def coplanar_knuckle():
    """Every point of the knuckle, and the strut's mount, in the plane y = 0.7."""
    points = {k: list(v) for k, v in NOMINAL.items()}
    for name in ("p4", "p5", "p6", "p7", "p8", "p9", "p10", "p11"):
        points[name][1] = 0.7
    points["p11"][2] = 0.31
    points["p11"][0] = -0.1
    states = [("travel", 0.03, 0, True), ("travel", -0.03, 0, False), ("arm_delta", 0.05, 0, False)]
    return points, states, []


def ball_joint_on_strut_axis():
    """p5, p6, p7 and p4 on one line, exactly: whole multiples of 1/64."""
    points = with_points(
        p5=[0.0, 0.6875, 0.1875], p4=[-0.0625, 0.5625, 0.8125], p6=[-0.015625, 0.65625, 0.34375],
        p7=[-0.03125, 0.625, 0.5], p9=[-0.046875, 0.59375, 0.65625],
    )
    states = [("travel", 0.05, 0, True), ("travel", -0.08, 0.02, False), ("travel", 0.08, -0.02, False)]
    return points, states, []


def far_from_origin():
    """Ten kilometres from the origin along every axis; coordinates rounded there are the input."""
    away = {k: [c + d for c, d in zip(v, (1e4, -1e4, 1e4))] for k, v in NOMINAL.items()}
    return away, [("travel", 0.05, 0, True), ("travel", -0.08, 0.02, False), ("arm_delta", 0.1, 0, False)], []


def strut_points_1um():
    """p6 and p7 a micrometre apart; their direction is what the rounded coordinates say."""
    along = add(NOMINAL["p4"], NOMINAL["p6"], -1)
    length = sqrt(dot(along, along))
    points = with_points(p7=[float(a + 1e-6 * d / length) for a, d in zip(NOMINAL["p6"], along)])
    return points, [("travel", 0.05, 0, True), ("travel", -0.08, 0.02, False)], []


def planar():
    """Everything moves in parallel planes x = const: the tie rod runs beside the arm, as long as it."""
    points = with_points(
        p1=[0.125, 0.375, 0.203125], p2=[-0.25, 0.375, 0.203125], p3=[-0.125, 0.375, 0.203125],
        p4=[0.0, 0.5625, 0.84375], p5=[0.0, 0.703125, 0.1875], p6=[0.0, 0.625, 0.375],
        p7=[0.0, 0.609375, 0.5], p8=[-0.125, 0.703125, 0.1875], p9=[0.0, 0.59375, 0.609375],
        p10=[0.0, 0.765625, 0.296875], p11=[0.0, 0.65625, 0.296875],
    )
    strut = Strut(exact(points))

    def fold(delta):
        """The travel at which the wheel centre is highest or lowest, the arm turned by about delta."""
        x = strut.reach("arm_delta", delta, 0)
        while True:
            x = strut.solve(x, "arm_delta", delta, mpf(0))
            near = [strut.solve(x, "arm_delta", delta + n * STEP, mpf(0)) for n in (-2, -1, 0, 1, 2)]
            y = [strut.image(x, "p10")[2] for x in near]
            first = (y[0] - 8 * y[1] + 8 * y[3] - y[4]) / (12 * STEP)
            second = (-y[0] + 16 * y[1] - 30 * y[2] + 16 * y[3] - y[4]) / (12 * STEP**2)
            if abs(first / second) < mpf(10) ** -35:
                return y[2] - strut.p["p10"][2]
            delta -= first / second

    up, down = fold(mpf("-1.27")), fold(mpf("1.63"))
    print("  folds", nstr(up, 20), nstr(down, 20))
    states = [
        ("travel", 0.05, 0, True), ("travel", -0.1, 0, False), ("travel", 0.02, 0.01, False),
        ("arm_delta", -0.3, 0, False),
        ("travel", float(up) - 1e-9, 0, False), ("travel", float(down) + 1e-9, 0, False),
    ]
    beyond = [("travel", mpf(float(up) + 1e-9), up), ("travel", mpf(float(down) - 1e-9), down)]
    return points, states, beyond


def assemblies_2um():
    """p8 a micrometre from the plane of p5, p4, p3: its mirror image, two micrometres away, is another
    assembly of the same lengths at the same angle of the arm."""
    p = exact(NOMINAL)
    n = cross(add(p["p4"], p["p5"], -1), add(p["p3"], p["p5"], -1))
    n = [c / sqrt(dot(n, n)) for c in n]
    off = dot(add(p["p8"], p["p5"], -1), n)
    points = with_points(p8=[float(c) for c in add(p["p8"], n, -off - mpf("1e-6"))])
    strut = Strut(exact(points))
    # Arm angle at which the tie rod is at toggle: p8 is in the plane of p5, p4 and p3. The drive "w" of this solution is the
    # signed distance of p8 from this plane.
    zero = strut.equations(strut.start, "w", mpf(0), mpf(0))[7]
    x = strut.solve(strut.start, "w", mpf(0), mpf(0))
    a, b = strut.arm
    arm = add(x[:3], strut.p["p1"], -1)
    limit = atan2(dot(arm, b), dot(arm, a))
    distance = abs(dot(add(strut.p["p8"], strut.p["p5"], -1), n))
    print("  distance", nstr(distance, 10), "toggle at", nstr(limit, 20), "from", nstr(zero, 5))
    away = -1 if limit > 0 else 1
    states = [
        ("arm_delta", 0.0, 0, True), ("arm_delta", away * 1e-12, 0, False), ("arm_delta", away * 1e-9, 0, True),
        ("arm_delta", away * 1e-6, 0, False), ("arm_delta", away * 1e-3, 0, False), ("arm_delta", away * 0.1, 0, True),
        ("arm_delta", float(limit) / 2, 0, False),
    ]
    beyond = [("arm_delta", mpf(float(limit) * 2), limit), ("arm_delta", mpf(-away * 1e-3), limit)]
    return points, states, beyond


CASES = [
    assemblies_2um, planar, half_turn, coplanar_knuckle, ball_joint_on_strut_axis, far_from_origin,
    strut_points_1um,
]

for make in CASES:
    name = make.__name__.replace("_", "-")
    if len(sys.argv) > 1 and name not in sys.argv[1:]:
        continue
    print(name)
    points, states, beyond = make()
    answers = []
    for drive, value, rack, sensitivities in states:
        print("  ", drive, value, rack)
        answers.append(state(exact(points), drive, value, rack, sensitivities))
    answers += [refusal(*request) for request in beyond]
    case = {
        "case": name,
        "description": " ".join(make.__doc__.split()),
        "hardpoints": {k: [repr(float(c)) for c in v] for k, v in points.items()},
        "states": answers,
    }
    print("  done", name, flush=True)
    with open(os.path.join(HERE, name + ".json"), "w") as file:
        json.dump(case, file, indent=0)
        file.write("\n")
