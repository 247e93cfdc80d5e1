//! Follows a path of the mechanism in steps of arc length, also through folds, where the drive turns back.
//!
//! While the drive (or the rack) moves, its value q and the pose x form a curve F(x, q) = 0 in seven dimensions. With every
//! quantity relative to the mechanism's size,
//!
//! ```text
//! A = [F_x  F_q]     6x7, of full rank except where two paths cross
//! A t = 0, |t| = 1   tangent; its sign is chosen so that det [A; t] keeps its sign
//! ```
//!
//! At a fold F_x is singular, but [A; t] is regular. So a step there is like any other step. It predicts along the Taylor series
//! in the arc length, and corrects in the plane normal to the tangent. Where two paths nearly meet, a step that is too long ends
//! on the other path. There the sign of the determinant gives the tangent the opposite direction, and the step is refused.
//!
//! At a fold, the derivative q' with respect to the arc length is 0. Newton's method finds the fold from the q'' of the Taylor
//! series. Since q is stationary there, its value is exact up to rounding errors.

use super::conditioning::magnitude;
use crate::derive::{DesignSeries, MotionPoint};
use crate::linear::lu::Lu;
use crate::mechanism::Closure;
use crate::mechanism::GOOD_PREDICTION;
use crate::mechanism::{Configuration, Pose};
use crate::mechanism::{Work, WorkCounter};
use crate::model::{Drive, Mechanism};
use crate::number::Vector3;
use crate::number::{Each, Jet, array_of};
use crate::threads::checkpoint;
use std::cmp::Ordering;

/// Quantity that moves while all other quantities are fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moving {
    /// The drive moves, and the rack is fixed.
    Drive,
    /// The rack moves, and the drive is fixed.
    Rack,
}

/// Path of one design: the poses that it takes while one quantity moves.
pub(crate) struct Curve<'a> {
    pub mechanism: &'a Mechanism,
    pub design: &'a [Vector3<f64>],
    pub closure: &'a Closure<f64>,
    pub design_series: &'a DesignSeries<3>,
    pub size: f64,
    /// Rounding error of the closure equations' residuals, relative to the mechanism's size.
    pub rounding: f64,
    pub work: &'a WorkCounter,
    pub moving: Moving,
    /// Kind of drive, and the values of the fixed quantities.
    pub held: MotionPoint<f64>,
}

/// A point of the curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurvePoint {
    /// The pose as a Taylor series in the arc length of the curve.
    pub series: Pose<Jet<f64, 3>>,
    /// Moving quantity as a Taylor series in the arc length.
    pub moved: Jet<f64, 3>,
    /// Unit tangent t of the curve: displacement (3), rotation (3) and moving quantity, which is the drive or the rack. Lengths are
    /// relative to the mechanism's size.
    tangent: [f64; 7],
    factors: Lu<f64, 7>,
    /// Required sign of det [A; t]: the Jacobian A of this module, with the tangent as its last row.
    orientation: f64,
    /// Error of the point due to the rounding of the closure equations, relative to the mechanism's size.
    noise: f64,
}

/// Reason why a path ended before its target.
#[derive(Clone, Debug)]
pub(crate) enum PathEnd {
    /// The path turns back at this point.
    Fold(Box<CurvePoint>),
    /// The path could not be followed beyond this value of the moving quantity, because it meets or nearly meets another
    /// path.
    Unresolved(f64),
}

/// Longest step, relative to the mechanism's size (or in rad).
const LONGEST_STEP: f64 = 0.1;
/// Shortest step, relative to the mechanism's size. Shorter steps are within the rounding of the pose.
const SHORTEST_STEP: f64 = 1e-12;
/// Largest number of steps. The curve of a mechanism is a few dozen times as long as its size. A sharp turn needs about forty
/// halvings of the step.
const MOST_STEPS: usize = 5000;
/// Cosine of the largest change of the tangent's direction in a step.
const STRAIGHT: f64 = 0.9;
/// If corrections no longer shrink, Newton's method counts as converged up to this size of the previous correction, in
/// multiples of the mechanism's size. The noise of the start point can raise this limit.
const CLOSE: f64 = 1e-9;

impl CurvePoint {
    pub(crate) fn pose(&self) -> Pose<f64> {
        self.series.map(|c| c[0])
    }

    /// Value of the moving quantity.
    pub(crate) fn value(&self) -> f64 {
        self.moved[0]
    }
}

impl Curve<'_> {
    /// Follows the curve from one of its points towards `target`, a value of the moving quantity that may be infinite.
    /// Returns the point with that value, or the reason why the path ended before it.
    pub(crate) fn to(
        &self,
        pose: &Pose<f64>,
        value: f64,
        target: f64,
    ) -> Result<CurvePoint, PathEnd> {
        let direction = if target >= value { 1.0 } else { -1.0 };
        let mut here = self
            .at(pose, value, None, direction)
            .ok_or(PathEnd::Unresolved(value))?;
        // If the path is accurate to only a few digits, a correction may lead back to a point before the start.
        let unresolved = |at: &CurvePoint| {
            let gone = direction * (at.value() - value);
            PathEnd::Unresolved(if gone > 0.0 { at.value() } else { value })
        };
        let mut step = LONGEST_STEP;
        for _ in 0..MOST_STEPS {
            checkpoint();
            let next = self.step(&here, step).filter(|(next, missed)| {
                *missed <= GOOD_PREDICTION * step + here.noise
                    && dot(&here.tangent, &next.tangent) > STRAIGHT
                    && !self.may_turn_twice(&here, next, step)
            });
            let past = |p: &CurvePoint| direction * (p.value() - target) >= 0.0;
            match next {
                Some((next, _)) if direction * next.moved[1] <= 0.0 => {
                    match self.fold(&here, &next, step) {
                        Some(fold) if past(&fold) => {
                            if let Some(found) = self.before_fold(&fold, target) {
                                return Ok(found);
                            }
                        }
                        Some(fold) => return Err(PathEnd::Fold(Box::new(fold))),
                        None => {}
                    }
                }
                Some((next, _)) if past(&next) => {
                    if let Some(found) = self.settle(&next, target, step) {
                        return Ok(found);
                    }
                }
                Some((next, missed)) => {
                    here = next;
                    if missed < 0.1 * GOOD_PREDICTION * step {
                        step = (2.0 * step).min(LONGEST_STEP);
                    }
                    continue;
                }
                None => {}
            }
            step *= 0.5;
            if step < SHORTEST_STEP {
                return Err(unresolved(&here));
            }
        }
        Err(unresolved(&here))
    }

    /// Multipliers m of the six closure equations at a fold: m A = (0, ..., 0, 1) with the 6x7 Jacobian A of this module.
    /// If a change of the design changes the equations by dF, the value at the fold changes by -m . dF.
    pub(crate) fn fold_multipliers(&self, fold: &CurvePoint) -> [f64; 6] {
        let m = fold
            .factors
            .solve_transposed([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        // The equations are relative to the mechanism's size. The moving quantity is in its own unit.
        array_of(|i| m[i] * self.unit() / self.size)
    }

    /// Motion point at a value of the moving quantity.
    pub(crate) fn motion(&self, value: f64) -> MotionPoint<f64> {
        match self.moving {
            Moving::Drive => MotionPoint { value, ..self.held },
            Moving::Rack => MotionPoint {
                rack: value,
                ..self.held
            },
        }
    }

    fn motion_series(&self, moved: Jet<f64, 3>) -> MotionPoint<Jet<f64, 3>> {
        let (value, rack) = match self.moving {
            Moving::Drive => (moved, Jet::constant(self.held.rack)),
            Moving::Rack => (Jet::constant(self.held.value), moved),
        };
        MotionPoint {
            drive: self.held.drive,
            value,
            rack,
        }
    }

    /// Unit in which the moving quantity is measured.
    fn unit(&self) -> f64 {
        match (self.moving, self.held.drive) {
            (Moving::Drive, Drive::ArmAngle) => 1.0,
            _ => self.size,
        }
    }

    /// Jacobian A = [F_x F_q] of the closure equations, with lengths relative to the mechanism's size.
    fn matrix(&self, pose: &Pose<f64>, value: f64) -> [[f64; 7]; 6] {
        let motion = self.motion(value);
        let at = Configuration::new(self.mechanism, self.design, *pose, motion.rack);
        let jacobian = self.closure.jacobian(&at, motion.driver());
        let by_value = self.design_series.residuals(
            self.mechanism,
            &pose.map(Jet::constant),
            &self.motion_series(Jet::variable(value)),
        );
        array_of(|i| {
            array_of(|j| match j {
                0..3 => jacobian[i][j],
                3..6 => jacobian[i][j] / self.size,
                _ => by_value[i][1] * self.unit() / self.size,
            })
        })
    }

    /// Makes a point of the curve with its tangent and Taylor series. `orientation` gives the sign of the tangent. At the
    /// first point `orientation` is `None`, and the moving quantity changes along the tangent in `direction`.
    fn at(
        &self,
        pose: &Pose<f64>,
        value: f64,
        orientation: Option<f64>,
        direction: f64,
    ) -> Option<CurvePoint> {
        let matrix = self.matrix(pose, value);
        let mut tangent = null_vector(matrix)?;
        let turned = match orientation {
            Some(orientation) => bordered(&matrix, &tangent)?.determinant() * orientation < 0.0,
            None => tangent[6] * direction < 0.0,
        };
        if turned {
            tangent = tangent.each(|c| -c);
        }
        self.work.note(|w| {
            w.factorisations += 2;
            w.right_hand_sides += 2;
        });
        let factors = bordered(&matrix, &tangent)?;
        let mut series = pose.map(Jet::constant);
        let mut moved = Jet::constant(value);
        for k in 1..3 {
            let residuals =
                self.design_series
                    .residuals(self.mechanism, &series, &self.motion_series(moved));
            let y = factors.solve(array_of(|i| match i {
                0..6 => -residuals[i][k] / self.size,
                _ if k == 1 => 1.0,
                _ => 0.0,
            }));
            let term = |value: f64| {
                let mut coefficients = [0.0; 3];
                coefficients[k] = value;
                Jet(coefficients)
            };
            series = series.moved(
                Vector3::new(y[0], y[1], y[2]).map(|v| term(v * self.size)),
                Vector3::new(y[3], y[4], y[5]).map(|v| term(0.5 * v)),
            );
            moved.0[k] += y[6] * self.unit();
        }
        Some(CurvePoint {
            series,
            moved,
            tangent,
            orientation: factors.determinant().signum(),
            noise: self.rounding * inverse_norm(&factors).max(1.0),
            factors,
        })
    }

    /// Point about `length` further along the curve, and the error of the prediction of this point.
    fn step(&self, from: &CurvePoint, length: f64) -> Option<(CurvePoint, f64)> {
        let mut pose = crate::solve::path::predict(&from.series, length);
        let [q, first, second] = from.moved.0;
        let mut value = q + length * (first + length * second);
        let (mut missed, mut last) = (0.0, f64::INFINITY);
        for iteration in 0..12 {
            let motion = self.motion(value);
            let at = Configuration::new(self.mechanism, self.design, pose, motion.rack);
            let residuals = self.closure.residuals(&at, motion.driver());
            self.work.note(Work::note_newton);
            let factors = bordered(&self.matrix(&pose, value), &from.tangent)?;
            let y = factors.solve(array_of(|i| match i {
                0..6 => -residuals[i] / self.size,
                _ => 0.0,
            }));
            pose = pose.moved(
                Vector3::new(y[0], y[1], y[2]) * self.size,
                Vector3::new(y[3], y[4], y[5]) * 0.5,
            );
            value += y[6] * self.unit();
            let correction = dot(&y, &y).sqrt();
            if iteration == 0 {
                missed = correction;
            }
            // The condition is written so that NaN is refused.
            let shrinks = correction < 0.5 * last;
            if correction <= self.rounding || (!shrinks && last <= CLOSE.max(100.0 * from.noise)) {
                pose.rotation = pose.rotation.orthonormalised();
                let found = self.at(&pose, value, Some(from.orientation), 1.0)?;
                return Some((found, missed));
            }
            if !shrinks {
                return None;
            }
            last = correction;
        }
        None
    }

    /// Returns true if the moving quantity may turn back twice between two points at which it changes in the same
    /// direction.
    fn may_turn_twice(&self, here: &CurvePoint, next: &CurvePoint, step: f64) -> bool {
        let within = |s: f64| s > 0.0 && s < step;
        here.moved[1] * next.moved[1] > 0.0
            && within(-0.5 * here.moved[1] / here.moved[2])
            && within(0.5 * next.moved[1] / next.moved[2])
    }

    /// Fold between two points at which the moving quantity changes in opposite directions.
    fn fold(&self, before: &CurvePoint, after: &CurvePoint, step: f64) -> Option<CurvePoint> {
        // A secant shows which of the two points is nearer to the fold. Newton's method starts there.
        let part = before.moved[1] / (before.moved[1] - after.moved[1]);
        let mut point = if part < 0.5 { *before } else { *after };
        let mut last = f64::INFINITY;
        for _ in 0..40 {
            let length = -0.5 * point.moved[1] / point.moved[2];
            if length.is_nan() || length.abs() > step {
                return None;
            }
            // An error e in the arc length causes an error of order e^2 in the value at the fold. But it causes an error of
            // order e in the gradient of this value.
            if length.abs() <= point.noise || (length.abs() >= 0.5 * last && last <= 1e-7) {
                return Some(point);
            }
            point = self.step(&point, length)?.0;
            last = length.abs();
        }
        None
    }

    /// Point before a fold at which the moving quantity has the value `target`.
    fn before_fold(&self, fold: &CurvePoint, target: f64) -> Option<CurvePoint> {
        let squared = (target - fold.value()) / fold.moved[2];
        let length = -squared.max(0.0).sqrt();
        if length.abs() <= f64::EPSILON {
            return Some(*fold);
        }
        if length.abs() > LONGEST_STEP {
            return None;
        }
        let (start, missed) = self.step(fold, length)?;
        if missed > 0.1 * length.abs() {
            return None;
        }
        self.settle(&start, target, 0.5 * length.abs())
    }

    /// Point near the given point at which the moving quantity has the value `target`.
    fn settle(&self, near: &CurvePoint, target: f64, reach: f64) -> Option<CurvePoint> {
        let rounding = near.noise * target.abs().max(self.unit());
        let (mut point, mut last) = (*near, f64::INFINITY);
        for _ in 0..40 {
            let [q, first, second] = point.moved.0;
            let short = target - q;
            // Solves q + first s + second s^2 = target without cancellation. Close to a fold, rounding may leave no root.
            // The double root is used then.
            let discriminant = (first * first + 4.0 * second * short).max(0.0);
            let length = 2.0 * short / (first + first.signum() * discriminant.sqrt());
            // Near a fold, an error of the moving quantity at rounding level is not sufficient. The remaining arc length
            // must also be at rounding level. At the fold itself this arc length is NaN, which counts as zero.
            let is_there = short.abs() <= 0.5 * rounding
                && length.abs().partial_cmp(&point.noise) != Some(Ordering::Greater);
            if is_there || (length.abs() >= 0.5 * last && short.abs() <= 4.0 * rounding) {
                return Some(point);
            }
            if length.is_nan() || length.abs() > 1.5 * reach || length.abs() >= last {
                return None;
            }
            point = self.step(&point, length)?.0;
            last = length.abs();
        }
        None
    }
}

fn dot(a: &[f64; 7], b: &[f64; 7]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Unit vector that is orthogonal to six rows, by elimination with complete pivoting.
fn null_vector(mut a: [[f64; 7]; 6]) -> Option<[f64; 7]> {
    let mut order: [usize; 7] = array_of(|j| j);
    for k in 0..6 {
        let (mut row, mut column, mut largest) = (k, k, 0.0);
        for (i, line) in a.iter().enumerate().skip(k) {
            for (j, entry) in line.iter().enumerate().skip(k) {
                if entry.abs() > largest {
                    (row, column, largest) = (i, j, entry.abs());
                }
            }
        }
        if largest == 0.0 {
            return None;
        }
        a.swap(k, row);
        for line in &mut a {
            line.swap(k, column);
        }
        order.swap(k, column);
        let pivot_row = a[k];
        for line in a.iter_mut().skip(k + 1) {
            let factor = line[k] / pivot_row[k];
            for j in k..7 {
                line[j] -= factor * pivot_row[j];
            }
        }
    }
    let mut x = [0.0; 7];
    x[6] = 1.0;
    for k in (0..6).rev() {
        let sum: f64 = (k + 1..7).map(|j| a[k][j] * x[j]).sum();
        x[k] = -sum / a[k][k];
    }
    let norm = dot(&x, &x).sqrt();
    if !norm.is_finite() {
        return None;
    }
    let mut null = [0.0; 7];
    for (place, component) in order.iter().zip(x) {
        null[*place] = component / norm;
    }
    Some(null)
}

/// Factorises the square matrix that consists of six rows and a last row. `None` if it is singular.
fn bordered(rows: &[[f64; 7]; 6], last: &[f64; 7]) -> Option<Lu<f64, 7>> {
    let square = array_of(|i| if i < 6 { rows[i] } else { *last });
    Lu::of(square, 1.0)
}

/// Largest row sum of the inverse of the matrix with these factors.
fn inverse_norm(factors: &Lu<f64, 7>) -> f64 {
    let rows = factors.inverse();
    rows.iter().map(|row| magnitude(row)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: [[f64; 7]; 6] = [
        [0.0, 2.0, 1.0, -1.0, 0.5, 3.0, 1.0],
        [1.0, 0.0, -2.0, 4.0, 1.0, 0.0, -1.0],
        [3.0, 1.0, 0.0, 0.5, -1.0, 2.0, 0.0],
        [-1.0, 5.0, 2.0, 0.0, 1.0, 1.0, 2.0],
        [2.0, -2.0, 1.0, 1.0, 0.0, -3.0, 0.5],
        [0.5, 1.0, 4.0, -1.0, 2.0, 0.0, 0.0],
    ];

    #[test]
    fn the_null_vector_is_normal_to_every_row() {
        let null = null_vector(ROWS).unwrap();
        assert!((dot(&null, &null) - 1.0).abs() < 1e-15);
        for row in ROWS {
            assert!(dot(&row, &null).abs() < 1e-14);
        }
    }
}
