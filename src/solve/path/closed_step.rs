//! Steps by the closed form, where nothing is close to changing (slope, toggle).

use super::follow::{LONGEST_TURN, distance};
use super::{PathPoint, Solver};
use crate::derive::MotionPoint;
use crate::mechanism::Pose;
use crate::model::Drive;
use crate::number::Jet;
use crate::solve::PoseError;
use crate::solve::accuracy::MARGIN;
use crate::solve::closed_form::ClosedForm;

/// Length of the pieces in which a step of the closed form is looked at, as a tangent of half the angle:
/// longer than the steps of an ordinary study.
const PIECE: f64 = 0.01;
/// How many sizes from the origin the closed form keeps its accuracy.
const FAR: f64 = 1e3;
/// Poses this close together, in sizes, are one; assemblies that are closer are near a toggle, where the
/// closed form is not used.
const SAME: f64 = 1e-9;

/// What the closed form knows of a place: tangent of half the arm angle, its slope by the drive, and
/// the same at the place before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosedFormPredictor {
    pub(crate) tangent: f64,
    pub(crate) slope: f64,
    pub(crate) before: Option<(f64, f64, f64)>,
    /// How fast the pose moved by the tangent in the last step; known where less than full precision is
    /// asked for.
    pub(crate) speed: Option<PoseError>,
    /// What may not vanish on the way, with its slope by the tangent.
    pub(crate) margins: [Jet<f64, 2>; 2],
    /// About the condition number, of a place that was stepped to.
    pub(crate) condition: Option<f64>,
}

impl Solver<'_> {
    /// What the closed form needs to go on from a pose.
    pub(crate) fn quick_from(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<f64>,
    ) -> Option<ClosedFormPredictor> {
        let (form, series) = (self.form.as_ref()?, self.series.as_ref()?);
        let tangent = form.half_tangent(pose);
        // Beyond a right angle the tangent of the half angle loses its advantage. Far from the origin
        // the closed form would lose what the closure equations keep.
        if !(tangent.abs() <= 1.0 && self.coordinate_scale < FAR * self.size) {
            return None;
        }
        // The path may have passed a toggle: then the closed form speaks of another assembly.
        let found = form.pose(&form.at_half_tangent(tangent, point.rack));
        let apart = distance(&found, pose, self.size);
        if apart.is_nan() || apart > SAME * self.size {
            return None;
        }
        let state =
            series.at_half_tangent(Jet::<f64, 2>::variable(tangent), Jet::constant(point.rack));
        // Where the closed form loses digits, at the design position too.
        if !state.now().is_ordinary() {
            return None;
        }
        let rise = series.travel(&state)[1];
        Some(ClosedFormPredictor {
            tangent,
            slope: match point.drive {
                Drive::Travel => 1.0 / rise,
                Drive::ArmAngle => 0.5 * (1.0 + tangent * tangent),
            },
            before: None,
            speed: None,
            margins: state.margins(),
            condition: None,
        })
    }

    /// One step by the closed form, if nothing speaks against it.
    pub(crate) fn step_by_closed_form(
        &self,
        from: &PathPoint,
        to: &MotionPoint<f64>,
    ) -> Option<PathPoint> {
        let (form, series) = (self.form.as_ref()?, self.series.as_ref()?);
        let quick = from.quick?;
        if to.rack != from.point.rack {
            return None;
        }
        let (start, end) = (from.point.value, to.value);
        let rack = Jet::constant(to.rack);
        // What may be left of the tangent's error.
        let allowed = match quick.speed {
            Some(speed) => speed.scaled(MARGIN).times_in(self.error_budget.allowed),
            None => 0.0,
        };
        let mut left = 0.0;
        let mut evaluated = None;
        let (tangent, slope, margins) = match to.drive {
            // No equation to solve.
            Drive::ArmAngle => {
                let tangent = (0.5 * end).tan();
                let state = series.at_half_tangent(Jet::variable(tangent), rack);
                (tangent, quick.slope, state.margins())
            }
            Drive::Travel => {
                let predicted = quick.extrapolated(start, end);
                let mut tangent = predicted;
                let mut slope = quick.slope;
                let mut margins = quick.margins;
                let mut settled = false;
                for iteration in 0..4 {
                    self.work.note(|w| w.closed_form_evaluations += 1);
                    let state = series.at_half_tangent(Jet::variable(tangent), rack);
                    let rise = series.travel(&state);
                    let correction = (end - rise[0]) / rise[1];
                    slope = 1.0 / rise[1];
                    margins = state.margins();
                    let steady = slope / quick.slope;
                    let first_is_long = iteration == 0
                        && correction.abs() > 0.1 * (predicted - quick.tangent).abs();
                    // Written so that NaN, from a state that does not exist, is refused.
                    if first_is_long || !(steady > 0.5 && steady < 2.0) {
                        return None;
                    }
                    // What the correction leaves, by the change of the slope since the place before.
                    let bend = (steady - 1.0) / (tangent - quick.tangent);
                    let short = correction.abs() <= 1e-3 * (predicted - quick.tangent).abs();
                    // Good enough as it is: the slope changes by less than a factor of two.
                    if short && 2.0 * correction.abs() <= allowed {
                        left = 2.0 * correction.abs();
                        evaluated = Some(state.now());
                        settled = true;
                        break;
                    }
                    left = (MARGIN * bend.abs() + 1.0) * correction * correction;
                    tangent += correction;
                    // The error left is of the order of the correction squared.
                    if correction.abs() <= 1e-8 || (short && left <= allowed) {
                        settled = true;
                        break;
                    }
                }
                if !settled {
                    return None;
                }
                (tangent, slope, margins)
            }
        };
        let step = tangent - quick.tangent;
        let state = match evaluated {
            Some(state) => state,
            None => {
                self.work.note(|w| w.closed_form_evaluations += 1);
                form.at_half_tangent(tangent, to.rack)
            }
        };
        // Half an angle's tangent grows by at least half of the angle.
        if !(step.abs() <= 0.5 * LONGEST_TURN
            && tangent.abs() < 1.0
            && state.is_ordinary()
            && stays_clear(series, rack, &quick, (tangent, &margins)))
        {
            return None;
        }
        self.work.note(|w| w.closed_form_solves += 1);
        let pose = form.pose(&state);
        let moved = PoseError::between(&from.pose, &pose, self.size);
        let rate = match to.drive {
            Drive::Travel => Some(moved.length / (end - start).abs()),
            Drive::ArmAngle => None,
        };
        let speed = self.error_budget.is_relaxed().then(|| {
            let speed = moved.scaled(1.0 / step.abs());
            let fastest = quick.speed.map_or(speed, |before| before.max(speed));
            self.error_budget.note(fastest.scaled(2.0 * left));
            speed
        });
        Some(PathPoint {
            point: *to,
            pose,
            quick: Some(ClosedFormPredictor {
                tangent,
                slope,
                before: Some((start, quick.tangent, quick.slope)),
                speed,
                margins,
                condition: Some(form.condition(&state, self.size, rate)),
            }),
        })
    }
}

/// Whether what may not vanish stays positive on the way from one place to a tangent with its margins:
/// piece by piece, where the way is long.
fn stays_clear(
    form: &ClosedForm<Jet<f64, 2>>,
    rack: Jet<f64, 2>,
    from: &ClosedFormPredictor,
    (tangent, margins): (f64, &[Jet<f64, 2>; 2]),
) -> bool {
    let step = tangent - from.tangent;
    let pieces = (step.abs() / PIECE).ceil().max(1.0);
    let mut before = from.margins;
    let mut piece = 1.0;
    while piece < pieces {
        let between = from.tangent + step * (piece / pieces);
        let here = form.at_half_tangent(Jet::variable(between), rack).margins();
        if !keep_clear(&before, &here, step / pieces) {
            return false;
        }
        before = here;
        piece += 1.0;
    }
    keep_clear(&before, margins, step / pieces)
}

/// Whether margins stay positive over a step, by their values and slopes at both ends. One that is
/// convex lies above both tangents, one that is concave above its ends.
fn keep_clear(before: &[Jet<f64, 2>; 2], after: &[Jet<f64, 2>; 2], step: f64) -> bool {
    before.iter().zip(after).all(|(a, b)| {
        let least = 0.25 * a[0].min(b[0]);
        a[0] > 0.0 && b[0] > 0.0 && a[0] + a[1] * step > least && b[0] - b[1] * step > least
    })
}

impl ClosedFormPredictor {
    /// The tangent at `end` by the cubic through the last two places and their slopes, or along the
    /// slope where there is only one.
    fn extrapolated(&self, start: f64, end: f64) -> f64 {
        let step = end - start;
        match self.before {
            None => self.tangent + self.slope * step,
            Some((before, tangent, slope)) => {
                let width = start - before;
                let secant = (self.tangent - tangent) / width;
                let bend = (self.slope - secant) / width;
                let twist = (self.slope + slope - 2.0 * secant) / (width * width);
                self.tangent + step * (self.slope + step * (bend + twist * (step + width)))
            }
        }
    }
}
