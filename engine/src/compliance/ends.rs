//! Ends of equilibrium: the travel, rack displacement or load beyond which the search finds no stable equilibrium.
//!
//! The search increases a value (travel, rack displacement or load) from a known equilibrium, in steps of at most a
//! twentieth of the value. Near zero, steps are relative to a typical value. Newton's method starts each state from the
//! previous state. After a step without a stable equilibrium, the search halves the step. After a success, it doubles the
//! step. The search ends when the step is 1e-10 of the value. It also ends at the largest value. If the force that drives
//! the motion exceeds its limit, a step counts as failed.
//!
//! At such an end the tangent is singular: a motion has no stiffness. K is the tangent (stiffness matrix), and x the
//! motion that inverse iteration finds. A part gives way if
//!
//! ```text
//! |K^-1 x| at the end  >  100 |K^-1 x| at the start                                               (1)
//! ```
//!
//! If the path of equilibria turns back at its end, K^-1 grows with the inverse square root of the remaining distance.
//! At a distance of 1e-10, the factor is about 1e5. A part also gives way if its own eliminated equations are unstable.
//! Moments of fixed direction and side forces whose points of action follow the wheel have no energy, so K is not
//! symmetric. So a state can lose its stability (`solve.rs`) while K stays regular. If a state neither gives way nor loses
//! its stability, Newton's method has failed for another reason. The cause of the end is then unknown.

use super::fault::{Motion, NoEquilibrium};
use super::loads::WheelLoads;
use super::solve::{Obstacle, Solution};
use super::system::{Singular, State, Task};
use super::wheel::{ElasticWheel, Equilibrium, HeldQuantity, SpringReading, level_task};
use crate::axle::Stop;
use crate::model::LengthUnit;
use crate::number::Each;

/// Driving force (N) at which the search along a motion ends.
pub const LARGEST_FORCE: f64 = 1e6;
/// Force (N) at which the search along a load ends.
const LARGEST_LOAD: f64 = 1e6;
/// Moment (N m) at which the search along a moment ends.
const LARGEST_MOMENT: f64 = 1e5;
/// Travel or rack displacement (mm) at which the search ends.
const LONGEST_TRAVEL: f64 = 1000.0;
/// Typical travel, mm. Steps of the search are relative to the present value, or to the typical value if that is larger.
const USUAL_TRAVEL: f64 = 20.0;
/// Typical load of the search, N.
const USUAL_LOAD: f64 = 1000.0;
/// Typical moment of the search, N m.
const USUAL_MOMENT: f64 = 100.0;
/// Largest step of the search, as a fraction of the value or of the larger typical value.
const LARGEST_STEP: f64 = 0.05;
/// Smallest step of the search, as a fraction of the value or of the larger typical value. At this step, the search has
/// found an end.
const RESOLUTION: f64 = 1e-10;
/// Largest number of steps of the search in one direction. Without failures, 162 steps reach a thousand times the typical
/// value.
const MOST_TRIES: usize = 4000;
/// A force below minus this value (N) counts as negative. Smaller negative forces are rounding errors.
pub(super) const NEGATIVE: f64 = 1e-6;
/// Factor 100 in equation (1) of this module, above which a part gives way.
const SOFTENING: f64 = 100.0;

/// Reason why no equilibrium is found beyond a state.
#[derive(Clone, Debug, PartialEq)]
pub enum EndCause {
    /// A motion of a part has no stiffness.
    GivesWay {
        /// Name of the part that gives way.
        part: String,
        /// Direction of the motion without stiffness.
        motion: Motion,
    },
    /// The equilibrium is no longer stable, but every motion has stiffness. The fields describe the softest motion.
    Unstable {
        /// Name of the part with the softest motion.
        part: String,
        /// Direction of the softest motion.
        motion: Motion,
    },
    /// The force that drives the motion reaches [`LARGEST_FORCE`]: rigid parts are fully extended or in contact.
    Force(DrivingForce),
    /// The search reached its largest value. Equilibria may exist beyond it.
    SearchEnds,
    /// The cause is unknown: every motion has stiffness, but Newton's method found no further equilibrium. Or the search
    /// took too many steps.
    Unresolved,
}

/// Force that drives a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrivingForce {
    /// Vertical force at a contact point.
    ContactPoint,
    /// Force along the rack.
    Rack,
}

/// Event between the design position and an end of equilibrium, for example contact with the bump stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The vertical force at a contact point turns negative, although the wheel has a spring.
    WheelLifts,
    /// The suspension meets a stop.
    StopMet(Stop),
    /// The force of a spring with its stops turns negative, and the rebound stop does not act. If it acts, it pulls.
    SpringSlack,
    /// A bushing is deflected beyond an end of its force curve, or rotated by more than 60 degrees.
    Extrapolated,
}

impl Event {
    /// All events that the search looks for.
    pub(super) const ALL: [Event; 5] = [
        Event::WheelLifts,
        Event::StopMet(Stop::Bump),
        Event::StopMet(Stop::Rebound),
        Event::SpringSlack,
        Event::Extrapolated,
    ];
}

/// Returns true for a spring that would have to pull ([`Event::SpringSlack`]).
pub(super) fn is_slack(spring: &SpringReading) -> bool {
    spring.force < -NEGATIVE && !spring.meets(Stop::Rebound)
}

/// End of equilibrium in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumEnd {
    /// Last value of the travel, rack displacement or load with an equilibrium.
    pub value: f64,
    /// Cause of the end of equilibrium.
    pub cause: EndCause,
    /// Events before the end, each with the value beyond which the event is present. The list omits events that are already
    /// present at 0.
    pub events: Vec<(Event, f64)>,
}

/// Range of travels, rack displacements or loads in which the search looks for an end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Typical value in this range. If the present value is smaller, steps are relative to the typical value.
    usual: f64,
    /// Value at which the search ends; negative in the negative direction.
    farthest: f64,
    /// Driving force that ends the search; `None` if the search increases a load.
    driven_by: Option<DrivingForce>,
}

impl Way {
    fn both(usual: f64, farthest: f64, driven_by: Option<DrivingForce>) -> [Self; 2] {
        [-farthest, farthest].each(|farthest| Way {
            usual,
            farthest,
            driven_by,
        })
    }

    /// Returns the ranges for both directions of a travel or a rack displacement.
    pub(super) fn of_motion(millimetre: f64, force: DrivingForce) -> [Self; 2] {
        let (usual, farthest) = (USUAL_TRAVEL * millimetre, LONGEST_TRAVEL * millimetre);
        Way::both(usual, farthest, Some(force))
    }

    /// Returns the ranges for both directions of a force.
    pub(super) fn of_load() -> [Self; 2] {
        Way::both(USUAL_LOAD, LARGEST_LOAD, None)
    }

    /// Returns the ranges for both directions of a moment.
    pub(super) fn of_moment(length: LengthUnit) -> [Self; 2] {
        let metre = length.per_metre();
        Way::both(USUAL_MOMENT * metre, LARGEST_MOMENT * metre, None)
    }
}

/// Reason why the search does not accept a value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Refusal {
    /// No equilibrium exists. The first field is the index of the wheel, for an axle.
    Obstacle(Option<usize>, Obstacle),
    /// The force that drives the motion is too large.
    Force(DrivingForce),
    /// An event for which the search looks has happened.
    Event,
    /// The search took too many steps.
    Tries,
}

/// Result of a search for an end.
#[derive(Clone, Copy, Debug)]
struct Followed<S> {
    value: f64,
    state: S,
    /// Reason for the end; `None` if the search reached its largest value.
    refusal: Option<Refusal>,
}

/// Follows the equilibria from the state at value 0, in steps. `next` finds the state at a value. Its first argument is
/// a neighbouring state.
fn followed<S: Copy>(
    start: &S,
    way: Way,
    mut next: impl FnMut(&S, f64) -> Result<S, Refusal>,
) -> Followed<S> {
    let (mut value, mut state): (f64, S) = (0.0, *start);
    let outward = way.farthest.signum();
    let largest = |value: f64| LARGEST_STEP * value.abs().max(way.usual);
    let mut step = largest(0.0);
    let mut refusal = Refusal::Tries;
    for _ in 0..MOST_TRIES {
        let size = (value.abs() + step).min(way.farthest.abs());
        match next(&state, outward * size) {
            Ok(found) => {
                (value, state) = (outward * size, found);
                if size >= way.farthest.abs() {
                    return Followed {
                        value,
                        state,
                        refusal: None,
                    };
                }
                step = (2.0 * step).min(largest(value));
            }
            Err(why) => {
                refusal = why;
                step *= 0.5;
                if step <= RESOLUTION * value.abs().max(way.usual) {
                    break;
                }
            }
        }
    }
    let is_close = step <= RESOLUTION * value.abs().max(way.usual);
    Followed {
        value,
        state,
        refusal: Some(if is_close { refusal } else { Refusal::Tries }),
    }
}

/// Elastic suspension that the search can follow from equilibrium to equilibrium.
pub(super) trait Followable {
    /// State with all displacements.
    type State: Copy;
    /// Loads, heights and rack displacement of an equilibrium.
    type Task;
    /// Finds the stable equilibrium for given inputs (loads, heights and rack), from a neighbouring state. If a wheel
    /// of an axle fails, the error contains the index of this wheel.
    fn settle(
        &self,
        from: &Self::State,
        task: &Self::Task,
    ) -> Result<Self::State, (Option<usize>, Obstacle)>;
    /// Returns the force that drives a motion. For contact points, this is the vertical force of the largest magnitude.
    fn force(&self, of: DrivingForce, state: &Self::State, task: &Self::Task) -> f64;
    /// Returns true if an event has happened.
    fn is_past(&self, event: Event, state: &Self::State, task: &Self::Task) -> bool;
    /// Returns the size |K^-1 x| of the softest motion in equation (1) of this module, the part that moves, and the
    /// direction of the motion.
    fn softest_motion(
        &self,
        state: &Self::State,
        task: &Self::Task,
    ) -> Option<(f64, (String, Motion))>;
    /// Returns the name of a part with its own degrees of freedom, and the direction in which this part moves without
    /// stiffness.
    fn limb(&self, side: Option<usize>, limb: usize) -> (String, Motion);

    /// Finds the ends of the equilibria in both directions from `start`, the state at value 0.
    fn ends(
        &self,
        start: &Self::State,
        ways: [Way; 2],
        task: impl Fn(f64) -> Self::Task,
    ) -> [EquilibriumEnd; 2] {
        let stiff = self.softest_motion(start, &task(0.0)).map(|(size, _)| size);
        ways.map(|way| self.end(start, way, stiff, &task))
    }

    /// Finds the end of the equilibria in one direction.
    fn end(
        &self,
        start: &Self::State,
        way: Way,
        stiff: Option<f64>,
        task: &impl Fn(f64) -> Self::Task,
    ) -> EquilibriumEnd {
        let next = |from: &Self::State, value: f64| {
            let task = task(value);
            let found = self.settle(from, &task);
            let found = found.map_err(|(side, why)| Refusal::Obstacle(side, why))?;
            match way.driven_by {
                Some(of) if self.force(of, &found, &task).abs() > LARGEST_FORCE => {
                    Err(Refusal::Force(of))
                }
                _ => Ok(found),
            }
        };
        let started = task(0.0);
        let mut open = Vec::from(Event::ALL);
        open.retain(|event| !self.is_past(*event, start, &started));
        let mut seen = Vec::new();
        let Followed {
            value,
            state,
            refusal,
        } = followed(start, way, |from, value| {
            let found = next(from, value)?;
            let task = task(value);
            let news = open
                .iter()
                .filter(|event| self.is_past(**event, &found, &task));
            let news: Vec<Event> = news.copied().collect();
            open.retain(|event| !news.contains(event));
            seen.extend(news);
            Ok(found)
        });
        let first = |event: Event| {
            let before = |from: &Self::State, value: f64| {
                let found = next(from, value)?;
                if self.is_past(event, &found, &task(value)) {
                    Err(Refusal::Event)
                } else {
                    Ok(found)
                }
            };
            (event, followed(start, way, before).value)
        };
        EquilibriumEnd {
            value,
            cause: self.cause(&state, &task(value), refusal, stiff),
            events: seen.into_iter().map(first).collect(),
        }
    }

    /// Finds the cause of an end of equilibrium.
    fn cause(
        &self,
        state: &Self::State,
        task: &Self::Task,
        refusal: Option<Refusal>,
        stiff: Option<f64>,
    ) -> EndCause {
        let (side, obstacle) = match refusal {
            None => return EndCause::SearchEnds,
            Some(Refusal::Force(of)) => return EndCause::Force(of),
            Some(Refusal::Event | Refusal::Tries) => return EndCause::Unresolved,
            Some(Refusal::Obstacle(side, obstacle)) => (side, obstacle),
        };
        let softest = self.softest_motion(state, task);
        let is_soft = |size: f64| stiff.is_some_and(|stiff| size > SOFTENING * stiff);
        match (softest, obstacle) {
            (Some((size, (part, motion))), _) if is_soft(size) => {
                EndCause::GivesWay { part, motion }
            }
            (_, Obstacle::Unstable(Some(limb)) | Obstacle::Singular(Singular::Limb(limb))) => {
                let (part, motion) = self.limb(side, limb);
                EndCause::GivesWay { part, motion }
            }
            (Some((_, (part, motion))), Obstacle::Unstable(None)) => {
                EndCause::Unstable { part, motion }
            }
            _ => EndCause::Unresolved,
        }
    }
}

impl Followable for ElasticWheel {
    type State = State<f64>;
    type Task = Task<f64>;

    fn settle(
        &self,
        from: &State<f64>,
        task: &Task<f64>,
    ) -> Result<State<f64>, (Option<usize>, Obstacle)> {
        let found = self.built.system.newton(from, task, None, self.bounds);
        found.map(|found| found.state).map_err(|why| (None, why))
    }

    fn force(&self, of: DrivingForce, state: &State<f64>, task: &Task<f64>) -> f64 {
        match of {
            DrivingForce::ContactPoint => state.vertical + task.loads.contact.z,
            DrivingForce::Rack => self.rack_force(&equilibrium(state, task)),
        }
    }

    fn is_past(&self, event: Event, state: &State<f64>, task: &Task<f64>) -> bool {
        let at = equilibrium(state, task);
        match event {
            Event::WheelLifts => self.spring(&at).is_some() && self.wheel_load(&at) < -NEGATIVE,
            Event::StopMet(stop) => self.spring(&at).is_some_and(|spring| spring.meets(stop)),
            Event::SpringSlack => self.spring(&at).as_ref().is_some_and(is_slack),
            Event::Extrapolated => self.bushings(&at).iter().any(|own| own.is_extrapolated),
        }
    }

    fn softest_motion(
        &self,
        state: &State<f64>,
        task: &Task<f64>,
    ) -> Option<(f64, (String, Motion))> {
        self.softest(state, task)
    }

    fn limb(&self, _: Option<usize>, limb: usize) -> (String, Motion) {
        (self.built.names[limb].clone(), self.spin_of(limb))
    }
}

/// Makes an equilibrium from a state in balance and its inputs (loads, height and rack displacement).
fn equilibrium(state: &State<f64>, task: &Task<f64>) -> Equilibrium {
    Equilibrium {
        solution: Solution {
            state: *state,
            task: *task,
            steps: 0,
        },
    }
}

impl ElasticWheel {
    /// Returns the smallest and the largest travel at which an equilibrium exists, with the rack held.
    pub fn travel_ends(&self, rack: f64) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let at = self.at(0.0, rack)?;
        let ways = Way::of_motion(self.bounds.millimetre, DrivingForce::ContactPoint);
        Ok(self.ends(&at.solution.state, ways, |travel| level_task(travel, rack)))
    }

    /// Returns the smallest and the largest rack displacement at which an equilibrium exists, at the design height.
    /// Positive is along the kernel's +y.
    pub fn rack_ends(&self) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let at = self.at(0.0, 0.0)?;
        let ways = Way::of_motion(self.bounds.millimetre, DrivingForce::Rack);
        Ok(self.ends(&at.solution.state, ways, |rack| level_task(0.0, rack)))
    }

    /// Returns the smallest and the largest factor on the loads `unit` with which an equilibrium exists. These loads
    /// act in addition to the loads of a station.
    pub(super) fn load_ends(
        &self,
        station: &Equilibrium,
        unit: &WheelLoads,
        held: HeldQuantity,
        ways: [Way; 2],
    ) -> [EquilibriumEnd; 2] {
        let (state, base) = self.held_as(station, held);
        self.ends(&state, ways, |factor| {
            let mut task = base;
            task.loads = base.loads.plus(unit, factor);
            task
        })
    }
}
