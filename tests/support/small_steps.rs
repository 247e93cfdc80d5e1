//! Independent continuation of a strut in small steps, to decide if a pose is connected to the design position. The
//! continuation uses other equations, another solver and another step control than the program.
//!
//! The unknowns are the position of the knuckle's origin and the nine entries of its rotation. The position is relative
//! to the origin's design position, with the nearest power of two to the suspension size as unit.
//! The equations for the origin o and the rotation R are:
//!
//! ```text
//! |o + R b - c|^2 = |b - c|^2            rods
//! R n . (p - o) = n . p                  the mount p of a strut with two normals n of its line
//! (o + R w) . z = w . z + travel         or, with the arm turned, o on a half-plane through its axis
//! R^T R = 1
//! ```
//!
//! Here b and c are the knuckle end and the chassis end of a rod, w is the wheel centre, and z points up.
//!
//! A step follows the tangent. The step is kept if Newton's method from there makes a small correction (the path is nearly
//! straight), converges, and finds nearly the same determinant. Otherwise the step is halved.

use hardpoint::derive::MotionPoint;
use hardpoint::mechanism::Pose;
use hardpoint::model::{Body, Constraint, Drive, Mechanism};
use hardpoint::number::{Matrix3, Vector3};
use nalgebra::{SMatrix, SVector};

type V = Vector3<f64>;
type X = SVector<f64, 12>;
type Factors = nalgebra::LU<f64, nalgebra::Const<12>, nalgebra::Const<12>>;

/// Longest step, divided by the suspension size or in radians.
const LONGEST: f64 = 0.02;
/// Largest relative error of a step along the tangent.
const STRAIGHT: f64 = 0.05;
/// Shortest step, as a fraction of the path.
const SHORTEST: f64 = 1e-9;
/// Largest number of steps. Paths seldom need more than a hundred steps. Close to another solution branch they may need
/// thousands.
const MOST: usize = 20_000;

/// Equations of one design.
pub struct SmallSteps {
    origin: V,
    scale: f64,
    /// Rods: chassis end, true if the rack moves this end, and lever on the knuckle.
    rods: Vec<(V, bool, V)>,
    /// Lines of struts: mount, and a normal of the line.
    lines: Vec<(V, V)>,
    wheel: V,
    /// Three vectors: from the arm's axis to its outer joint; the direction of this vector; the tangent of the joint's
    /// circle.
    arm: [V; 3],
    /// True if the joint starts to move horizontally. Then no direction of rotation counts as positive.
    is_at_dead_centre: bool,
}

impl SmallSteps {
    pub fn new(mechanism: &Mechanism, design: &[V]) -> Self {
        let origin = design[mechanism.origin.0];
        let scale = mechanism.size(design).log2().round().exp2();
        let at = |p: hardpoint::model::PointId| (design[p.0] - origin) * (1.0 / scale);
        let (mut rods, mut lines) = (Vec::new(), Vec::new());
        for constraint in &mechanism.constraints {
            match *constraint {
                Constraint::Link { inner, outer } => {
                    let on_rack = mechanism.body(inner) == Body::Rack;
                    rods.push((at(inner), on_rack, at(outer)));
                }
                Constraint::StrutLine { top, lower, upper } => {
                    let along = (at(upper.unwrap_or(top)) - at(lower)).normalised();
                    let least = along.to_array().map(f64::abs);
                    let unit =
                        |k: usize| Vector3::from([0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }));
                    let k = (0..3)
                        .min_by(|a, b| least[*a].total_cmp(&least[*b]))
                        .unwrap();
                    let first = along.cross(unit(k)).normalised();
                    lines.extend([(at(top), first), (at(top), along.cross(first))]);
                }
                _ => panic!("struts only"),
            }
        }
        let arm = &mechanism.arms[0];
        let (front, rear) = (at(arm.front), at(arm.rear));
        let axis = (front - rear).normalised();
        // Vector from the arm's axis to the outer joint (the origin), computed from the nearer end of the axis. The
        // projection is repeated, so that the vector is perpendicular to the axis to the last digit even for a short
        // arm. A positive rotation raises the joint.
        let near = if front.norm() < rear.norm() {
            front
        } else {
            rear
        };
        let normal_part = |v: V| v - axis * axis.dot(v);
        let radius = normal_part(normal_part(near * -1.0));
        let mut across = axis.cross(radius);
        if across.z < 0.0 {
            across = across * -1.0;
        }
        SmallSteps {
            origin,
            scale,
            rods,
            lines,
            wheel: at(mechanism.wheel_centre),
            arm: [radius, radius.normalised(), across.normalised()],
            is_at_dead_centre: across.z.abs() <= 1e-10 * across.norm(),
        }
    }

    /// Target values for a motion point: drive and rack, in scaled units or radians.
    fn goal(&self, point: &MotionPoint<f64>) -> [f64; 2] {
        let value = match point.drive {
            Drive::Travel => point.value / self.scale,
            Drive::ArmAngle => point.value,
        };
        [value, point.rack / self.scale]
    }

    fn residuals(&self, x: &X, drive: Drive, [value, rack]: [f64; 2]) -> X {
        let (o, columns) = parts(x);
        let turned = |v: V| columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
        let mut all = X::zeros();
        let mut i = 0;
        for (inner, on_rack, lever) in &self.rods {
            // Computes |d|^2 - |d0|^2 from the difference d - d0. This avoids cancellation.
            let moved = o + turned(*lever)
                - *lever
                - if *on_rack {
                    rack_at(rack)
                } else {
                    V::default()
                };
            let before = *lever - *inner;
            all[i] = moved.dot(moved + before * 2.0);
            i += 1;
        }
        for (top, normal) in &self.lines {
            all[i] = turned(*normal).dot(*top - o) - normal.dot(*top);
            i += 1;
        }
        all[5] = match drive {
            Drive::Travel => o.z + turned(self.wheel).z - self.wheel.z - value,
            Drive::ArmAngle => (o + self.arm[0]).dot(self.half_plane(value)),
        };
        for (k, (a, b)) in PAIRS.into_iter().enumerate() {
            let one = if a == b { 1.0 } else { 0.0 };
            all[6 + k] = columns[a].dot(columns[b]) - one;
        }
        all
    }

    /// Normal of the half-plane that contains the arm.
    fn half_plane(&self, angle: f64) -> V {
        let (sine, cosine) = angle.sin_cos();
        self.arm[2] * cosine - self.arm[1] * sine
    }

    fn jacobian(&self, x: &X, drive: Drive, [value, rack]: [f64; 2]) -> SMatrix<f64, 12, 12> {
        let (o, columns) = parts(x);
        let turned = |v: V| columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
        let mut all = SMatrix::<f64, 12, 12>::zeros();
        // Writes a row of derivatives with respect to the origin and to the rotation, column by column.
        let mut put = |row: usize, by_origin: V, by_column: [V; 3]| {
            for (k, part) in [by_origin].into_iter().chain(by_column).enumerate() {
                for (a, entry) in part.to_array().into_iter().enumerate() {
                    all[(row, 3 * k + a)] += entry;
                }
            }
        };
        let along = |gradient: V, lever: V| lever.to_array().map(|c| gradient * c);
        let mut i = 0;
        for (inner, on_rack, lever) in &self.rods {
            let shift = if *on_rack {
                rack_at(rack)
            } else {
                V::default()
            };
            let d = (o + turned(*lever) - *inner - shift) * 2.0;
            put(i, d, along(d, *lever));
            i += 1;
        }
        for (top, normal) in &self.lines {
            put(i, turned(*normal) * -1.0, along(*top - o, *normal));
            i += 1;
        }
        match drive {
            Drive::Travel => {
                let up = Vector3::new(0.0, 0.0, 1.0);
                put(5, up, along(up, self.wheel));
            }
            Drive::ArmAngle => put(5, self.half_plane(value), [V::default(); 3]),
        }
        for (k, (a, b)) in PAIRS.into_iter().enumerate() {
            let mut by_column = [V::default(); 3];
            by_column[a] = by_column[a] + columns[b];
            by_column[b] = by_column[b] + columns[a];
            put(6 + k, V::default(), by_column);
        }
        all
    }

    /// Derivative of the residuals with respect to a change of drive and rack.
    fn by_motion(&self, x: &X, drive: Drive, at: [f64; 2], change: [f64; 2]) -> X {
        let (o, columns) = parts(x);
        let mut all = X::zeros();
        for (i, (inner, on_rack, lever)) in self.rods.iter().enumerate() {
            if *on_rack {
                let image = columns[0] * lever.x + columns[1] * lever.y + columns[2] * lever.z;
                let d = o + image - *inner - rack_at(at[1]);
                all[i] = -2.0 * d.dot(rack_at(change[1]));
            }
        }
        all[5] = match drive {
            Drive::Travel => -change[0],
            Drive::ArmAngle => {
                let (sine, cosine) = at[0].sin_cos();
                -change[0] * (o + self.arm[0]).dot(self.arm[1] * cosine + self.arm[2] * sine)
            }
        };
        all
    }

    /// Pose at `to`. The path moves the rack first, then the drive. `None` if the steps become too small, or if the
    /// drive rotates an arm at a dead centre.
    pub fn follow(&self, to: &MotionPoint<f64>) -> Option<Pose<f64>> {
        if to.drive == Drive::ArmAngle && self.is_at_dead_centre {
            return None;
        }
        let mut x = X::zeros();
        for k in 0..3 {
            x[3 + 4 * k] = 1.0;
        }
        let [value, rack] = self.goal(to);
        for (from, to_here) in [([0.0; 2], [0.0, rack]), ([0.0, rack], [value, rack])] {
            if from != to_here {
                x = self.leg(x, to.drive, from, to_here)?;
            }
        }
        let (o, columns) = parts(&x);
        Some(Pose {
            origin: self.origin + o * self.scale,
            rotation: Matrix3 { columns },
        })
    }

    fn leg(&self, start: X, drive: Drive, from: [f64; 2], to: [f64; 2]) -> Option<X> {
        let change = [to[0] - from[0], to[1] - from[1]];
        let between = |t: f64| match t {
            1.0 => to,
            t => [from[0] + t * change[0], from[1] + t * change[1]],
        };
        let factorised = |x: &X, at| -> (Factors, f64) {
            let lu = self.jacobian(x, drive, at).lu();
            let determinant = lu.determinant();
            (lu, determinant)
        };
        let (mut x, mut reached, mut step) = (start, 0.0, 1.0_f64);
        let (mut lu, mut determinant) = factorised(&x, from);
        for _ in 0..MOST {
            let here = between(reached);
            let tangent = lu.solve(&-self.by_motion(&x, drive, here, change))?;
            step = step.min(LONGEST / tangent.amax());
            let (next, goal) = if reached + step >= 1.0 {
                (1.0, to)
            } else {
                (reached + step, between(reached + step))
            };
            let length = (next - reached) * tangent.amax();
            let mut guess = x + tangent * (next - reached);
            let (mut last, mut settled) = (f64::INFINITY, None);
            for iteration in 0..10 {
                let (factors, now) = factorised(&guess, goal);
                let ratio = now / determinant;
                let Some(correction) = factors.solve(&self.residuals(&guess, drive, goal)) else {
                    break;
                };
                guess -= correction;
                let size = correction.amax();
                // This form of the comparison refuses NaN.
                let is_good = iteration > 0 || size <= STRAIGHT * length + 1e-12;
                if !(ratio > 0.5 && ratio < 2.0 && is_good && size < last) {
                    // Corrections that no longer shrink are rounding errors.
                    if last <= 1e-12 && ratio > 0.5 && ratio < 2.0 {
                        settled = Some((factors, now));
                    }
                    break;
                }
                if size < 1e-14 {
                    settled = Some((factors, now));
                    break;
                }
                last = size;
            }
            match settled {
                Some(found) => {
                    (lu, determinant) = found;
                    x = guess;
                    reached = next;
                    if next == 1.0 {
                        return Some(x);
                    }
                    step *= 2.0;
                }
                None => {
                    step = 0.5 * (next - reached);
                    if step < SHORTEST {
                        return None;
                    }
                }
            }
        }
        None
    }
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

fn rack_at(rack: f64) -> V {
    Vector3::new(0.0, rack, 0.0)
}

fn parts(x: &X) -> (V, [V; 3]) {
    let part = |k: usize| Vector3::new(x[3 * k], x[3 * k + 1], x[3 * k + 2]);
    (part(0), [part(1), part(2), part(3)])
}
