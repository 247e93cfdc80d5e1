//! Independent formulation with ten unknowns: position and quaternion of the axle, the angles of both knuckles about
//! their kingpins, and the difference of the travels. The equations are the lengths of six rods, the unit length of the
//! quaternion, both heights, and the plane ground.

use super::hyper::{Hyper, Point, cross, dot, minus, mirror, plus, times, unit};
use crate::solid::own::solve;
use crate::support::larger;

/// Number of unknowns: position, quaternion, both knuckle angles, half the difference of the travels.
const UNKNOWNS: usize = 10;
type Unknowns = [Hyper; UNKNOWNS];

/// Travels of both wheels.
#[derive(Clone, Copy, Debug)]
pub enum Travels {
    /// Both wheels stand on the plane.
    OnPlane,
    /// Left and right travel.
    Given(Hyper, Hyper),
}

/// Position of the axle on a plane ground.
#[derive(Clone, Copy, Debug)]
pub struct At {
    pub travels: Travels,
    pub heave: Hyper,
    pub roll: Hyper,
    /// Displacement of the steering gear.
    pub gear: Hyper,
}

/// Steered axle: points of the left half, and single points.
#[derive(Clone, Debug)]
pub struct World {
    pub points: Vec<(&'static str, Point)>,
    /// Points of the right half that are not mirror images, each with its offset from the mirror image.
    pub apart: Vec<(&'static str, [f64; 3])>,
    pub single: bool,
    pub radius: f64,
    /// Unit vector along which the steering gear moves.
    pub direction: [f64; 3],
    /// Camber and toe in the design position.
    pub angles: [f64; 2],
}

/// Wheel in a position, in the vehicle's axes.
#[derive(Clone, Copy, Debug)]
pub struct Wheel {
    pub centre: Point,
    /// Spin axis, pointing outboard.
    pub spin: Point,
    pub contact: Point,
    /// Kingpin: a point on the kingpin axis, and the upward direction of this axis.
    pub kingpin: [Point; 2],
}

pub struct Solved {
    pub wheels: [Wheel; 2],
    /// Axes of the axle along x and y.
    pub axle: [Point; 2],
    radius: f64,
    unknowns: Unknowns,
}

fn turned(q: &[Hyper], v: Point) -> Point {
    let scalar = q[0];
    let axis = [q[1], q[2], q[3]];
    let across = times(cross(axis, v), scalar.scaled(2.0));
    let square = scalar * scalar - dot(axis, axis);
    plus(
        plus(times(v, square), across),
        times(axis, dot(axis, v).scaled(2.0)),
    )
}

fn about([first, second]: [Point; 2], angle: Hyper, point: Point) -> Point {
    let axis = unit(minus(second, first));
    let lever = minus(point, first);
    let along = times(axis, dot(axis, lever));
    let rest = minus(lever, along);
    let turned = plus(
        times(rest, angle.cosine()),
        times(cross(axis, rest), angle.sine()),
    );
    plus(first, plus(along, turned))
}

/// Returns half the difference of two squared lengths, divided by the design length. It is 0 if the rod keeps its length.
fn excess(now: Point, was: Point) -> Hyper {
    (dot(now, now) - dot(was, was)).scaled(0.5) / dot(was, was).sqrt()
}

impl World {
    pub fn at(&self, name: &str) -> Point {
        self.points.iter().find(|(n, _)| *n == name).unwrap().1
    }

    /// Returns a point of one side.
    pub fn of(&self, side: usize, name: &str) -> Point {
        let point = self.at(name);
        if side == 0 {
            return point;
        }
        let own = self.apart.iter().find(|(n, _)| *n == name);
        let offset = own.map_or([0.0; 3], |(_, offset)| *offset);
        plus(mirror(point), offset.map(Hyper::constant))
    }

    fn spin_axis(&self, side: usize) -> Point {
        let [camber, toe] = self.angles;
        let left = [
            camber.cos() * toe.sin(),
            camber.cos() * toe.cos(),
            -camber.sin(),
        ];
        let left = left.map(Hyper::constant);
        if side == 0 { left } else { mirror(left) }
    }

    /// Returns the position of a point of the axle for these unknowns.
    fn on_axle(x: &Unknowns, point: Point) -> Point {
        plus(turned(&x[3..7], point), [x[0], x[1], x[2]])
    }

    fn on_knuckle(&self, x: &Unknowns, side: usize, point: Point) -> Point {
        let kingpin = ["kingpin_lower", "kingpin_upper"].map(|name| self.of(side, name));
        World::on_axle(x, about(kingpin, x[7 + side], point))
    }

    fn normal(roll: Hyper) -> Point {
        // The body rolls by this angle, so in body axes the ground normal rotates in the opposite direction.
        [Hyper::constant(0.0), roll.sine(), roll.cosine()]
    }

    fn wheel(&self, x: &Unknowns, side: usize, roll: Hyper) -> Wheel {
        let own = self.of(side, "wheel_centre");
        let centre = self.on_knuckle(x, side, own);
        let beside = self.on_knuckle(x, side, plus(own, self.spin_axis(side)));
        let spin = minus(beside, centre);
        let normal = World::normal(roll);
        let down = minus(times(spin, dot(spin, normal)), normal);
        let contact = plus(centre, times(unit(down), Hyper::constant(self.radius)));
        let [lower, upper] =
            ["kingpin_lower", "kingpin_upper"].map(|name| World::on_axle(x, self.of(side, name)));
        Wheel {
            centre,
            spin,
            contact,
            kingpin: [lower, minus(upper, lower)],
        }
    }

    fn residuals(&self, x: &Unknowns, at: &At) -> [Hyper; UNKNOWNS] {
        let link =
            |body: Point, own: Point| excess(minus(World::on_axle(x, own), body), minus(own, body));
        let ends = |side: usize, name: &str| {
            ["chassis", "axle"].map(|end| self.of(side, &format!("{name}_{end}")))
        };
        let [a, b] = ends(0, "lower_link");
        let [c, d] = ends(1, "lower_link");
        let [e, f] = ends(0, "upper_link");
        let [g, h] = if self.single {
            ends(0, "panhard")
        } else {
            ends(1, "upper_link")
        };
        let (end, knuckle) = (self.at("drag_link_body"), self.at("drag_link_knuckle"));
        let moved = plus(end, times(self.direction.map(Hyper::constant), at.gear));
        let tie = [0, 1].map(|side| self.of(side, "tie_rod_end"));
        let tie_now = [0, 1].map(|side| self.on_knuckle(x, side, tie[side]));
        let q = &x[3..7];
        let wheels = [0, 1].map(|side| self.wheel(x, side, at.roll));
        let height = |side: usize, travel: Hyper| {
            wheels[side].centre[2] - self.of(side, "wheel_centre")[2] - travel
        };
        let normal = World::normal(at.roll);
        let apart = dot(normal, minus(wheels[0].contact, wheels[1].contact));
        let (left, right, last) = match at.travels {
            Travels::OnPlane => (at.heave + x[9], at.heave - x[9], apart),
            Travels::Given(left, right) => (left, right, x[9]),
        };
        [
            link(a, b),
            link(c, d),
            link(e, f),
            link(g, h),
            excess(
                minus(self.on_knuckle(x, 0, knuckle), moved),
                minus(knuckle, end),
            ),
            excess(minus(tie_now[1], tie_now[0]), minus(tie[1], tie[0])),
            (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - Hyper::constant(1.0))
                .scaled(300.0),
            height(0, left),
            height(1, right),
            last,
        ]
    }

    /// Returns the Jacobian for these unknowns, with a row for each equation.
    fn jacobian(&self, x: &Unknowns, at: &At) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; UNKNOWNS]; UNKNOWNS];
        let plain = x.map(|c| Hyper::constant(c.value));
        let constant = |c: Hyper| Hyper::constant(c.value);
        let still = At {
            travels: match at.travels {
                Travels::OnPlane => Travels::OnPlane,
                Travels::Given(left, right) => Travels::Given(constant(left), constant(right)),
            },
            heave: Hyper::constant(at.heave.value),
            roll: Hyper::constant(at.roll.value),
            gear: Hyper::constant(at.gear.value),
        };
        for column in 0..UNKNOWNS {
            let mut moved = plain;
            moved[column].first = 1.0;
            for (row, residual) in rows.iter_mut().zip(self.plain().residuals(&moved, &still)) {
                row[column] = residual.first;
            }
        }
        rows
    }

    /// Returns the same axle without derivatives.
    fn plain(&self) -> World {
        let points = self.points.iter();
        World {
            points: points
                .map(|(name, p)| (*name, p.map(|c| Hyper::constant(c.value))))
                .collect(),
            ..self.clone()
        }
    }

    /// Makes one step of Newton's method with the Jacobian at `x`, for the values and all derivatives. Returns the size
    /// of the step.
    fn step(&self, x: &mut Unknowns, at: &At) -> f64 {
        let rows = self.jacobian(x, at);
        let residuals = self.residuals(x, at);
        let solved = |part: fn(&Hyper) -> f64| {
            let rows = rows.iter().zip(&residuals);
            let with = rows.map(|(row, residual)| {
                let mut row = row.clone();
                row.push(-part(residual));
                row
            });
            solve(with.collect())
        };
        let value = solved(|c| c.value);
        let first = solved(|c| c.first);
        let second = solved(|c| c.second);
        let both = solved(|c| c.both);
        for (k, x) in x.iter_mut().enumerate() {
            *x = *x
                + Hyper {
                    value: value[k],
                    first: first[k],
                    second: second[k],
                    both: both[k],
                };
        }
        value.iter().map(|c| c.abs()).fold(0.0, larger)
    }

    /// Solves for the position in small steps: the steering gear first, then heave and roll. Returns `None` if an
    /// iteration changes the rotation too much.
    pub fn solve(&self, at: &At) -> Option<Solved> {
        let mut x = [Hyper::constant(0.0); UNKNOWNS];
        x[3] = Hyper::constant(1.0);
        const STEPS: u32 = 6;
        for step in 1..=2 * STEPS {
            let part =
                |from: u32| (f64::from(step.saturating_sub(from)) / f64::from(STEPS)).min(1.0);
            let place = At {
                travels: match at.travels {
                    Travels::OnPlane => Travels::OnPlane,
                    Travels::Given(left, right) => {
                        let part = part(STEPS);
                        Travels::Given(left.scaled(part), right.scaled(part))
                    }
                },
                gear: at.gear.scaled(part(0)),
                heave: at.heave.scaled(part(STEPS)),
                roll: at.roll.scaled(part(STEPS)),
            };
            let before = x;
            for _ in 0..6 {
                self.step(&mut x, &place);
            }
            let turned = (7..9).map(|k| (x[k].value - before[k].value).abs());
            // NaN does not count as a small step.
            if !turned.into_iter().all(|turn| turn < 0.3) {
                return None;
            }
        }
        // The derivatives are exact after two steps with the Jacobian of the solution.
        let last = (0..4).map(|_| self.step(&mut x, at)).fold(0.0, |_, s| s);
        assert!(last < 1e-9, "{last:e}");
        Some(Solved {
            wheels: [0, 1].map(|side| self.wheel(&x, side, at.roll)),
            axle: [0, 1].map(|axis| {
                let mut along = [Hyper::constant(0.0); 3];
                along[axis] = Hyper::constant(1.0);
                turned(&x[3..7], along)
            }),
            radius: self.radius,
            unknowns: x,
        })
    }
}

impl World {
    /// Present position of a point of the axle.
    pub fn place_on_axle(&self, solved: &Solved, side: usize, name: &str) -> [f64; 3] {
        World::on_axle(&solved.unknowns, self.of(side, name)).map(|c| c.value)
    }

    /// Returns the present position of a point of a knuckle.
    pub fn place_on_knuckle(&self, solved: &Solved, side: usize, name: &str) -> [f64; 3] {
        self.on_knuckle(&solved.unknowns, side, self.of(side, name))
            .map(|c| c.value)
    }
}

impl Solved {
    /// Returns half the difference between the travels of the left and the right wheel.
    pub fn half_difference(&self) -> f64 {
        self.unknowns[9].value
    }

    /// Inboard distance of the kingpin from the contact point, on level ground under the wheel.
    fn scrub_radius(&self, side: usize) -> Hyper {
        let Wheel {
            centre,
            spin,
            kingpin: [on_it, along],
            ..
        } = self.wheels[side];
        let (zero, one) = (Hyper::constant(0.0), Hyper::constant(1.0));
        let up = [zero, zero, one];
        let down = unit(minus(times(spin, spin[2]), up));
        let contact = plus(centre, times(down, Hyper::constant(self.radius)));
        let share = (contact[2] - on_it[2]) / along[2];
        let there = plus(on_it, times(along, share));
        let outboard = unit([spin[0], spin[1], zero]);
        dot(minus(contact, there), outboard)
    }

    /// Quantities by their columns, with angles in degrees.
    pub fn quantities(&self) -> Vec<(String, Hyper)> {
        let degrees = 1f64.to_radians().recip();
        let mut all = Vec::new();
        let mut add = |name: &str, value: Hyper| all.push((name.to_owned(), value));
        let mut steers = [Hyper::constant(0.0); 2];
        for (side, word) in ["left", "right"].into_iter().enumerate() {
            let Wheel {
                centre,
                spin,
                kingpin: [on_it, along],
                ..
            } = self.wheels[side];
            let outward = if side == 0 { 1.0 } else { -1.0 };
            let toe = spin[0].angle(spin[1].scaled(outward));
            steers[side] = toe.scaled(-outward);
            let camber = -spin[2].angle((spin[0] * spin[0] + spin[1] * spin[1]).sqrt());
            let name = |stem: &str| format!("{word}_{stem}");
            add(&name("toe_deg"), toe.scaled(degrees));
            add(&name("steer_deg"), steers[side].scaled(degrees));
            add(&name("camber_deg"), camber.scaled(degrees));
            add(
                &name("caster_deg"),
                (-along[0]).angle(along[2]).scaled(degrees),
            );
            add(
                &name("kingpin_inclination_deg"),
                along[1].scaled(-outward).angle(along[2]).scaled(degrees),
            );
            add(&name("scrub_radius_mm"), self.scrub_radius(side));
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                add(&name(&format!("wheel_centre_{letter}_mm")), centre[axis]);
            }
            let share = (centre[2] - on_it[2]) / along[2];
            let axis_there = plus(on_it, times(along, share));
            add(
                &name("kingpin_offset_mm"),
                (centre[1] - axis_there[1]).scaled(outward),
            );
        }
        add(
            "mean_steer_deg",
            (steers[0] + steers[1]).scaled(0.5 * degrees),
        );
        let [forward, line] = self.axle;
        add("axle_steer_deg", (-line[0]).angle(line[1]).scaled(degrees));
        add(
            "pinion_angle_deg",
            forward[2].angle(forward[0]).scaled(degrees),
        );
        add("travel_left_mm", self.wheels[0].centre[2]);
        add("half_difference", self.unknowns[9]);
        all
    }
}
