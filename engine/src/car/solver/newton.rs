//! Newton's method for one set of wheels in contact.
//!
//! Several steps use the LU factors of one tangent G_x (derivatives of the residuals with respect to the unknowns). Let x
//! be the unknowns and s the steps, both divided by the typical sizes of the unknowns. Let L bound the relative change of
//! the tangent per step. If the tangent was computed at y, a step s from x has the remaining error
//!
//! ```text
//! e <= L (|x - y| + |s|) |s|                                                                                    (1)
//! ```
//!
//! A step is the last one if this error is smaller than rounding errors. L is [`CURVATURE`], or ten times the value of L that the
//! previous steps show by equation (1), if that is larger.

use super::super::equations::{GROUND, Held, LOADS, PITCH, ROLL, TRAVELS, UNKNOWNS};
use super::super::parameters::Parameters;
use super::super::tangent::{Factors, Matrix};
use super::super::{Car, Case, NoEquilibrium};
use super::equilibrium::Equilibrium;
use super::readings::Wheels;
use super::start::Start;
use super::{CarSolver, LONGEST_TRAVEL, LONGEST_TURN};
use crate::number::{Each, array_of};

/// If a step with an earlier tangent is larger than this fraction of the shortest step so far, the solver computes a new
/// tangent.
const CONTRACTION: f64 = 0.1;
/// If a step is below this limit, relative to the sizes of the unknowns, the next step uses the same tangent. The
/// tangent of the last step must be from within this distance.
const NEAR: f64 = 2e-3;
/// Limit for steps with the tangent of a neighbouring state. If the step is between half of [`NEAR`] and this limit, the
/// next step uses this tangent again. If the step is longer or shorter, the solver computes a new tangent. After a
/// shorter step, this tangent is close to the solution.
const BESIDE: f64 = 2e-2;
/// A step below this limit, relative to the sizes of the unknowns, is rounding error.
pub(super) const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Limit for steps that are longer than the shortest step so far. Newton's method fails if their number exceeds the
/// allowed number of steps, divided by this constant. Only steps with a new tangent count.
const MOST_LONGER: usize = 5;
/// Smallest value of L in equation (1) of this module. L is the relative change of the tangent if the unknowns change by
/// their typical sizes.
const CURVATURE: f64 = 100.0;

/// LU factors of a tangent, with the unknowns at which the tangent was computed. These unknowns are `None` for the
/// tangent of another state.
struct Linear {
    factors: Box<Factors>,
    at: Option<[f64; UNKNOWNS]>,
}

impl<'a> CarSolver<'a> {
    /// Computes the wheels at these travels. If `is_exact` is true, poses are used instead of curves.
    fn wheels(
        &mut self,
        travels: [f64; 4],
        racks: [f64; 2],
        is_exact: bool,
    ) -> Result<Wheels<'a>, NoEquilibrium> {
        if !is_exact && let Some(near) = self.near(travels, racks) {
            return Ok(Wheels::Near(near));
        }
        Ok(Wheels::Exact(Box::new(self.read(travels, racks)?)))
    }

    /// Runs Newton's method for one set of wheels in contact. The function starts with the LU factors of the start. It
    /// keeps the factors of a tangent while each step is at most a tenth of the shortest step before. The wheels are computed
    /// from their curves until the last step, which uses poses. If `may_be_near` is true, the last step also uses the
    /// curves.
    pub(super) fn newton(
        &mut self,
        case: &Case,
        start: Start<'_>,
    ) -> Result<Equilibrium, NoEquilibrium> {
        let Start {
            unknowns: start,
            lifted,
            factors: known,
            may_be_near,
            most_steps,
        } = start;
        let held = Held {
            car: self.car,
            case,
            lifted,
        };
        let parameters = Parameters::of(self.car, case);
        let mut at = Iteration::at(start, self.car, known);
        let mut is_last = self.curves.is_none();
        let mut evaluations = 0;
        for _ in 0..most_steps {
            let travels: [f64; 4] = [0, 1, 2, 3].each(|k| at.x[TRAVELS + k]);
            let wheels = match self.wheels(travels, case.racks, is_last) {
                Ok(wheels) => wheels,
                Err(failure) => {
                    let back = at.sizes.half_way_back(&at.x, at.reached.as_ref());
                    at.x = back.ok_or(failure)?;
                    continue;
                }
            };
            evaluations += 1;
            let step = at.step(&wheels, held, &parameters);
            let placed = match wheels {
                Wheels::Near(near) => {
                    self.spare = Some(near);
                    None
                }
                Wheels::Exact(readings) => Some(readings.placed),
            };
            let Some(step) = step? else {
                continue;
            };
            let is_end = at.is_end(&step);
            if !(is_end && step.distance <= NEAR) {
                at.advance(step, is_end);
                if at.longer > most_steps / MOST_LONGER {
                    break;
                }
                continue;
            }
            moved(&mut at.x, &step.change, 1.0);
            if placed.is_none() && !may_be_near {
                is_last = true;
                at.begin_again(step.linear);
                continue;
            }
            return Ok(Equilibrium {
                unknowns: at.x,
                lifted,
                evaluations,
                racks: case.racks,
                placed: placed.map(Box::new),
                factors: Some(step.linear.factors),
            });
        }
        Err(NoEquilibrium::NotFound)
    }
}

fn moved(x: &mut [f64; UNKNOWNS], step: &[f64; UNKNOWNS], part: f64) {
    for (unknown, step) in x.iter_mut().zip(step) {
        *unknown += part * step;
    }
}

impl Linear {
    fn of(tangent: &Matrix, at: [f64; UNKNOWNS]) -> Result<Self, NoEquilibrium> {
        let factors = Factors::of(tangent).ok_or(NoEquilibrium::Singular)?;
        Ok(Linear {
            factors: Box::new(factors),
            at: Some(at),
        })
    }
}

/// State of Newton's method between two of its steps.
struct Iteration {
    x: [f64; UNKNOWNS],
    sizes: Sizes,
    /// Unknowns before the last step that was taken. Every wheel has a pose at these unknowns.
    reached: Option<[f64; UNKNOWNS]>,
    /// Shortest step so far. A step with an earlier tangent that is rejected raises it to the length of this step.
    smallest: f64,
    /// Number of steps with a new tangent that were longer than the shortest step so far.
    longer: usize,
    curvature: Curvature,
    /// LU factors for the next step. `None` if the next step needs a new tangent.
    linear: Option<Linear>,
}

/// A step of Newton's method.
struct Step {
    change: [f64; UNKNOWNS],
    linear: Linear,
    /// True if the tangent was computed at the point where the step starts.
    is_fresh: bool,
    /// Length of the step, relative to the sizes of the unknowns.
    longest: f64,
    /// Distance from the point at which the tangent was computed; infinite for the tangent of another state.
    distance: f64,
}

impl Iteration {
    fn at(start: [f64; UNKNOWNS], car: &Car, known: Option<&Factors>) -> Self {
        Iteration {
            x: start,
            sizes: Sizes::of(&start, car),
            reached: None,
            smallest: f64::INFINITY,
            longer: 0,
            curvature: Curvature::default(),
            linear: known.map(|factors| Linear {
                factors: Box::new(factors.clone()),
                at: None,
            }),
        }
    }

    /// Computes a step. `None` if the factors of an earlier tangent are no longer good enough, so that a new tangent is
    /// needed.
    fn step(
        &mut self,
        wheels: &Wheels<'_>,
        held: Held<'_>,
        parameters: &Parameters<f64>,
    ) -> Result<Option<Step>, NoEquilibrium> {
        let is_fresh = self.linear.is_none();
        let (residuals, linear) = match self.linear.take() {
            Some(linear) => (wheels.residuals(held, parameters, self.x), linear),
            None => {
                let (residuals, tangent) = wheels.tangent(held, parameters, &self.x);
                (residuals, Linear::of(&tangent, self.x)?)
            }
        };
        let change = linear.factors.solve(residuals.each(|residual| -residual));
        let longest = self.sizes.longest(&change);
        if !longest.is_finite() {
            return if is_fresh {
                Err(NoEquilibrium::Singular)
            } else {
                Ok(None)
            };
        }
        let distance = match &linear.at {
            Some(at) => self.sizes.between(&self.x, at),
            None => f64::INFINITY,
        };
        Ok(Some(Step {
            change,
            linear,
            is_fresh,
            longest,
            distance,
        }))
    }

    /// Returns true if only rounding error remains after a step.
    fn is_end(&self, step: &Step) -> bool {
        let is_still = step.longest >= self.smallest && self.smallest <= 1e-10;
        let error = self.curvature.error(step.distance, step.longest);
        is_still || step.longest <= ROUNDING || error <= ROUNDING
    }

    /// Applies a step, and keeps its LU factors if the next step can use them. If the tangent was computed too far
    /// away, or if convergence is too slow, the function does not apply the step. A new tangent is then computed at the
    /// same point.
    fn advance(&mut self, step: Step, is_end: bool) {
        let longest = step.longest;
        if !step.is_fresh && (is_end || longest > CONTRACTION * self.smallest) {
            self.smallest = longest.max(self.smallest);
            return;
        }
        if longest > self.smallest {
            self.longer += 1;
        }
        self.smallest = self.smallest.min(longest);
        self.curvature.observe(step.distance, longest);
        let shrink = self.sizes.shrink(&step.change);
        self.reached = Some(self.x);
        moved(&mut self.x, &step.change, shrink);
        let serves = match step.linear.at {
            Some(_) => longest <= NEAR,
            None => longest > 0.5 * NEAR && longest <= BESIDE,
        };
        if shrink == 1.0 && serves {
            self.linear = Some(step.linear);
        }
    }

    /// Resets the record of the steps, after the solver changes from curves to poses.
    fn begin_again(&mut self, linear: Linear) {
        self.smallest = f64::INFINITY;
        self.curvature.last = 0.0;
        self.linear = Some(linear);
    }
}

/// Bound L of equation (1) of this module on the relative change of the tangent.
#[derive(Default)]
struct Curvature {
    /// Largest value of L that the steps so far show by equation (1) of this module.
    shown: f64,
    /// Factor (|x - y| + |s|) |s| of L in equation (1) of this module, for the last step; 0 before the first step.
    last: f64,
}

impl Curvature {
    /// Returns the error that remains after a step, by equation (1) of this module.
    fn error(&self, distance: f64, step: f64) -> f64 {
        let shown = self.shown_by(step);
        CURVATURE.max(10.0 * shown) * (distance + step) * step
    }

    fn shown_by(&self, step: f64) -> f64 {
        if self.last > 0.0 {
            self.shown.max(step / self.last)
        } else {
            self.shown
        }
    }

    /// Records a step. The bound L is computed from the recorded steps.
    fn observe(&mut self, distance: f64, step: f64) {
        self.shown = self.shown_by(step);
        let next = (distance + step) * step;
        self.last = if next.is_finite() { next } else { 0.0 };
    }
}

/// Typical sizes of the unknowns. The solver divides steps by these sizes.
struct Sizes {
    metre: f64,
    weight: f64,
}

impl Sizes {
    /// Returns the point halfway back to `reached`, the last point at which every wheel has a pose. `None` if there is
    /// no such point, or if its travels are nearly the present ones.
    fn half_way_back(
        &self,
        x: &[f64; UNKNOWNS],
        reached: Option<&[f64; UNKNOWNS]>,
    ) -> Option<[f64; UNKNOWNS]> {
        let back = reached?;
        let far = (0..4).map(|k| (x[TRAVELS + k] - back[TRAVELS + k]).abs());
        let is_far = far.fold(0.0, f64::max) > 1e-9 * self.metre;
        is_far.then(|| array_of(|k| 0.5 * (x[k] + back[k])))
    }

    fn of(start: &[f64; UNKNOWNS], car: &Car) -> Self {
        let loads = start[LOADS..LOADS + 4].iter();
        Sizes {
            metre: car.per_metre(),
            weight: loads.map(|n| n.abs()).sum::<f64>().max(1.0),
        }
    }

    /// Distance between two points, relative to the sizes of the unknowns.
    fn between(&self, x: &[f64; UNKNOWNS], y: &[f64; UNKNOWNS]) -> f64 {
        self.longest(&array_of(|k| x[k] - y[k]))
    }

    /// Largest component of a step, relative to the sizes of the unknowns. It is NaN if a component is NaN.
    fn longest(&self, step: &[f64; UNKNOWNS]) -> f64 {
        let mut longest = 0.0_f64;
        for (k, part) in step.iter().enumerate() {
            let size = match k {
                ROLL | PITCH => 1.0,
                GROUND..LOADS => self.metre,
                _ => self.weight,
            };
            let part = (part / size).abs();
            if part.is_nan() {
                return part;
            }
            longest = longest.max(part);
        }
        longest
    }

    /// Largest fraction of a step that keeps attitude and travels within their limits.
    fn shrink(&self, step: &[f64; UNKNOWNS]) -> f64 {
        let too_long = (0..LOADS).map(|k| match k {
            ROLL | PITCH => step[k].abs() / LONGEST_TURN,
            _ => step[k].abs() / (LONGEST_TRAVEL * self.metre),
        });
        1.0 / too_long.fold(1.0, f64::max)
    }
}
