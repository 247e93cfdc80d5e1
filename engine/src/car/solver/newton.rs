//! Newton's method for one set of wheels in contact.

use super::super::equations::{GROUND, Held, LOADS, PITCH, ROLL, TRAVELS, UNKNOWNS};
use super::super::parameters::Parameters;
use super::super::tangent::{Factors, tangent};
use super::super::{Car, Case, NoEquilibrium};
use super::equilibrium::Equilibrium;
use super::readings::{Base, Wheels};
use super::start::Start;
use super::{CarSolver, LONGEST_TRAVEL, LONGEST_TURN};
use crate::axle::Reading;

/// Largest number of Newton steps for one set of wheels in contact. Steps back count as well.
const MOST_STEPS: usize = 60;

/// A tangent is computed anew unless each step is at most this fraction of the one before.
const CONTRACTION: f64 = 0.1;
/// After a step below this, in sizes of the unknowns, the tangent serves for the next step.
const NEAR: f64 = 2e-3;
/// A step below this, in sizes of the unknowns, is rounding error.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl<'a> CarSolver<'a> {
    /// Reads the wheels at these travels. `is_exact` demands poses.
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

    /// Newton's method for one set of wheels in contact. It keeps the factors of a tangent, at first those of the start,
    /// while each step is at most a tenth of the one before. The wheels come from their curves until the last step, which
    /// reads poses. If the state may be near, the last step uses the curves as well.
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
        } = start;
        let held = Held {
            car: self.car,
            case,
            lifted,
        };
        let parameters = Parameters::of(self.car, case);
        let sizes = Sizes::of(&start, self.car);
        let mut x = start;
        let mut reached: Option<[f64; UNKNOWNS]> = None;
        let mut smallest = f64::INFINITY;
        let mut evaluations = 0;
        let mut factors = known.cloned();
        let mut is_last = self.curves.is_none();
        for _ in 0..MOST_STEPS {
            let travels: [f64; 4] = [0, 1, 2, 3].map(|k| x[TRAVELS + k]);
            let wheels = match self.wheels(travels, case.racks, is_last) {
                Ok(wheels) => wheels,
                Err(failure) => {
                    x = sizes.half_way_back(&x, reached.as_ref()).ok_or(failure)?;
                    continue;
                }
            };
            evaluations += 1;
            let base = wheels.base(held, travels);
            let is_fresh = factors.is_none();
            let (residuals, lu) = linearised(&base, &parameters, &x, factors.take())?;
            let step = lu.solve(residuals.map(|residual| -residual));
            let longest = sizes.longest(&step);
            if !longest.is_finite() {
                // Factors of another state can fail here, so the tangent is computed here.
                if is_fresh {
                    return Err(NoEquilibrium::Singular);
                }
                continue;
            }
            let is_end = longest <= ROUNDING || longest >= smallest && smallest <= 1e-10;
            let is_near = matches!(wheels, Wheels::Near(_));
            if is_end && is_near && !may_be_near {
                (is_last, smallest) = (true, f64::INFINITY);
                factors = Some(lu);
                continue;
            }
            if is_end {
                let equations = tangent(&base, &parameters, &x);
                let placed = match &wheels {
                    Wheels::Exact(readings) => readings.placed,
                    Wheels::Near(_) => self.placed(travels, case.racks)?,
                };
                return Equilibrium::converged(x, lifted, placed, is_near, evaluations, equations);
            }
            if !is_fresh && longest > CONTRACTION * smallest {
                // Convergence is too slow: the tangent is computed here.
                smallest = longest.max(smallest);
                continue;
            }
            smallest = smallest.min(longest);
            let shrink = sizes.shrink(&step);
            reached = Some(x);
            for k in 0..UNKNOWNS {
                x[k] += shrink * step[k];
            }
            if shrink == 1.0 && longest <= NEAR {
                factors = Some(lu);
            }
        }
        Err(NoEquilibrium::NotFound)
    }
}

/// Residuals of the equations at `x`, with the factors of a tangent: the given ones, or those of the tangent there.
#[inline]
fn linearised(
    base: &Base<'_, '_, Reading<f64>>,
    parameters: &Parameters<f64>,
    x: &[f64; UNKNOWNS],
    factors: Option<Factors>,
) -> Result<([f64; UNKNOWNS], Factors), NoEquilibrium> {
    match factors {
        Some(factors) => Ok((base.balance(parameters, *x, |c: f64| c).residuals, factors)),
        None => {
            let (residuals, tangent) = tangent(base, parameters, x);
            let factors = Factors::of(&tangent).ok_or(NoEquilibrium::Singular)?;
            Ok((residuals, factors))
        }
    }
}

/// Sizes of the unknowns, which scale the steps.
struct Sizes {
    metre: f64,
    weight: f64,
}

impl Sizes {
    /// Point halfway back to `reached`, the last point at which the wheels had poses. `None` without such a point, or if it
    /// is no distance away.
    fn half_way_back(
        &self,
        x: &[f64; UNKNOWNS],
        reached: Option<&[f64; UNKNOWNS]>,
    ) -> Option<[f64; UNKNOWNS]> {
        let back = reached?;
        let far = (0..4).map(|k| (x[TRAVELS + k] - back[TRAVELS + k]).abs());
        let is_far = far.fold(0.0, f64::max) > 1e-9 * self.metre;
        is_far.then(|| std::array::from_fn(|k| 0.5 * (x[k] + back[k])))
    }

    fn of(start: &[f64; UNKNOWNS], car: &Car) -> Self {
        let loads = start[LOADS..LOADS + 4].iter();
        Sizes {
            metre: car.per_metre(),
            weight: loads.map(|n| n.abs()).sum::<f64>().max(1.0),
        }
    }

    /// Largest component of a step, in sizes; NaN if a component is NaN.
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

    /// Largest fraction of a step that respects the limits on attitude and travels.
    fn shrink(&self, step: &[f64; UNKNOWNS]) -> f64 {
        let too_long = (0..LOADS).map(|k| match k {
            ROLL | PITCH => step[k].abs() / LONGEST_TURN,
            _ => step[k].abs() / (LONGEST_TRAVEL * self.metre),
        });
        1.0 / too_long.fold(1.0, f64::max)
    }
}
