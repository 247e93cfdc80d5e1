//! Follows the closure equations with steps so small that Newton's method stays on the solution branch.

use super::{Solver, Station};
use crate::derive::MotionPoint;
use crate::linear::lu::Lu6;
use crate::mechanism::Driver;
use crate::mechanism::Failure;
use crate::mechanism::LimitCause;
use crate::mechanism::Pose;
use crate::mechanism::Work;
use crate::mechanism::{GOOD_PREDICTION, ROUNDING};
use crate::number::Jet;
use crate::solve::continuation::{Moving, PathEnd};

/// Largest rotation of the knuckle in one step (rad). Also its largest displacement in one step, relative to the mechanism's size.
pub(crate) const LONGEST_TURN: f64 = 0.2;
/// Shortest step in the drive, as a share of the distance to the next station. If a step would be shorter, the path turns
/// sharply. The solver then follows the path in steps of arc length.
const SHORTEST_STEP: f64 = 1.0 / 16.0;
impl Solver<'_> {
    /// Follows the closure equations from a station to a motion point. It makes steps of the drive, and accepts a step only
    /// if the second-order prediction was good and the Jacobian's determinant has not changed much. If this needs many
    /// steps, the function follows the path in steps of arc length instead. That method passes folds and finds them.
    pub(crate) fn follow(
        &mut self,
        from: &Station,
        to: &MotionPoint<f64>,
    ) -> Result<Pose<f64>, Failure> {
        self.prepare_series();
        let design_series = self.design_series.as_ref().expect("just made");
        let (mut pose, start) = *from;
        let between = |t: f64| MotionPoint {
            drive: to.drive,
            value: start.value + (to.value - start.value) * t,
            rack: start.rack + (to.rack - start.rack) * t,
        };
        let (mut reached, mut step) = (0.0, 1.0_f64);
        let mut lu = self.factorise(&pose, &start);
        while reached < 1.0 {
            let target = if reached + step >= 1.0 {
                1.0
            } else {
                reached + step
            };
            let here = between(reached);
            let direction = MotionPoint {
                drive: to.drive,
                value: Jet([here.value, to.value - start.value, 0.0]),
                rack: Jet([here.rack, to.rack - start.rack, 0.0]),
            };
            let accepted = lu.as_ref().and_then(|lu| {
                self.work.note(|w| w.right_hand_sides += 2);
                let series = design_series.series(self.mechanism, lu, &pose, &direction);
                let predicted = predict(&series, target - reached);
                let point = if target == 1.0 { *to } else { between(target) };
                self.correct(&pose, &predicted, &point, lu.determinant())
            });
            match accepted {
                Some((found, factors)) => {
                    pose = found;
                    lu = Some(factors);
                    reached = target;
                    step *= 2.0;
                }
                None => {
                    step = 0.5 * (target - reached);
                    if step < SHORTEST_STEP {
                        return self.follow_arc(&pose, &here, to);
                    }
                }
            }
        }
        Ok(pose)
    }

    /// Follows the path in steps of arc length. Either the drive or the rack moves.
    pub(crate) fn follow_arc(
        &mut self,
        pose: &Pose<f64>,
        from: &MotionPoint<f64>,
        to: &MotionPoint<f64>,
    ) -> Result<Pose<f64>, Failure> {
        let (moving, value, target) = if to.rack == from.rack {
            (Moving::Drive, from.value, to.value)
        } else {
            (Moving::Rack, from.rack, to.rack)
        };
        let curve = self.curve(moving, *to);
        let (limit, cause) = match curve.to(pose, value, target) {
            Ok(found) => return Ok(found.pose()),
            Err(PathEnd::Fold(fold)) => (fold.value(), curve.cause(&fold)),
            Err(PathEnd::Unresolved(limit)) => (limit, LimitCause::Unresolved),
        };
        Err(match moving {
            Moving::Rack => Failure::RackUnreachable { limit, cause },
            Moving::Drive => Failure::Unreachable {
                drive: to.drive,
                limit,
                cause,
            },
        })
    }

    /// Returns true if a pose satisfies the closure equations within their rounding.
    pub(crate) fn closes(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> bool {
        let at = self.configuration(pose, point.rack);
        let residuals = self.closure.residuals(&at, point.driver());
        let rounding = self.length_rounding();
        residuals.iter().all(|r| r.abs() <= rounding)
    }

    /// Largest rounding error of a closure equation's residual. Each residual consists of a dozen products and sums of
    /// lengths up to the coordinate scale.
    pub(crate) fn length_rounding(&self) -> f64 {
        16.0 * ROUNDING * self.coordinate_scale
    }

    /// Applies Newton's method to a pose that is already close to the solution. `None` if the method does not converge.
    pub(crate) fn polished(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<Pose<f64>> {
        let (mut pose, mut last) = (*pose, f64::INFINITY);
        for _ in 0..60 {
            let at = self.configuration(&pose, point.rack);
            self.work.note(Work::note_newton);
            let (next, correction, _) = self.closure.newton_step(&at, point.driver(), self.size)?;
            if correction >= last || correction.is_nan() {
                // Corrections that no longer shrink are rounding errors, amplified by the condition number.
                return (last <= 1e-6 * self.size).then_some(pose);
            }
            pose = next;
            pose.rotation = pose.rotation.orthonormalised();
            last = correction;
        }
        None
    }

    /// Applies Newton's method to a predicted pose. `None` if the step was long, the prediction was poor, the Jacobian's
    /// determinant changed much (or changed sign), or the iteration did not converge.
    pub(crate) fn correct(
        &self,
        before: &Pose<f64>,
        predicted: &Pose<f64>,
        point: &MotionPoint<f64>,
        determinant: f64,
    ) -> Option<(Pose<f64>, Lu6<f64>)> {
        let moved = distance(before, predicted, self.size);
        if moved.is_nan() || moved > LONGEST_TURN * self.size {
            return None;
        }
        let driver: Driver<f64> = point.driver();
        let mut pose = *predicted;
        let mut last = f64::INFINITY;
        for iteration in 0..12 {
            let at = self.configuration(&pose, point.rack);
            self.work.note(Work::note_newton);
            let (next, correction, _) = self.closure.newton_step(&at, driver, self.size)?;
            let rounding = ROUNDING * self.coordinate_scale;
            if iteration == 0 && correction > GOOD_PREDICTION * moved + rounding {
                return None;
            }
            // The corrections no longer shrink, so they are rounding errors.
            if correction <= rounding
                || (correction >= 0.5 * last && last <= (1e-9 * self.size).max(100.0 * rounding))
            {
                let settled = Pose {
                    origin: next.origin,
                    rotation: next.rotation.orthonormalised(),
                };
                let lu = self.factorise(&settled, point)?;
                let steady = lu.determinant() / determinant;
                return (steady > 0.25 && steady < 4.0).then_some((settled, lu));
            }
            if correction > last {
                return None;
            }
            pose = next;
            last = correction;
        }
        None
    }
}

/// Pose after a step of the drive or of the arc length, from the Taylor series of the pose.
pub(crate) fn predict(series: &Pose<Jet<f64, 3>>, step: f64) -> Pose<f64> {
    let along = |c: Jet<f64, 3>| c[0] + step * (c[1] + step * c[2]);
    let pose = series.map(along);
    // The truncated Taylor series is a rotation only to second order.
    let rotation = pose.rotation.orthonormalised().orthonormalised();
    Pose {
        origin: pose.origin,
        rotation: rotation.orthonormalised(),
    }
}

/// Distance between two poses. A rotation counts as about its angle times `size`.
pub(crate) fn distance(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> f64 {
    let turned = a
        .rotation
        .columns
        .iter()
        .zip(b.rotation.columns)
        .map(|(p, q)| (*p - q).norm())
        .fold(0.0, f64::max);
    (a.origin - b.origin).norm().max(turned * size)
}
