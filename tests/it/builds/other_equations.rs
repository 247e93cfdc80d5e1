//! Independent solver for built mechanisms: other equations than the program's, with twice the precision.
//!
//! The unknowns are the position o of the wheel centre and the rotation q of the carrier as a quaternion. A strut adds the
//! displacement s of its mount from the nominal position along the strut axis. Each rocker adds the cosine c and the sine s
//! of its angle. The equations are:
//!
//! ```text
//! q.q = 1,  o.z = nominal + travel                 wheel centre at its height
//! (|place(outer) - place(inner)|^2 - l^2)/2l = 0   links, legs of arms, rods of rockers
//! place(mount) = top                               strut: mount = nominal top + s u, u the strut axis in the carrier
//! place(pivot) = pivot,  along x way = 0           hinge: a point of its line, and two components of a cross product
//! c^2 + s^2 = 1                                    rocker
//! ```
//!
//! place(p) is the moved position of a point. On the carrier it is o + q p q*. A point of an arm moves with the frame of the
//! arm's axis and outer joint, and a point of a rocker turns about the rocker's axis. The parts change in steps from the
//! nominal parts to the built parts. In each step, Newton's method in doubles solves the equations, with a Jacobian from
//! finite differences. Then residuals of twice the precision refine the solution to about 28 digits.
//!
//! This module reads hardpoints and topology from the study. From `hardpoint` it uses only numbers and vectors.

use hardpoint::bench::DoubleDouble;
use hardpoint::number::{Real, Scalar, Vector3};
use nalgebra::{DMatrix, DVector, Dyn, LU};

mod read;

type V<T> = Vector3<T>;
type Factors = LU<f64, Dyn, Dyn>;

/// 180 over pi.
const DEGREES: DoubleDouble = DoubleDouble {
    high: 57.295_779_513_082_32,
    low: -1.987_849_567_057_628e-15,
};
/// Number of length units by which points move if a component of the quaternion changes by 1.
const LEVER: f64 = 300.0;
/// Largest accepted correction of Newton's method.
const FARTHEST: f64 = 60.0;
/// Shortest step of the continuation from the nominal parts.
const SHORTEST: f64 = 1.0 / 8192.0;

/// Body to which a point is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum On {
    Body,
    Rack,
    Carrier,
    StrutRod,
    Arm(usize),
    Rocker(usize),
}

/// Nominal suspension.
pub struct Drawing {
    /// Hardpoints and extra points.
    pub names: Vec<String>,
    points: Vec<V<f64>>,
    on: Vec<On>,
    /// Links with two ends each, the body's end first. After the links, the rods of rockers with two ends each, the
    /// rocker's end first.
    pub members: Vec<(String, [usize; 2])>,
    /// Arms: front pivot, rear pivot and outer joint.
    arms: Vec<[usize; 3]>,
    /// Rockers: first and second pivot.
    rockers: Vec<[usize; 2]>,
    /// Strut: mount, lower point, and the upper point of the axis if the axis does not pass through the mount.
    strut: Option<(usize, usize, Option<usize>)>,
    hinge: Option<[usize; 2]>,
    centre: usize,
    /// Nominal spin axis: the index of its inboard point, or a unit vector if the study gives angles.
    pub spin: Result<usize, V<f64>>,
}

/// Dimensions of parts.
#[derive(Clone)]
pub struct Parts<T> {
    /// Points in the coordinates of their parts.
    pub points: Vec<V<T>>,
    /// Lengths of members.
    pub lengths: Vec<T>,
}

/// Displacements of wheel and rack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    pub travel: f64,
    pub rack: f64,
}

/// A solution.
pub struct Solved {
    x: Vec<DoubleDouble>,
    factors: Option<Factors>,
}

/// Values read from a solution.
pub struct Reading {
    /// Positions of all points.
    pub places: Vec<V<DoubleDouble>>,
    /// Camber and toe in degrees.
    pub angles: [DoubleDouble; 2],
}

impl<T: Scalar> Parts<T> {
    fn plain(&self) -> Parts<f64> {
        Parts {
            points: self.points.iter().map(|p| p.map(T::value)).collect(),
            lengths: self.lengths.iter().map(|l| l.value()).collect(),
        }
    }
}

impl Drawing {
    /// Returns true if the suspension has a rack that can move.
    pub fn has_rack(&self) -> bool {
        self.on.contains(&On::Rack)
    }

    /// The parts of the nominal design.
    pub fn drawn(&self) -> Parts<DoubleDouble> {
        let points: Vec<_> = self
            .points
            .iter()
            .map(|p| p.map(DoubleDouble::from))
            .collect();
        let length = |(_, [a, b]): &(String, [usize; 2])| (points[*a] - points[*b]).norm();
        Parts {
            lengths: self.members.iter().map(length).collect(),
            points,
        }
    }

    /// Positions of all points in the pose with the unknowns `x`.
    fn places<T: Scalar>(&self, parts: &Parts<T>, rack: f64, x: &[T]) -> Vec<V<T>> {
        let drawn = |id: usize| self.points[id].map(|c| x[0].constant(c));
        let carried = |p: V<T>| self.carried(parts, x, p);
        let mut places: Vec<V<T>> = Vec::with_capacity(parts.points.len());
        for (point, on) in parts.points.iter().zip(&self.on) {
            places.push(match (on, self.strut) {
                (On::Rack, _) => V::new(point.x, point.y + x[0].constant(rack), point.z),
                (On::Carrier, _) => carried(*point),
                (On::StrutRod, Some((top, ..))) => {
                    parts.points[top] + turned(x, *point - drawn(top))
                }
                _ => *point,
            });
        }
        for (number, [front, rear, outer]) in self.arms.iter().enumerate() {
            let made = frame(drawn(*rear) - drawn(*front), drawn(*outer) - drawn(*front));
            let lies = frame(
                places[*rear] - places[*front],
                places[*outer] - places[*front],
            );
            for (id, on) in self.on.iter().enumerate() {
                if *on == On::Arm(number) {
                    let lever = parts.points[id] - drawn(*outer);
                    places[id] = places[*outer] + between(lever, made, lies);
                }
            }
        }
        let turns = 7 + usize::from(self.strut.is_some());
        let rods = self.members.len() - self.rockers.len();
        for (number, [first, second]) in self.rockers.iter().enumerate() {
            let [c, s] = [x[turns + 2 * number], x[turns + 2 * number + 1]];
            let (_, [inner, _]) = self.members[rods + number];
            // Any frame about the rocker's axis works, because the rod determines the rocker angle.
            let arm = drawn(inner) - drawn(*first);
            let made = frame(drawn(*second) - drawn(*first), arm);
            let [e, radial, across] = frame(places[*second] - places[*first], arm);
            let lies = [e, radial * c + across * s, across * c - radial * s];
            for (id, on) in self.on.iter().enumerate() {
                if *on == On::Rocker(number) {
                    let lever = parts.points[id] - drawn(*first);
                    places[id] = places[*first] + between(lever, made, lies);
                }
            }
        }
        places
    }

    /// Position of a point of the carrier in the pose with the unknowns `x`.
    fn carried<T: Scalar>(&self, parts: &Parts<T>, x: &[T], point: V<T>) -> V<T> {
        V::new(x[0], x[1], x[2]) + turned(x, point - parts.points[self.centre])
    }

    fn residuals<T: Scalar>(&self, parts: &Parts<T>, at: Motion, x: &[T]) -> Vec<T> {
        let drawn = |id: usize| self.points[id].map(|c| x[0].constant(c));
        let places = self.places(parts, at.rack, x);
        let mut rows = Vec::with_capacity(x.len());
        rows.push(x[3] * x[3] + x[4] * x[4] + x[5] * x[5] + x[6] * x[6] - x[0].one());
        rows.push(x[2] - drawn(self.centre).z - x[0].constant(at.travel));
        for ((_, [a, b]), length) in self.members.iter().zip(&parts.lengths) {
            let d = places[*a] - places[*b];
            rows.push((d.dot(d) - *length * *length) / (*length + *length));
        }
        if let Some((top, lower, upper)) = self.strut {
            let end = upper.map_or_else(|| drawn(top), |upper| parts.points[upper]);
            let mount = drawn(top) + unit(end - parts.points[lower]) * x[7];
            rows.extend((self.carried(parts, x, mount) - places[top]).to_array());
        }
        if let Some([first, second]) = self.hinge {
            let pivot = self.carried(parts, x, drawn(first));
            rows.extend((pivot - places[first]).to_array());
            // The hinge axis has a large y component, so the x and z components of the cross product suffice.
            let along = unit(places[second] - places[first]);
            let c = along.cross(turned(x, drawn(second) - drawn(first)));
            rows.extend([c.x, c.z]);
        }
        let turns = 7 + usize::from(self.strut.is_some());
        for k in 0..self.rockers.len() {
            let [c, s] = [x[turns + 2 * k], x[turns + 2 * k + 1]];
            rows.push(c * c + s * s - c.one());
        }
        rows
    }

    fn jacobian(&self, parts: &Parts<f64>, at: Motion, x: &[f64]) -> Factors {
        let n = x.len();
        let mut jacobian = DMatrix::zeros(n, n);
        let mut moved = x.to_vec();
        for j in 0..n {
            let h = 0.003 / self.weight(j);
            moved[j] = x[j] + h;
            let ahead = self.residuals(parts, at, &moved);
            moved[j] = x[j] - h;
            let behind = self.residuals(parts, at, &moved);
            moved[j] = x[j];
            for (i, (a, b)) in ahead.into_iter().zip(behind).enumerate() {
                jacobian[(i, j)] = (a - b) / (2.0 * h);
            }
        }
        jacobian.lu()
    }

    /// Number of length units by which points move if the unknown changes by 1.
    fn weight(&self, unknown: usize) -> f64 {
        match unknown {
            0..3 => 1.0,
            7 if self.strut.is_some() => 1.0,
            _ => LEVER,
        }
    }

    /// Runs Newton's method until a correction is below `fine`. Uses the factors of a nearby Jacobian if the caller
    /// gives them.
    fn newton<T: Scalar>(
        &self,
        parts: &Parts<T>,
        at: Motion,
        x: &mut [T],
        factors: &mut Option<Factors>,
        fine: f64,
    ) -> bool {
        let plain = parts.plain();
        for _ in 0..12 {
            let rows = self.residuals(parts, at, x).into_iter().map(T::value);
            let rows = DVector::from_iterator(x.len(), rows);
            let factors_here = factors.get_or_insert_with(|| {
                let x: Vec<f64> = x.iter().map(|x| x.value()).collect();
                self.jacobian(&plain, at, &x)
            });
            let Some(step) = factors_here.solve(&rows) else {
                return false;
            };
            let mut moved = 0.0_f64;
            for (j, (x, step)) in x.iter_mut().zip(step.iter()).enumerate() {
                *x = *x - x.constant(*step);
                moved += (self.weight(j) * step).abs();
            }
            if moved.is_nan() || moved > FARTHEST {
                return false;
            }
            if moved < fine {
                return true;
            }
            if moved > 1e-3 {
                *factors = None;
            }
        }
        false
    }

    /// Changes the parts and the motion in steps from their start values to their end values. In each step, the Jacobian's
    /// determinant keeps its sign and changes by less than a factor of 1.7. Returns `None` if a step would be too short.
    fn follow(
        &self,
        mut x: Vec<f64>,
        way: impl Fn(f64) -> (Parts<f64>, Motion),
    ) -> Option<Vec<f64>> {
        let (parts, at) = way(0.0);
        let mut determinant = self.jacobian(&parts, at, &x).determinant();
        let (mut reached, mut step) = (0.0, 0.25_f64);
        while reached < 1.0 {
            let target = (reached + step).min(1.0);
            let (parts, at) = way(target);
            let mut next = x.clone();
            let goes = self.newton(&parts, at, &mut next, &mut None, 1e-8);
            let there = if goes {
                self.jacobian(&parts, at, &next).determinant()
            } else {
                f64::NAN
            };
            if (0.6..1.6).contains(&(there / determinant)) {
                (x, determinant, reached) = (next, there, target);
                step *= 2.0;
            } else {
                step *= 0.5;
                if step < SHORTEST {
                    return None;
                }
            }
        }
        Some(x)
    }

    /// Assembles parts at rest, starting from the nominal parts.
    pub fn put_together(&self, parts: &Parts<DoubleDouble>) -> Option<Solved> {
        let (drawn, built) = (self.drawn().plain(), parts.plain());
        let centre = self.points[self.centre];
        let mut start = vec![centre.x, centre.y, centre.z, 1.0, 0.0, 0.0, 0.0];
        start.extend(self.strut.map(|_| 0.0));
        for _ in &self.rockers {
            start.extend([1.0, 0.0]);
        }
        let rest = Motion {
            travel: 0.0,
            rack: 0.0,
        };
        let x = self.follow(start, |share| {
            let mix = |from: f64, to: f64| from + (to - from) * share;
            let points = drawn.points.iter().zip(&built.points);
            let lengths = drawn.lengths.iter().zip(&built.lengths);
            let parts = Parts {
                points: points
                    .map(|(a, b)| V::new(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z)))
                    .collect(),
                lengths: lengths.map(|(a, b)| mix(*a, *b)).collect(),
            };
            (parts, rest)
        })?;
        self.refined(parts, rest, x.into_iter().map(DoubleDouble::from).collect())
    }

    /// Moves a solution from rest to a displacement of wheel and rack.
    pub fn moved(&self, parts: &Parts<DoubleDouble>, rest: &Solved, to: Motion) -> Option<Solved> {
        let plain = parts.plain();
        let x = rest.x.iter().map(|x| x.value()).collect();
        let x = self.follow(x, |share| {
            let (travel, rack) = (share * to.travel, share * to.rack);
            (plain.clone(), Motion { travel, rack })
        })?;
        self.refined(parts, to, x.into_iter().map(DoubleDouble::from).collect())
    }

    /// Solves for parts that differ slightly from those of a given solution.
    pub fn beside(
        &self,
        parts: &Parts<DoubleDouble>,
        at: Motion,
        solved: &Solved,
    ) -> Option<Solved> {
        let (mut x, mut factors) = (solved.x.clone(), solved.factors.clone());
        self.newton(parts, at, &mut x, &mut factors, 1e-19)
            .then_some(Solved { x, factors })
    }

    fn refined(
        &self,
        parts: &Parts<DoubleDouble>,
        at: Motion,
        mut x: Vec<DoubleDouble>,
    ) -> Option<Solved> {
        let mut factors = None;
        self.newton(parts, at, &mut x, &mut factors, 1e-19)
            .then_some(Solved { x, factors })
    }

    pub fn read_off(&self, parts: &Parts<DoubleDouble>, at: Motion, of: &Solved) -> Reading {
        let places = self.places(parts, at.rack, &of.x);
        let axis = match self.spin {
            Ok(inner) => unit(places[self.centre] - places[inner]),
            Err(drawn) => turned(&of.x, drawn.map(DoubleDouble::from)),
        };
        Reading {
            angles: [-axis.z.asin() * DEGREES, axis.x.atan2(axis.y) * DEGREES],
            places,
        }
    }
}

/// Vector v rotated by the quaternion of the unknowns, with scalar part w and vector part a: v + 2 w a x v + 2 a x (a x
/// v).
fn turned<T: Scalar>(x: &[T], v: V<T>) -> V<T> {
    let axis = V::new(x[4], x[5], x[6]);
    let t = axis.cross(v) * x[0].constant(2.0);
    v + t * x[3] + axis.cross(t)
}

fn unit<T: Scalar>(v: V<T>) -> V<T> {
    v * (v.x.one() / v.norm())
}

/// Unit vectors of a frame: along the axis, from the axis towards the end of the lever, and perpendicular to the other
/// two.
fn frame<T: Scalar>(axis: V<T>, lever: V<T>) -> [V<T>; 3] {
    let e = unit(axis);
    let radial = unit(lever - e * e.dot(lever));
    [e, radial, e.cross(radial)]
}

/// Turns v from the first frame to the second frame. The result has, in the second frame, the coordinates that v has in
/// the first frame.
fn between<T: Scalar>(v: V<T>, [a, b, c]: [V<T>; 3], [d, e, f]: [V<T>; 3]) -> V<T> {
    d * a.dot(v) + e * b.dot(v) + f * c.dot(v)
}
