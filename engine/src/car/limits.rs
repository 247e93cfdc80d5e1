//! Limits of a car when its accelerations increase in a fixed ratio (along a ray): the first lifted wheel, and the end
//! of equilibrium.
//!
//! On a ray, the accelerations of a case are multiplied by a factor s. With the wheel loads N of the state at s,
//! Newton's method finds the factor at which the first wheel has no load:
//!
//! ```text
//! s' = s + min over the wheels with N_s < 0 of N/(-N_s)                                                       (1)
//! ```
//!
//! N_s, the derivative of N with respect to s, comes from the state's exact derivatives with respect to ax and ay. It
//! omits the yaw acceleration. A bracket (an interval of s) keeps the iteration safe. At its lower end, all wheels are
//! on the ground. Its upper end is beyond the first lift. There is no equation for the end of equilibrium, so bisection
//! finds it. Within a bracket, the solver starts each state from the previous state. The full search for an equilibrium
//! is slow if no equilibrium exists. So it is only used to confirm the end.

use super::catalogue::{CarQuantity, WheelPlace, WheelResult};
use super::parameters::{BodyParameter, Parameter};
use super::solver::Start;
use super::{CarSolver, Case, Equilibrium, Longitudinal, NoEquilibrium};
use crate::number::Each;

/// Largest acceleration that the search tries, g.
const MOST: f64 = 5.0;
/// Step of the acceleration, g.
const STEP: f64 = 0.1;
/// Two accelerations count as equal if their difference is below this limit, g.
const SAME: f64 = 1e-9;
/// Loads below this fraction of the largest load count as zero.
const NO_LOAD: f64 = 1e-9;
/// Largest number of states for each search within a bracket.
const MOST_STATES: usize = 80;

/// Limits of a car along a ray of accelerations.
#[derive(Clone, Debug)]
pub struct RayLimits {
    /// State in which the first wheel lifts, if a wheel lifts.
    pub lift: Option<Lift>,
    /// Largest acceleration with an equilibrium, g, exact up to 2e-6.
    pub end: f64,
    /// Reason why there is no equilibrium beyond `end`; `None` if equilibria exist up to 5 g.
    pub why: Option<NoEquilibrium>,
}

/// State at which the first wheel lifts.
#[derive(Clone, Copy, Debug)]
pub struct Lift {
    /// Acceleration, g, exact up to 1e-9.
    pub acceleration: f64,
    /// Wheel that lifts.
    pub wheel: WheelPlace,
    /// True if all wheels except the lifted wheel carry load in this state.
    pub others_loaded: bool,
}

/// Direction of the accelerations along the ground. Longitudinal, lateral and yaw acceleration grow in proportion. All other
/// inputs come from the case.
struct Ray<'c> {
    case: &'c Case,
    /// Factor on the accelerations of the case that makes their resultant 1 g.
    per_g: f64,
}

impl Ray<'_> {
    /// Makes the case at an acceleration, g.
    fn at(&self, g: f64) -> Case {
        let factor = g * self.per_g;
        let own = self.case;
        Case {
            ax: own.ax * factor,
            ay: own.ay * factor,
            yaw_acceleration: own.yaw_acceleration * factor,
            ..own.clone()
        }
    }
}

/// A state on the ray.
#[derive(Clone)]
struct At {
    g: f64,
    found: Equilibrium,
}

impl At {
    fn is_down(&self) -> bool {
        self.found.lifted == [false; 4]
    }

    /// Returns the smallest load as a fraction of the largest, and the wheel with the smallest load.
    fn least(&self) -> (f64, usize) {
        let loads = self.found.loads();
        let most = loads.iter().fold(0.0, |most: f64, load| most.max(*load));
        let wheel = (1..4).fold(0, |least, wheel| {
            if loads[wheel] < loads[least] {
                wheel
            } else {
                least
            }
        });
        (loads[wheel] / most, wheel)
    }
}

impl Case {
    /// Makes a case with an acceleration of 1 g along the ground. The direction is in degrees, from forward towards the
    /// left. The car brakes if ax is negative; otherwise it has drive. The longitudinal force of each axle is
    /// distributed in proportion to the wheel loads. All other settings are those of `at_rest`.
    pub fn along(name: &str, degrees: f64, at_rest: &Case) -> Case {
        // In a direction along one axis, the other acceleration must be exactly zero. Otherwise the equations would
        // distribute a force that is only a rounding error.
        let [ax, ay] = match degrees.rem_euclid(360.0) {
            0.0 => [1.0, 0.0],
            90.0 => [0.0, 1.0],
            180.0 => [-1.0, 0.0],
            270.0 => [0.0, -1.0],
            other => [other.to_radians().cos(), other.to_radians().sin()],
        };
        let mut case = Case {
            name: name.to_owned(),
            ax,
            ay,
            ..at_rest.clone()
        };
        case.setting.longitudinal = if ax < 0.0 {
            Longitudinal::Brake
        } else {
            Longitudinal::Drive
        };
        case.setting.longitudinal_shares = super::LongitudinalShares::ByLoad;
        case
    }
}

impl CarSolver<'_> {
    /// Finds the limits of a case if ax and ay increase in their ratio up to 5 g. The yaw acceleration increases in
    /// proportion. Speed, az and racks do not change. `None` for a case without ax and ay.
    pub fn limits(&mut self, case: &Case) -> Option<RayLimits> {
        let length = case.ax.hypot(case.ay);
        if length == 0.0 {
            return None;
        }
        let ray = Ray {
            case,
            per_g: 1.0 / length,
        };
        let mut at = match self.solve(&ray.at(0.0)) {
            Ok(found) => At { g: 0.0, found },
            Err(why) => {
                return Some(RayLimits {
                    lift: None,
                    end: 0.0,
                    why: Some(why),
                });
            }
        };
        let mut lift = None;
        let steps = (MOST / STEP) as usize;
        for step in 1..=steps {
            let g = step as f64 * STEP;
            let next = self.solve_from(&ray.at(g), &at.found);
            let leaves = !matches!(&next, Ok(found) if found.lifted == [false; 4]);
            if leaves && at.is_down() {
                at = self.last_down(&ray, at, g);
                lift = lift.or_else(|| self.lift(&ray, &at));
            }
            match next {
                Ok(found) => at = At { g, found },
                Err(why) => {
                    let (last, why) = self.end(&ray, at, g, why);
                    if why.is_some() {
                        let end = last.g;
                        return Some(RayLimits { lift, end, why });
                    }
                    at = last;
                }
            }
        }
        Some(RayLimits {
            lift,
            end: MOST,
            why: None,
        })
    }

    /// Finds the last state with all wheels on the ground, between the state `from` and the acceleration `beyond`.
    fn last_down(&mut self, ray: &Ray<'_>, from: At, beyond: f64) -> At {
        let (mut low, mut high) = (from, beyond);
        for _ in 0..MOST_STATES {
            if high - low.g <= SAME || low.least().0 <= NO_LOAD {
                break;
            }
            let middle = 0.5 * (low.g + high);
            let newton = self.next(ray, &low).filter(|g| *g > low.g && *g < high);
            let g = newton.unwrap_or(middle);
            match self.solve_beside(&ray.at(g), &low.found) {
                Some(found) if found.lifted == [false; 4] => low = At { g, found },
                _ => {
                    high = g;
                    // Newton's method approaches the lift only from the upper end of the bracket. So bisection moves
                    // the lower end.
                    let g = 0.5 * (low.g + high);
                    match self.solve_beside(&ray.at(g), &low.found) {
                        Some(found) if found.lifted == [false; 4] => low = At { g, found },
                        _ => high = g,
                    }
                }
            }
        }
        low
    }

    /// Next acceleration by equation (1), g.
    fn next(&mut self, ray: &Ray<'_>, at: &At) -> Option<f64> {
        let case = ray.at(at.g);
        let loads = WheelPlace::ALL.each(|place| CarQuantity::Wheel(place, WheelResult::Load));
        let gradients = self.gradients(&case, &at.found, &loads).ok()?;
        let steps = gradients.iter().filter_map(|gradient| {
            let by = |of| gradient.parameters[Parameter::Body(of).place()];
            let along = by(BodyParameter::Ax) * ray.case.ax + by(BodyParameter::Ay) * ray.case.ay;
            let slope = along * ray.per_g;
            (slope < 0.0).then(|| gradient.value / -slope)
        });
        let step = steps.fold(f64::INFINITY, f64::min);
        step.is_finite().then_some(at.g + step)
    }

    /// Describes the lift in a state, if the smallest wheel load in this state is zero. One last step by equation (1)
    /// solves the exact poses, instead of the interpolated curves of the wheels. After this step, the load is zero up
    /// to rounding errors.
    fn lift(&mut self, ray: &Ray<'_>, at: &At) -> Option<Lift> {
        let (part, wheel) = at.least();
        let none = 1e3 * NO_LOAD;
        if part > none {
            return None;
        }
        let loads = at.found.loads();
        let most = loads.iter().fold(0.0, |most: f64, load| most.max(*load));
        let others = (0..4).filter(|other| *other != wheel);
        let exact = self.with_contact(&ray.at(at.g), Start::at(&at.found));
        let exact = exact.ok().map(|found| At { g: at.g, found });
        let exact = exact.filter(At::is_down);
        let last = exact.and_then(|exact| self.next(ray, &exact));
        let last = last.unwrap_or(at.g);
        Some(Lift {
            acceleration: if (last - at.g).abs() <= 10.0 * SAME {
                last
            } else {
                at.g
            },
            wheel: WheelPlace(wheel),
            others_loaded: others.into_iter().all(|other| loads[other] > none * most),
        })
    }

    /// Finds the last state below an acceleration that seems to have no equilibrium. Also returns the reason why
    /// equilibria end there. The reason is `None` if a search from that state finds an equilibrium at the acceleration.
    fn end(
        &mut self,
        ray: &Ray<'_>,
        from: At,
        beyond: f64,
        why: NoEquilibrium,
    ) -> (At, Option<NoEquilibrium>) {
        let (mut low, mut high, mut why) = (from, beyond, why);
        for _ in 0..MOST_STATES {
            let is_last = high - low.g <= 1e3 * SAME;
            let g = if is_last { high } else { 0.5 * (low.g + high) };
            let mut found = self.solve_beside(&ray.at(g), &low.found);
            if found.is_none() && is_last {
                // Newton's method cannot cross a range without equilibrium. The full search tests whether there is an
                // equilibrium beyond this range.
                match self.solve(&ray.at(g)) {
                    Ok(state) => found = Some(state),
                    Err(reason) => {
                        why = reason;
                        break;
                    }
                }
            }
            match found {
                Some(found) => {
                    low = At { g, found };
                    if g == beyond {
                        return (low, None);
                    }
                    if is_last {
                        high = beyond;
                    }
                }
                None => high = g,
            }
        }
        (low, Some(why))
    }
}
