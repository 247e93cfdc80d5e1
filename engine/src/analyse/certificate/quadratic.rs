//! The twelve equations as a quadratic polynomial with interval coefficients.
//!
//! Let z be the displacement from the design position: the pose's twelve numbers, the rack and the drive (its value, or
//! sine and cosine - 1 of an angle). The equations are quadratic in z, without a remainder:
//!
//! ```text
//! F(z) = F0 + J0 z + H(z, z)/2                                                    (1)
//! J(z) = J0 + H z                                                                 (2)
//! F(z) = F0 + (J0 + J(z)) z/2                                                     (3)
//! ```
//!
//! F0, J0 and H are enclosed once, by differentiating the closure equations twice. Evaluating the polynomial then takes
//! about a hundred products. Lengths are divided by the scale.

use super::theorem::ROUNDING;
use super::{N, Square};
use crate::derive::MotionPoint;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Pose};
use crate::model::{Drive, Mechanism};
use crate::number::Dual;
use crate::number::Interval;
use crate::number::Real;
use crate::number::{Each, Matrix3, Vector3, array_of};
use crate::sorting::sort_by_key;

/// Number of variables: the pose, the rack, and two for the drive.
const V: usize = N + 3;
const RACK: usize = N;
const DRIVE: [usize; 2] = [N + 1, N + 2];
/// A number with its gradient with respect to all variables.
type Once = Dual<Interval, V>;
/// A number with its first and second derivatives with respect to all variables.
type Twice = Dual<Once, V>;

/// Displacement from the design position: changes of the pose's numbers, of the rack and of the drive.
pub(crate) type Displacement = [Interval; V];
/// Jacobian of the twelve equations with respect to the twelve numbers of the pose.
pub(crate) type Jacobian = [[Interval; N]; N];

/// Second derivative of one equation with respect to two variables.
#[derive(Clone, Copy, Debug)]
struct Bend {
    equation: usize,
    by: usize,
    and_by: usize,
    value: Interval,
}

/// Equations of one design with one kind of drive.
pub(crate) struct Quadratic {
    drive: Drive,
    /// Unit of length in the equations: a power of two near the mechanism's size.
    scale: f64,
    /// Design position of the knuckle's origin.
    origin: Vector3<f64>,
    constant: [Interval; N],
    linear: [[Interval; V]; N],
    bends: Vec<Bend>,
    /// Second derivatives with respect to each pair of numbers of the pose.
    pub(crate) pose_bends: Vec<PoseBend>,
}

/// Second derivative of an equation with respect to a pair of the pose's numbers j and l. For two different numbers, it
/// is the sum H_jl + H_lj.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseBend {
    pub equation: usize,
    /// Index of the pair: 12 j + l with j <= l.
    pub pair: usize,
    pub middle: f64,
    /// Bound on the difference between the exact second derivative and `middle`. It includes the rounding errors of the sums in
    /// which `middle` is used.
    pub off: f64,
}

/// Returns the second derivatives with respect to pairs of the pose's numbers, in the order of the pairs.
fn pose_bends(bends: &[Bend]) -> Vec<PoseBend> {
    // H_jl equals H_lj, so one of the two represents both.
    let of_pose = bends.iter().filter(|b| b.by <= b.and_by && b.and_by < N);
    let mut pose_bends: Vec<_> = of_pose
        .map(|b| {
            let both = b.value.times(if b.by == b.and_by { 1.0 } else { 2.0 });
            let middle = both.middle();
            PoseBend {
                equation: b.equation,
                pair: N * b.by + b.and_by,
                middle,
                off: radius(both, middle) + ROUNDING * middle.abs(),
            }
        })
        .collect();
    sort_by_key(&mut pose_bends, |b| b.pair);
    pose_bends
}

impl Quadratic {
    pub(crate) fn new(
        mechanism: &Mechanism,
        design: &[Vector3<f64>],
        scale: f64,
        drive: Drive,
    ) -> Self {
        let design_series: Vec<_> = design.iter().map(|p| p.map(constant)).collect();
        let closure = Closure::new(mechanism, &design_series);
        let origin = design[mechanism.origin.0];
        let input = |j: usize| {
            let value = match j {
                0..3 => origin.to_array()[j],
                3..N if (j - 3).is_multiple_of(4) => 1.0,
                _ if j == DRIVE[1] && drive == Drive::ArmAngle => 1.0,
                _ => 0.0,
            };
            Twice {
                value: Once::input(Interval::point(value), j),
                ..Twice::input(Once::constant(Interval::point(value)), j)
            }
        };
        let vector = |first: usize| Vector3::new(input(first), input(first + 1), input(first + 2));
        let pose = Pose {
            origin: vector(0),
            rotation: Matrix3 {
                columns: [vector(3), vector(6), vector(9)],
            },
        };
        let driver = match drive {
            Drive::Travel => Driver::Travel(input(DRIVE[0])),
            Drive::ArmAngle => Driver::ArmAngle {
                sine: input(DRIVE[0]),
                cosine: input(DRIVE[1]),
            },
        };
        let at = Configuration::new(mechanism, &design_series, pose, input(RACK));
        let closed = closure.residuals(&at, driver);
        let [a, b, c] = pose.rotation.columns;
        let norm = |v: Vector3<Twice>| (v.norm_squared() - v.x.one()).scaled(0.5);
        let turned = [norm(a), norm(b), norm(c), a.dot(b), b.dot(c), c.dot(a)];
        let unit = |j: usize| {
            if j < 3 || is_length(j, drive) {
                scale
            } else {
                1.0
            }
        };
        let mut first = [Interval::point(0.0); N];
        let mut linear = [[Interval::point(0.0); V]; N];
        let mut bends = Vec::new();
        for (i, equation) in closed.into_iter().chain(turned).enumerate() {
            // The first six equations are lengths, so they are divided by the scale.
            let inverse = if i < 6 { 1.0 / scale } else { 1.0 };
            first[i] = equation.value.value.times(inverse);
            for (j, partial) in equation.partials.iter().enumerate() {
                linear[i][j] = partial.value.times(unit(j) * inverse);
                for (l, second) in partial.partials.iter().enumerate() {
                    if *second != Interval::point(0.0) {
                        bends.push(Bend {
                            equation: i,
                            by: j,
                            and_by: l,
                            value: second.times(unit(j) * unit(l) * inverse),
                        });
                    }
                }
            }
        }
        Quadratic {
            drive,
            scale,
            origin,
            constant: first,
            linear,
            pose_bends: pose_bends(&bends),
            bends,
        }
    }

    /// Returns the displacement from the design position to a pose and a motion point.
    pub(crate) fn displacement(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Displacement {
        let point = MotionPoint {
            drive: point.drive,
            value: Interval::point(point.value),
            rack: Interval::point(point.rack),
        };
        self.displacement_over(pose, &point)
    }

    /// Returns the displacement as in [`Quadratic::displacement`], where drive and rack are intervals.
    pub(crate) fn displacement_over(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<Interval>,
    ) -> Displacement {
        let length = |to: Interval, from: f64| (to - Interval::point(from)).times(1.0 / self.scale);
        let one = Interval::point(1.0);
        let columns = pose.rotation.columns.each(Vector3::to_array);
        let (at, origin) = (pose.origin.to_array(), self.origin.to_array());
        let drive = match self.drive {
            Drive::Travel => [length(point.value, 0.0), Interval::point(0.0)],
            Drive::ArmAngle => {
                let (sine, cosine) = point.value.sin_cos();
                [sine, cosine - one]
            }
        };
        array_of(|j| match j {
            0..3 => length(Interval::point(at[j]), origin[j]),
            3..N => {
                let (column, row) = (j / 3 - 1, j % 3);
                let entry = Interval::point(columns[column][row]);
                if column == row { entry - one } else { entry }
            }
            RACK => length(point.rack, 0.0),
            _ => drive[j - DRIVE[0]],
        })
    }

    /// Returns the Jacobian J(z) with respect to the pose, and the derivatives with respect to the travel, which is the
    /// drive.
    pub(crate) fn jacobian(&self, z: &Displacement) -> (Jacobian, [Interval; N]) {
        let gradients = self.gradients(z);
        (
            gradients.each(by_pose),
            gradients.each(|gradient| gradient[DRIVE[0]]),
        )
    }

    /// Jacobian J(z) with respect to all variables, equation (2) of this module.
    fn gradients(&self, z: &Displacement) -> [[Interval; V]; N] {
        let mut gradients = self.linear;
        for b in &self.bends {
            let entry = &mut gradients[b.equation][b.by];
            *entry = *entry + b.value * z[b.and_by];
        }
        gradients
    }

    /// Values F(z) and Jacobian J(z), equations (3) and (2) of this module.
    pub(crate) fn linearised(&self, z: &Displacement) -> ([Interval; N], Jacobian) {
        let gradients = self.gradients(z);
        let values = array_of(|i| {
            let terms = self.linear[i].iter().zip(&gradients[i]).zip(z);
            let sum = terms.fold(Interval::point(0.0), |sum, ((first, now), z)| {
                sum + (*first + *now) * *z
            });
            self.constant[i] + sum.scaled(0.5)
        });
        (values, gradients.each(by_pose))
    }

    /// Returns the equations on the straight line between two poses, while drive and rack change at constant rates from
    /// one motion point to the other. The result contains coefficients a, b, c with F within a + b t + c t^2 for 0 <= t
    /// <= 1, and the Jacobian over the whole line.
    pub(crate) fn on_line(
        &self,
        [from, to]: [&Displacement; 2],
        [start, end]: [&MotionPoint<f64>; 2],
    ) -> ([[Interval; N]; 3], Jacobian) {
        let mut over: Displacement = array_of(|j| from[j].hull(to[j]));
        let mut along: Displacement = array_of(|j| to[j] - from[j]);
        // Half the second derivatives of the drive's two variables along the line between the poses. Zero unless the drive is an
        // angle.
        let mut curved = [Interval::point(0.0); 2];
        let mut along_anywhere = along;
        if self.drive == Drive::ArmAngle {
            let (s, e) = (Interval::point(start.value), Interval::point(end.value));
            let rate = e - s;
            let (sine, cosine) = s.sin_cos();
            along[DRIVE[0]] = cosine * rate;
            along[DRIVE[1]] = -(sine * rate);
            let (sine, cosine) = s.hull(e).sin_cos();
            over[DRIVE[0]] = sine;
            over[DRIVE[1]] = cosine - Interval::point(1.0);
            along_anywhere[DRIVE[0]] = cosine * rate;
            along_anywhere[DRIVE[1]] = -(sine * rate);
            let half = rate.squared().scaled(-0.5);
            curved = [sine * half, cosine * half];
        }
        let (constant, _) = self.linearised(from);
        let here = self.gradients(from);
        let anywhere = self.gradients(&over);
        let zero = Interval::point(0.0);
        let slope = array_of(|i| {
            let terms = here[i].iter().zip(&along);
            terms.fold(zero, |sum, (g, v)| sum + *g * *v)
        });
        // Half the second derivative of the equations along the line: (H(z', z') + J z'')/2. Primes are derivatives with respect to
        // t.
        let mut bend: [Interval; N] =
            array_of(|i| anywhere[i][DRIVE[0]] * curved[0] + anywhere[i][DRIVE[1]] * curved[1]);
        for b in &self.bends {
            let product = along_anywhere[b.by] * along_anywhere[b.and_by];
            bend[b.equation] = bend[b.equation] + (b.value * product).scaled(0.5);
        }
        ([constant, slope, bend], anywhere.each(by_pose))
    }
}

fn constant(value: f64) -> Twice {
    Twice::constant(Once::constant(Interval::point(value)))
}

fn is_length(variable: usize, drive: Drive) -> bool {
    variable == RACK || variable == DRIVE[0] && drive == Drive::Travel
}

fn by_pose(gradient: [Interval; V]) -> [Interval; N] {
    array_of(|j| gradient[j])
}

/// Returns the largest distance between `middle` and a number in the interval.
pub(crate) fn radius(interval: Interval, middle: f64) -> f64 {
    let reach = (interval.high - middle).max(middle - interval.low);
    // A difference of doubles is zero only if they are equal. `next_up` of zero would be subnormal, and all products
    // with it would be slow.
    if reach > 0.0 { reach.next_up() } else { 0.0 }
}

/// Returns the middle of each interval of a Jacobian.
pub(crate) fn middles(jacobian: &Jacobian) -> Square {
    jacobian.each(|row| row.each(Interval::middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Topology;
    use crate::number::Jet;
    use crate::study::Study;
    use std::path::Path;

    /// The certificate assumes that every closure equation is a polynomial of second degree along any line through the
    /// pose's twelve numbers, the rack and the drive. An equation of another kind would have a third derivative. The
    /// test covers every template except the twist beam.
    #[test]
    fn every_row_of_every_topology_is_quadratic() {
        // Numbers in [-1, 1) from a linear congruential sequence.
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        // The hinge of a twist beam is not quadratic, so studies of twist beams have no certificates.
        for topology in Topology::ALL.iter().filter(|t| !t.is_twist_beam()) {
            let study = Study::from_text("row.toml", topology.template, Path::new("."));
            let suspension = study.expect("a template is valid").into_wheel();
            let (mechanism, size) = (&suspension.mechanism, suspension.size());
            let design: Vec<_> = suspension
                .design
                .iter()
                .map(|p| p.map(Jet::constant))
                .collect();
            let closure = Closure::<Jet<f64, 4>>::new(mechanism, &design);
            let mut seen = [false; 6];
            for trial in 0..20 {
                let mut along = |value: f64, unit: f64| {
                    Jet([value + 0.3 * unit * random(), unit * random(), 0.0, 0.0])
                };
                let origin = suspension.design[mechanism.origin.0];
                let mut vector = |v: Vector3<f64>, unit: f64| {
                    Vector3::new(along(v.x, unit), along(v.y, unit), along(v.z, unit))
                };
                let pose = Pose {
                    origin: vector(origin, size),
                    rotation: Matrix3 {
                        columns: Matrix3::identity(0.0)
                            .columns
                            .map(|column| vector(column, 1.0)),
                    },
                };
                let rack = along(0.0, size);
                let driver = if trial % 2 == 1 && !mechanism.arms.is_empty() {
                    Driver::ArmAngle {
                        sine: along(0.0, 1.0),
                        cosine: along(1.0, 1.0),
                    }
                } else {
                    Driver::Travel(along(0.0, size))
                };
                let at = Configuration::new(mechanism, &design, pose, rack);
                for (row, residual) in closure.residuals(&at, driver).into_iter().enumerate() {
                    let third = residual[3].abs();
                    assert!(third < 1e-12 * size, "{}: equation {row}", topology.name);
                    seen[row] = seen[row] || residual[1] != 0.0;
                }
            }
            assert!(seen.iter().all(|row| *row), "{}: {seen:?}", topology.name);
        }
    }
}
