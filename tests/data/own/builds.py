"""Built mechanisms at 60 digits: `python3 builds.py` (needs mpmath and Python 3.11, takes some minutes).

Parts of sample studies are changed at random, points by up to 2 mm and lengths by up to 2 mm, and put together
with the wheel centre at its drawn height and 25 mm above. The formulation is none of the program's: the knuckle's
turn is a quaternion, a strut has its slide as an unknown, a hinge is two points on a line, the angle of a rocker is
a root of its rod's length; all is solved by Newton's method with differences of 1e-25 for a Jacobian, from the
drawn parts in ten steps. Derivatives by parts are central differences of order four with steps of 1e-10.
"""

import json
import os
import random
import tomllib

from mpmath import asin, atan2, cos, lu_solve, matrix, mp, mpf, nstr, pi, radians, sin, sqrt

mp.dps = 60
HERE = os.path.dirname(os.path.abspath(__file__))
STUDIES = os.path.join(HERE, "..", "..", "..", "studies")
AXES = "xyz"


def add(a, b, f=1):
    return [x + f * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def norm(a):
    return sqrt(dot(a, a))


def unit(a):
    n = norm(a)
    return [x / n for x in a]


def turned(q, v):
    w, axis = q[0], q[1:]
    t = [2 * c for c in cross(axis, v)]
    return add(add(v, t, w), cross(axis, t))


def newton(f, x):
    for _ in range(40):
        y = f(x)
        h = mpf(10) ** -25
        jacobian = matrix(len(y), len(x))
        for j in range(len(x)):
            moved = list(x)
            moved[j] += h
            for i, (a, b) in enumerate(zip(f(moved), y)):
                jacobian[i, j] = (a - b) / h
        step = lu_solve(jacobian, matrix([-c for c in y]))
        x = [a + b for a, b in zip(x, step)]
        if max(abs(c) for c in step) < mpf(10) ** -48:
            return x
    raise ValueError("Newton's method does not converge")


class Suspension:
    """Links, strut or hinge; arms; rockers; bodies: as the topology has them."""

    def __init__(self, name):
        with open(os.path.join(STUDIES, name + ".toml"), "rb") as file:
            study = tomllib.load(file)
        suspension = study["suspension"]
        self.points = {k: [mpf(c) for c in v] for k, v in suspension["hardpoints"].items()}
        topology = suspension["topology"]
        p = self.points
        self.links, self.arms, self.strut, self.hinge, self.rockers = {}, {}, None, None, []
        body = {}
        carried = "knuckle"
        if topology == "macpherson":
            self.origin = "lower_ball_joint"
            self.strut = ("strut_top", "strut_lower")
            arms = ["lower"]
        elif topology == "double_wishbone":
            self.origin = "lower_ball_joint"
            arms = ["lower", "upper"]
            carried = "lower"
        elif topology == "five_link":
            self.origin = "lower_rear_link_outer"
            arms = []
            for link in ["upper_front", "upper_rear", "lower_front", "lower_rear"]:
                self.links[link + "_link"] = (link + "_link_inner", link + "_link_outer")
            self.links["toe_link"] = ("toe_link_inner", "toe_link_outer")
        else:
            self.origin = "wheel_centre"
            self.hinge = ("arm_pivot_inner", "arm_pivot_outer")
            arms = []
        for arm in arms:
            joint = arm + "_ball_joint"
            self.arms[arm] = (arm + "_arm_front", arm + "_arm_rear", joint)
            for leg in ["front", "rear"]:
                self.links["%s_arm_%s" % (arm, leg)] = ("%s_arm_%s" % (arm, leg), joint)
        if "tie_rod_inner" in p:
            self.links["tie_rod"] = ("tie_rod_inner", "tie_rod_outer")
        rocker = "pushrod_inner" in p
        if rocker:
            ends = ("rocker_pivot_front", "rocker_pivot_rear", "pushrod_inner", "pushrod_outer")
            self.rockers.append(("pushrod",) + ends)
            body.update(pushrod_inner="pushrod", pushrod_outer=carried, spring_lower="pushrod")
        if "drop_link_inner" in p:
            ends = ("anti_roll_bar_inner", "anti_roll_bar_outer", "drop_link_inner", "drop_link_outer")
            self.rockers.append(("drop_link",) + ends)
            body.update(drop_link_inner="drop_link", drop_link_outer=carried)
        for point, what in suspension.get("bodies", {}).items():
            body[point] = {"rocker": "pushrod", "lower_arm": "lower"}.get(what, what)
        ground = {"strut_top", "spring_upper", "rocker_pivot_front", "rocker_pivot_rear"}
        ground |= {"anti_roll_bar_inner", "anti_roll_bar_outer"} | set(self.hinge or ())
        ground |= {inner for inner, _ in self.links.values()}
        for name in p:
            body.setdefault(name, "ground" if name in ground else "knuckle")
        if not rocker and "spring_lower" in p:
            body["spring_lower"] = carried
        self.body = body
        if "spindle_inner" in p:
            self.spin = None
        else:
            camber, toe = [radians(mpf(study["wheel"][k])) for k in ["static_camber", "static_toe"]]
            a_z = -sin(camber)
            self.spin = [cos(camber) * sin(toe), cos(camber) * cos(toe), a_z]
        self.lengths = {k: norm(add(p[a], p[b], -1)) for k, (a, b) in self.links.items()}
        for rod, _, _, inner, outer in self.rockers:
            self.lengths[rod] = norm(add(p[inner], p[outer], -1))

    def parameters(self):
        return [(point, axis) for point in self.points for axis in AXES] + [
            (length, None) for length in self.lengths
        ]

    def parts(self, changes, share=1):
        points = {k: list(v) for k, v in self.points.items()}
        lengths = dict(self.lengths)
        for (name, axis), by in changes.items():
            if axis is None:
                lengths[name] += share * by
            else:
                points[name][AXES.index(axis)] += share * by
        return points, lengths

    def solve(self, parts, travel, x):
        p, lengths = parts
        drawn = self.points

        def image(x, point):
            return add(x[:3], turned(x[3:7], add(point, p[self.origin], -1)))

        def f(x):
            rows = [dot(x[3:7], x[3:7]) - 1]
            rows.append(image(x, p["wheel_centre"])[2] - drawn["wheel_centre"][2] - travel)
            for name, (inner, outer) in self.links.items():
                d = add(image(x, p[outer]), p[inner], -1)
                rows.append((dot(d, d) - lengths[name] ** 2) / (2 * lengths[name]))
            if self.strut:
                top, lower = self.strut
                u = unit(add(drawn[top], p[lower], -1))
                mount = add(drawn[top], u, x[7])
                rows += add(image(x, mount), p[top], -1)
            if self.hinge:
                first, second = self.hinge
                rows += add(image(x, drawn[first]), p[first], -1)
                # The hinge axis and the axis in the carrier are parallel. The hinge axis has a large y component, so the z and
                # x components of the cross product suffice.
                along = add(p[second], p[first], -1)
                way = turned(x[3:7], add(drawn[second], drawn[first], -1))
                c = cross(along, way)
                rows += [c[2] / norm(along), c[0] / norm(along)]
            return rows

        x = newton(f, x)
        places = {}
        for name, where in self.body.items():
            if where == "ground":
                places[name] = p[name]
            elif where == "knuckle":
                places[name] = image(x, p[name])
        for name, where in self.body.items():
            if where in self.arms:
                front, rear, outer = self.arms[where]
                old = self.frame(drawn[front], drawn[rear], drawn[outer])
                new = self.frame(p[front], p[rear], places[outer])
                lever = add(p[name], drawn[outer], -1)
                place = places[outer]
                for a, b in zip(old, new):
                    place = add(place, b, dot(lever, a))
                places[name] = place
        for rod, first, second, inner, outer in self.rockers:
            e = unit(add(drawn[second], drawn[first], -1))
            lever = add(drawn[inner], drawn[first], -1)
            old = self.rocker_frame(e, lever)
            # Any frame about the new axis works, because the rod determines the rocker angle.
            new = self.rocker_frame(unit(add(p[second], p[first], -1)), lever)

            def place(point, angle):
                v = add(point, drawn[first], -1)
                a, b, c = [dot(v, axis) for axis in old]
                b, c = b * cos(angle) - c * sin(angle), b * sin(angle) + c * cos(angle)
                return add(add(add(p[first], new[0], a), new[1], b), new[2], c)

            far = places[outer]
            [angle] = newton(
                lambda x: [norm(add(place(p[inner], x[0]), far, -1)) - lengths[rod]], [mpf(0)]
            )
            for name, where in self.body.items():
                if where == rod:
                    places[name] = place(p[name], angle)
        if self.spin is None:
            axis = unit(add(places["wheel_centre"], places["spindle_inner"], -1))
        else:
            axis = turned(x[3:7], self.spin)
        return x, places, [-asin(axis[2]) * 180 / pi, atan2(axis[0], axis[1]) * 180 / pi]

    @staticmethod
    def frame(front, rear, outer):
        e = unit(add(rear, front, -1))
        lever = add(outer, front, -1)
        radial = unit(add(lever, e, -dot(lever, e)))
        return e, radial, cross(e, radial)

    @staticmethod
    def rocker_frame(e, lever):
        radial = unit(add(lever, e, -dot(lever, e)))
        return e, radial, cross(e, radial)

    def start(self):
        x = list(self.points[self.origin]) + [mpf(1), mpf(0), mpf(0), mpf(0)]
        return x + [mpf(0)] if self.strut else x


def main():
    random.seed(7)
    cases = []
    studies = [
        "macpherson_solve",
        "double_wishbone_rocker",
        "double_wishbone_pushrod",
        "five_link_solve",
        "semi_trailing_arm_solve",
    ]
    for study in studies:
        suspension = Suspension(study)
        for number in range(6):
            changes = {k: mpf(random.randint(-2000, 2000)) / 1000 for k in suspension.parameters()}
            x = suspension.start()
            for step in range(1, 11):
                x, _, _ = suspension.solve(suspension.parts(changes, mpf(step) / 10), 0, x)
            stations = []
            start = x
            for travel in [0, 25]:
                x, places, angles = suspension.solve(suspension.parts(changes), travel, start)
                stations.append(
                    {
                        "travel": travel,
                        "camber_deg": nstr(angles[0], 25),
                        "toe_deg": nstr(angles[1], 25),
                        "points": {k: [nstr(c, 25) for c in v] for k, v in places.items()},
                    }
                )
            keys = list(changes)
            by = []
            for key in random.sample(keys, 5):
                h = mpf(10) ** -10
                values = []
                for step in [-2, -1, 1, 2]:
                    moved = dict(changes)
                    moved[key] += step * h
                    # `solve` measures travel from the nominal height of the wheel centre, also for moved parts.
                    values.append(suspension.solve(suspension.parts(moved), 25, x)[2])
                slope = [
                    (a - 8 * b + 8 * c - d) / (12 * h) for a, b, c, d in zip(*values)
                ]
                by.append({"of": key[0], "axis": key[1], "camber_deg": nstr(slope[0], 25), "toe_deg": nstr(slope[1], 25)})
            cases.append(
                {
                    "study": study,
                    "changes": [
                        {"of": k[0], "axis": k[1], "by": nstr(v, 6)} for k, v in changes.items()
                    ],
                    "stations": stations,
                    "derivatives": by,
                }
            )
            print(study, number, flush=True)
    with open(os.path.join(HERE, "builds.json"), "w") as file:
        json.dump(cases, file, indent=0)
        file.write("\n")


main()
