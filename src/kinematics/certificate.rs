//! Proof that a pose is right: the theorem of Newton and Kantorovich on the quadratic closure equations.
//!
//! In the twelve numbers x of a pose (position of the origin, nine entries of the rotation) the five
//! constraints, the drive and the six conditions R^T R = 1 are quadratic. With A an approximate inverse
//! of the Jacobian J at x, in the maximum norm,
//!
//! ```text
//! Y = |A F(x)|,   Z0 = |1 - A J(x)|,   Z2 = |A H|,   H the constant second derivative
//!
//! Z0 < 1 and 2 Z2 Y <= (1 - Z0)^2   =>   one and only one solution within r+, and it is within r-,
//! r- = 2 Y / (1 - Z0 + sqrt d),  r+ = (1 - Z0 + sqrt d) / Z2,  d = (1 - Z0)^2 - 2 Z2 Y
//! ```
//!
//! (radii polynomial: |A F + (A J - 1) e + A H(e,e)/2| <= Y + Z0 r + Z2 r^2/2 <= r maps the ball into
//! itself). F, J and H are evaluated on [`Interval`]s from the hardpoints on, so that link lengths, strut
//! normals and everything else are enclosed as well: the proof is about the exact mechanism whose
//! hardpoints are the given doubles, whatever is rounded on the way. Lengths are divided by a power of
//! two near the size.
//!
//! *A whole step.* On the straight line x(t) between two poses, 0 <= t <= 1, the equations are
//! F = a + b t + c t^2 (with c enclosed over the line where the drive is an angle), so
//!
//! ```text
//! |A F(x(t))| <= |A a| + |A (b + c)| + |A c|/4          as t (1 - t) <= 1/4
//! ```
//!
//! and with J enclosed over the line the same inequality proves, for every t, one and only one solution
//! within r+ of the line: both poses lie on one branch. A chain of such steps from the design position
//! proves a whole curve.

use super::closure::Closure;
use super::motion::MotionPoint;
use super::path::{DesignFault, Failure, March, Solver};
use super::pose::{Pose, Posture};
use crate::model::{Drive, Mechanism};
use crate::number::{Dual, Interval, Jet, Matrix3, Real, Scalar, Vector3};
use std::array::from_fn;
use std::fmt;
use std::ops::ControlFlow;

const N: usize = 12;
type Square = [[f64; N]; N];
type Gradients = Dual<Interval, N>;
type Line = Jet<Interval, 3>;

/// What is proved of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// The exact pose is no further than this from the computed one: coordinates of the knuckle's
    /// origin differ by no more than this length, entries of the rotation by no more than this over the
    /// scale.
    pub error: f64,
    /// No other solution is closer than this, measured alike.
    pub uniqueness: f64,
    /// The length the rotation is counted at: the power of two next to the size.
    pub scale: f64,
}

impl Certificate {
    /// Bound on the distance between the exact and the computed position of a knuckle point at
    /// `distance` from the knuckle's origin, not counting the rounding in forming it.
    pub fn point_error(&self, distance: f64) -> f64 {
        // |dr| <= sqrt 3 e, |dR b| <= |dR|_F |b| <= 3 (e/scale) |b|.
        1.7321 * self.error + 3.0 * self.error / self.scale * distance
    }
}

/// Why nothing could be proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unproven {
    /// The pose is singular, or as good as singular in double precision.
    Singular,
    /// The residual is too large against the distance to the next solution: the inequality fails.
    TooClose,
    /// The pose is proved, but not that it lies on the branch of the design position.
    Branch,
}

impl fmt::Display for Unproven {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Unproven::Singular => "the pose is singular in double precision",
            Unproven::TooClose => "another assembly is too close to tell apart in double precision",
            Unproven::Branch => "the path from the design position could not be proved",
        })
    }
}

/// Proves the poses of one design.
pub struct Certifier<'m> {
    mechanism: &'m Mechanism,
    scale: f64,
    gradients: Lifted<Gradients>,
    line: Lifted<Line>,
    /// Second derivatives in lengths of the scale: equation, first and second variable.
    curvature: Vec<(usize, usize, usize, Interval)>,
}

/// A design and its equations over another kind of number.
struct Lifted<T> {
    design: Vec<Vector3<T>>,
    closure: Closure<T>,
}

impl<T: Scalar> Lifted<T> {
    fn new(mechanism: &Mechanism, design: &[Vector3<f64>], lift: impl Fn(f64) -> T) -> Self {
        let design: Vec<_> = design.iter().map(|p| p.map(&lift)).collect();
        let closure = Closure::new(mechanism, &design);
        Lifted { design, closure }
    }

    /// The twelve equations: closure, then R^T R = 1.
    fn equations(
        &self,
        mechanism: &Mechanism,
        pose: Pose<T>,
        motion: (super::closure::Driver<T>, T),
    ) -> [T; N] {
        let at = Posture {
            mechanism,
            design: &self.design,
            pose,
            rack: motion.1,
            steering: None,
        };
        let closure = self.closure.residuals(&at, motion.0);
        let [a, b, c] = pose.rotation.columns;
        let unit = |v: Vector3<T>| (v.norm_squared() - v.x.one()).scaled(0.5);
        let turned = [unit(a), unit(b), unit(c), a.dot(b), b.dot(c), c.dot(a)];
        from_fn(|i| if i < 6 { closure[i] } else { turned[i - 6] })
    }
}

/// The radii of one application of the theorem.
struct Radii {
    error: f64,
    uniqueness: f64,
}

impl<'m> Certifier<'m> {
    /// For this design.
    pub fn new(mechanism: &'m Mechanism, design: &[Vector3<f64>]) -> Self {
        let origin = design[mechanism.origin.0];
        let size = design
            .iter()
            .map(|p| (*p - origin).norm())
            .fold(0.0, f64::max);
        let mut certifier = Certifier {
            mechanism,
            scale: size.log2().round().exp2(),
            gradients: Lifted::new(mechanism, design, |v| Dual::constant(Interval::point(v))),
            line: Lifted::new(mechanism, design, |v| Jet::constant(Interval::point(v))),
            curvature: Vec::new(),
        };
        certifier.curvature = certifier.curvature(design[mechanism.origin.0]);
        certifier
    }

    /// Proves a pose, the drive and the rack being exactly at `point`.
    ///
    /// # Errors
    /// Why nothing could be proved.
    pub fn pose(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<f64>,
    ) -> Result<Certificate, Unproven> {
        let there = pose.map(Interval::point);
        let motion = (point.drive, [point.value, point.rack].map(Interval::point));
        let (f, jacobian) = self.linearised(there, motion);
        let inverse = inverse(&jacobian.map(|row| row.map(Interval::middle)))?;
        let radii = self.theorem(&inverse, &jacobian, magnitude(product(&inverse, &f)))?;
        Ok(Certificate {
            error: (radii.error * self.scale).next_up(),
            uniqueness: (radii.uniqueness * self.scale).next_down(),
            scale: self.scale,
        })
    }

    /// Proves that two poses lie on one branch, with one and only one solution beside every point of
    /// the straight line between them.
    ///
    /// # Errors
    /// Why nothing could be proved; a shorter step may do.
    pub fn step(
        &self,
        (from, start): (&Pose<f64>, &MotionPoint<f64>),
        (to, end): (&Pose<f64>, &MotionPoint<f64>),
    ) -> Result<(), Unproven> {
        let first = self.pose(from, start)?;
        let last = self.pose(to, end)?;
        let (a, b) = (from.map(Interval::point), to.map(Interval::point));
        let (s, e) = (
            [start.value, start.rack].map(Interval::point),
            [end.value, end.rack].map(Interval::point),
        );
        let hull = Pose {
            origin: zip(a.origin, b.origin, Interval::hull),
            rotation: Matrix3 {
                columns: from_fn(|k| {
                    zip(a.rotation.columns[k], b.rotation.columns[k], Interval::hull)
                }),
            },
        };
        let over = from_fn(|k| s[k].hull(e[k]));
        let (_, jacobian) = self.linearised(hull, (start.drive, over));
        let inverse = inverse(&jacobian.map(|row| row.map(Interval::middle)))?;
        // Coefficients along the line, at its beginning and over the whole of it.
        let along = |base: Pose<Interval>, at: [Interval; 2]| -> [Line; N] {
            let none = Interval::point(0.0);
            let series =
                |base: Interval, from: Interval, to: Interval| Jet([base, to - from, none]);
            let vector =
                |base: Vector3<Interval>, from: Vector3<Interval>, to: Vector3<Interval>| {
                    Vector3::new(
                        series(base.x, from.x, to.x),
                        series(base.y, from.y, to.y),
                        series(base.z, from.z, to.z),
                    )
                };
            let pose = Pose {
                origin: vector(base.origin, a.origin, b.origin),
                rotation: Matrix3 {
                    columns: from_fn(|k| {
                        vector(
                            base.rotation.columns[k],
                            a.rotation.columns[k],
                            b.rotation.columns[k],
                        )
                    }),
                },
            };
            let value = series(at[0], s[0], e[0]);
            let driver = driver(start.drive, value, |v| {
                let (sine, cosine) = v[0].sin_cos();
                // Second derivatives halved: -sin/2 v'^2.
                let (once, half) = (v[1], v[1].squared().scaled(-0.5));
                (
                    Jet([sine, cosine * once, sine * half]),
                    Jet([cosine, -(sine * once), cosine * half]),
                )
            });
            self.line
                .equations(self.mechanism, pose, (driver, series(at[1], s[1], e[1])))
        };
        let (begin, whole) = (along(a, s), along(hull, over));
        let scaled = |i: usize, value: Interval| value * self.equation_scale(i);
        let constant = from_fn(|i| scaled(i, begin[i][0]));
        let ends = from_fn(|i| scaled(i, begin[i][1] + whole[i][2]));
        let bend = from_fn(|i| scaled(i, whole[i][2]));
        let bound = sum(&[
            magnitude(product(&inverse, &constant)),
            magnitude(product(&inverse, &ends)),
            0.25 * magnitude(product(&inverse, &bend)),
        ]);
        let radii = self.theorem(&inverse, &jacobian, bound)?;
        // The proved solutions at both ends are the ones beside the line.
        let within = (radii.uniqueness * self.scale).next_down();
        if first.error <= within && last.error <= within {
            Ok(())
        } else {
            Err(Unproven::TooClose)
        }
    }

    fn theorem(
        &self,
        inverse: &Square,
        jacobian: &[[Interval; N]; N],
        residual: f64,
    ) -> Result<Radii, Unproven> {
        let one = Interval::point(1.0);
        let mut defect = 0.0_f64;
        for (i, row) in inverse.iter().enumerate() {
            let entries = from_fn::<f64, N, _>(|j| {
                let mut sum = Interval::point(if i == j { -1.0 } else { 0.0 });
                for (factor, line) in row.iter().zip(jacobian) {
                    sum = sum + Interval::point(*factor) * line[j];
                }
                sum.magnitude()
            });
            defect = defect.max(sum(&entries));
        }
        let mut bend = 0.0_f64;
        for row in inverse {
            let mut terms = [[Interval::point(0.0); N]; N];
            for (equation, j, l, value) in &self.curvature {
                let term = Interval::point(row[*equation]) * *value;
                terms[*j][*l] = terms[*j][*l] + term;
            }
            let sums: [f64; N] = from_fn(|j| sum(&terms[j].map(Interval::magnitude)));
            bend = bend.max(sum(&sums));
        }
        let left = one - Interval::point(defect);
        // Never NaN: intervals have no such bounds.
        if left.low <= 0.0 {
            return Err(Unproven::Singular);
        }
        let (residual, bend) = (Interval::point(residual), Interval::point(bend));
        let discriminant = left.squared() - (residual * bend).scaled(2.0);
        if discriminant.low < 0.0 {
            return Err(Unproven::TooClose);
        }
        let root = left + discriminant.sqrt();
        let error = (residual.scaled(2.0) / root).high;
        let uniqueness = (root / bend).low;
        if error.is_finite() && uniqueness.is_finite() {
            Ok(Radii { error, uniqueness })
        } else {
            Err(Unproven::Singular)
        }
    }

    /// The first six equations are lengths and counted in scales.
    fn equation_scale(&self, i: usize) -> Interval {
        Interval::point(if i < 6 { 1.0 / self.scale } else { 1.0 })
    }

    /// The first three variables are lengths.
    fn variable_scale(&self, j: usize) -> Interval {
        Interval::point(if j < 3 { self.scale } else { 1.0 })
    }

    /// F and J, in scales.
    fn linearised(
        &self,
        pose: Pose<Interval>,
        (drive, [value, rack]): (Drive, [Interval; 2]),
    ) -> ([Interval; N], [[Interval; N]; N]) {
        let mut index = 0;
        let mut input = |value: Interval| {
            index += 1;
            Dual::input(value, index - 1)
        };
        let pose = pose.map(&mut input);
        let driver = driver(drive, Dual::constant(value), |v: Gradients| {
            let (sine, cosine) = v.value.sin_cos();
            (Dual::constant(sine), Dual::constant(cosine))
        });
        let equations =
            self.gradients
                .equations(self.mechanism, pose, (driver, Dual::constant(rack)));
        (
            from_fn(|i| equations[i].value * self.equation_scale(i)),
            from_fn(|i| {
                from_fn(|j| {
                    equations[i].partials[j] * self.equation_scale(i) * self.variable_scale(j)
                })
            }),
        )
    }

    /// The second derivatives: J is affine, so they are its differences over unit steps. The drive's
    /// equation is linear in the pose.
    fn curvature(&self, origin: Vector3<f64>) -> Vec<(usize, usize, usize, Interval)> {
        let at = |variable: Option<usize>| {
            let mut pose = Pose {
                origin: origin.map(Interval::point),
                rotation: Matrix3::identity(Interval::point(0.0)),
            };
            // Around the design position, where differences cancel best.
            if let Some(l) = variable {
                let shift = |v: Interval, is: bool| match is {
                    true => v + self.variable_scale(l),
                    false => v,
                };
                let component = |v: Vector3<Interval>, k: usize| {
                    Vector3::new(shift(v.x, k == 0), shift(v.y, k == 1), shift(v.z, k == 2))
                };
                if l < 3 {
                    pose.origin = component(pose.origin, l);
                } else {
                    let column = &mut pose.rotation.columns[l / 3 - 1];
                    *column = component(*column, l % 3);
                }
            }
            self.linearised(pose, (Drive::Travel, [Interval::point(0.0); 2]))
                .1
        };
        let base = at(None);
        let mut found = Vec::new();
        for l in 0..N {
            let shifted = at(Some(l));
            for i in (0..N).filter(|i| *i != 5) {
                for j in 0..N {
                    let value = shifted[i][j] - base[i][j];
                    if value.low != 0.0 || value.high != 0.0 {
                        found.push((i, j, l, value));
                    }
                }
            }
        }
        found
    }
}

fn driver<T: Scalar>(
    drive: Drive,
    value: T,
    sin_cos: impl FnOnce(T) -> (T, T),
) -> super::closure::Driver<T> {
    match drive {
        Drive::Travel => super::closure::Driver::Travel(value),
        Drive::ArmAngle => {
            let (sine, cosine) = sin_cos(value);
            super::closure::Driver::ArmAngle { sine, cosine }
        }
    }
}

fn zip<T>(a: Vector3<T>, b: Vector3<T>, f: impl Fn(T, T) -> T) -> Vector3<T> {
    Vector3::new(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z))
}

/// A sum of non-negative numbers, rounded up.
fn sum(terms: &[f64]) -> f64 {
    terms
        .iter()
        .fold(Interval::point(0.0), |sum, t| sum + Interval::point(*t))
        .high
}

fn product(matrix: &Square, vector: &[Interval; N]) -> [Interval; N] {
    from_fn(|i| {
        matrix[i]
            .iter()
            .zip(vector)
            .fold(Interval::point(0.0), |sum, (a, v)| {
                sum + Interval::point(*a) * *v
            })
    })
}

fn magnitude(vector: [Interval; N]) -> f64 {
    vector
        .into_iter()
        .map(Interval::magnitude)
        .fold(0.0, f64::max)
}

/// An approximate inverse, by Gauss and Jordan with partial pivoting.
fn inverse(matrix: &Square) -> Result<Square, Unproven> {
    let mut a = *matrix;
    let mut b: Square = from_fn(|i| from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if a[i][k].abs() > a[pivot][k].abs() {
                pivot = i;
            }
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        let divisor = a[k][k];
        if !(divisor.is_finite() && divisor != 0.0) {
            return Err(Unproven::Singular);
        }
        a[k] = a[k].map(|v| v / divisor);
        b[k] = b[k].map(|v| v / divisor);
        let (pivot_a, pivot_b) = (a[k], b[k]);
        for i in (0..N).filter(|i| *i != k) {
            let factor = a[i][k];
            for j in 0..N {
                a[i][j] -= factor * pivot_a[j];
                b[i][j] -= factor * pivot_b[j];
            }
        }
    }
    Ok(b)
}

/// The most steps a path from one station to the next may be proved in.
const MOST_STEPS: usize = 4096;
/// Halvings of such a step.
const MOST_HALVINGS: usize = 40;

impl Solver<'_> {
    /// As [`Solver::march`], with a proof of every pose: that it is right, and that it lies on the branch
    /// of the design position. What cannot be proved is refused.
    ///
    /// # Errors
    /// If the design position itself is singular.
    pub fn march_certified(
        &mut self,
        certifier: &Certifier,
        drive: Drive,
        march: &March,
        rack: f64,
        mut visit: impl FnMut(
            &Self,
            usize,
            Result<(&Pose<f64>, Certificate), Failure>,
        ) -> ControlFlow<()>,
    ) -> Result<(), DesignFault> {
        let mut found: Vec<Result<Pose<f64>, Failure>> =
            vec![Err(Failure::Singular); march.values().len()];
        self.march(drive, march, rack, |_, station, pose| {
            found[station] = pose.copied();
            ControlFlow::Continue(())
        })?;
        let design = self.design_place(drive);
        let start = match self.placed(drive, rack)? {
            Ok(placed) if rack == 0.0 => Ok(placed),
            Ok(placed) => self
                .prove_path(certifier, design, placed)
                .map(|()| placed)
                .map_err(Failure::Uncertified),
            Err(failure) => Err(failure),
        };
        for side in march.sides() {
            let mut from = start;
            for station in side {
                let point = MotionPoint {
                    drive,
                    value: march.values()[*station],
                    rack,
                };
                let certified = found[*station].and_then(|pose| {
                    let place = from?;
                    self.prove_path(certifier, place, (pose, point))
                        .and_then(|()| certifier.pose(&pose, &point))
                        .map(|certificate| (pose, certificate))
                        .map_err(Failure::Uncertified)
                });
                // Beyond a gap in the proof there is none; what is unreachable ends the side anyway.
                from = certified.map(|(pose, _)| (pose, point));
                let shown = match &certified {
                    Ok((pose, certificate)) => Ok((pose, *certificate)),
                    Err(failure) => Err(*failure),
                };
                if visit(self, *station, shown).is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Proves that a pose lies on one branch with another, in as many steps as it takes.
    fn prove_path(
        &mut self,
        certifier: &Certifier,
        from: (Pose<f64>, MotionPoint<f64>),
        to: (Pose<f64>, MotionPoint<f64>),
    ) -> Result<(), Unproven> {
        if from.1 == to.1 {
            return certifier.pose(&to.0, &to.1).map(|_| ());
        }
        let mut from = from;
        // What is still to be proved, nearest last.
        let mut goals = vec![(to, 0)];
        for _ in 0..MOST_STEPS {
            let Some(&((pose, point), depth)) = goals.last() else {
                return Ok(());
            };
            let failed = match certifier.step((&from.0, &from.1), (&pose, &point)) {
                Ok(()) => {
                    from = (pose, point);
                    goals.pop();
                    continue;
                }
                Err(failed) => failed,
            };
            // An end that is itself unproved will not become so by a shorter way to it.
            if depth == MOST_HALVINGS || certifier.pose(&pose, &point).is_err() {
                return Err(failed);
            }
            let between = MotionPoint {
                drive: point.drive,
                value: 0.5 * (from.1.value + point.value),
                rack: 0.5 * (from.1.rack + point.rack),
            };
            let middle = self
                .pose_towards(&from.0, &from.1, &between)
                .map_err(|_| Unproven::Branch)?;
            let top = goals.last_mut().expect("looked at above");
            top.1 += 1;
            let depth = top.1;
            goals.push(((middle, between), depth));
        }
        Err(Unproven::Branch)
    }
}
