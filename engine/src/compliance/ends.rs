//! Ends of equilibrium: the travel, rack or load at which a part of the suspension gives way.
//!
//! A value moves outward from a known equilibrium in steps of at most a twentieth of itself. Each state starts Newton's
//! method for the next one. A step without a stable equilibrium is halved, and the step after a success is doubled. The
//! search ends when the step is 1e-10 of the value. The last state has an equilibrium, and no larger value was found to
//! have one.
//!
//! At such an end the tangent is singular: a motion has no stiffness. With K the tangent and x the motion that inverse
//! iteration finds, the end is a part that gives way if
//!
//! ```text
//! |K^-1 x| at the end  >  100 |K^-1 x| at the start                                               (1)
//! ```
//!
//! At a fold K^-1 grows with the inverse root of the way that is left, at 1e-10 by about 1e5. Torque laws of large turns and
//! side forces that follow the wheel have no energy, and K is not symmetric. Then a state can lose its stability
//! (`solve.rs`) while K stays regular. Without both, Newton's method has failed for another reason, and the end is not known.

use super::fault::{Motion, NoEquilibrium};
use super::loads::WheelLoads;
use super::solve::{Obstacle, Solution};
use super::system::{Singular, State, Task};
use super::wheel::{ElasticWheel, Equilibrium, HeldQuantity, level_task};
use crate::model::LengthUnit;

/// Force (N) at which the search along a motion ends.
pub const LARGEST_FORCE: f64 = 1e6;
/// Load (N) at which the search along a load ends.
const LARGEST_LOAD: f64 = 1e6;
/// Moment (N m) at which the search along a moment ends.
const LARGEST_MOMENT: f64 = 1e5;
/// Travel or rack displacement (mm) at which the search ends.
const LONGEST_TRAVEL: f64 = 1000.0;
/// Values from which steps are counted: mm, N, N m.
const USUAL_TRAVEL: f64 = 20.0;
const USUAL_LOAD: f64 = 1000.0;
const USUAL_MOMENT: f64 = 100.0;
/// Largest step, as a share of the value.
const LARGEST_STEP: f64 = 0.05;
/// Step at which an end is known, as a share of the value.
const RESOLUTION: f64 = 1e-10;
/// Most steps in one direction. Without failures 140 reach a thousand times the usual value.
const MOST_TRIES: usize = 4000;
/// A force below minus this (N) is not rounding.
pub(super) const NEGATIVE: f64 = 1e-6;
/// Growth of (1).
const SOFTENING: f64 = 100.0;

/// Reason why equilibria end.
#[derive(Clone, Debug, PartialEq)]
pub enum EndCause {
    /// A motion of a part has no stiffness.
    GivesWay {
        /// Name of the part.
        part: String,
        /// The motion.
        motion: Motion,
    },
    /// The equilibrium is no longer stable, and no motion is without stiffness: the softest motion.
    Unstable {
        /// Name of the part.
        part: String,
        /// The motion.
        motion: Motion,
    },
    /// The force that drives the motion is [`LARGEST_FORCE`]: rigid parts are stretched straight or have met.
    Force(DrivingForce),
    /// The search ended at its largest value. Equilibria go on.
    SearchEnds,
    /// Newton's method found no further equilibrium, and no motion is without stiffness.
    Unresolved,
}

/// Force that drives a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrivingForce {
    /// The vertical force at a contact point.
    ContactPoint,
    /// The force along the rack.
    Rack,
}

/// Event on the way to an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The vertical force at a contact point turns negative, although there is a spring.
    WheelLifts,
    /// A bump stop is met.
    StopMet,
    /// A spring has no force left.
    SpringSlack,
    /// The law of a bushing is continued beyond its points, or its rotation is above 60 degrees.
    Extrapolated,
}

impl Event {
    /// Every event.
    pub(super) const ALL: [Event; 4] = [
        Event::WheelLifts,
        Event::StopMet,
        Event::SpringSlack,
        Event::Extrapolated,
    ];
}

/// An end of equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct EquilibriumEnd {
    /// The last value with an equilibrium.
    pub value: f64,
    /// Reason.
    pub cause: EndCause,
    /// First values at which something happens on the way, beside what is the case at 0.
    pub events: Vec<(Event, f64)>,
}

/// Values that a search goes through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Size from which steps are counted.
    usual: f64,
    /// Value at which the search ends; negative for the lower end.
    farthest: f64,
    /// Force that ends the search; `None` along a load.
    driven_by: Option<DrivingForce>,
}

impl Way {
    fn both(usual: f64, farthest: f64, driven_by: Option<DrivingForce>) -> [Self; 2] {
        [-farthest, farthest].map(|farthest| Way {
            usual,
            farthest,
            driven_by,
        })
    }

    /// Both directions of a travel or a rack.
    pub(super) fn of_motion(millimetre: f64, force: DrivingForce) -> [Self; 2] {
        let (usual, farthest) = (USUAL_TRAVEL * millimetre, LONGEST_TRAVEL * millimetre);
        Way::both(usual, farthest, Some(force))
    }

    /// Both directions of a force.
    pub(super) fn of_load() -> [Self; 2] {
        Way::both(USUAL_LOAD, LARGEST_LOAD, None)
    }

    /// Both directions of a moment.
    pub(super) fn of_moment(length: LengthUnit) -> [Self; 2] {
        let metre = length.per_metre();
        Way::both(USUAL_MOMENT * metre, LARGEST_MOMENT * metre, None)
    }
}

/// Reason why a value is not taken.
#[derive(Clone, Copy, Debug)]
pub(super) enum Refusal {
    /// No equilibrium; of an axle with the wheel.
    Obstacle(Option<usize>, Obstacle),
    /// The force is too large.
    Force(DrivingForce),
    /// An event has happened.
    Event,
    /// Too many steps.
    Tries,
}

/// The end of a search.
#[derive(Clone, Copy, Debug)]
struct Followed<S> {
    value: f64,
    state: S,
    /// `None` if the search reached its largest value.
    refusal: Option<Refusal>,
}

/// Follows equilibria from the state of value 0. `next` finds the state of a value from a neighbour.
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

/// An elastic suspension whose equilibria can be followed.
pub(super) trait Followable {
    /// Displacements.
    type State: Copy;
    /// Loads, heights and rack.
    type Task;
    /// The stable equilibrium of a task from a neighbour. An obstacle of one wheel of an axle comes with its number.
    fn settle(
        &self,
        from: &Self::State,
        task: &Self::Task,
    ) -> Result<Self::State, (Option<usize>, Obstacle)>;
    /// The force that drives a motion; at contact points the largest one.
    fn force(&self, of: DrivingForce, state: &Self::State, task: &Self::Task) -> f64;
    /// Returns true if an event has happened.
    fn is_past(&self, event: Event, state: &Self::State, task: &Self::Task) -> bool;
    /// The softest motion: |K^-1 x| of (1), and the part.
    fn softest_motion(
        &self,
        state: &Self::State,
        task: &Self::Task,
    ) -> Option<(f64, (String, Motion))>;
    /// The part that an eliminated part is, and its free motion.
    fn limb(&self, side: Option<usize>, limb: usize) -> (String, Motion);

    /// Both ends of the equilibria from `start`, the state of value 0.
    fn ends(
        &self,
        start: &Self::State,
        ways: [Way; 2],
        task: impl Fn(f64) -> Self::Task,
    ) -> [EquilibriumEnd; 2] {
        let stiff = self.softest_motion(start, &task(0.0)).map(|(size, _)| size);
        ways.map(|way| self.end(start, way, stiff, &task))
    }

    /// The end in one direction.
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
                match self.is_past(event, &found, &task(value)) {
                    true => Err(Refusal::Event),
                    false => Ok(found),
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

    /// Reason of an end.
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
            Event::StopMet => self.spring(&at).is_some_and(|spring| spring.meets_stop),
            Event::SpringSlack => self
                .spring(&at)
                .is_some_and(|spring| spring.force < -NEGATIVE),
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

/// A state that is an equilibrium.
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
    /// The least and the largest travel with an equilibrium, the rack held.
    pub fn travel_ends(&self, rack: f64) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let at = self.at(0.0, rack)?;
        let ways = Way::of_motion(self.bounds.millimetre, DrivingForce::ContactPoint);
        Ok(self.ends(&at.solution.state, ways, |travel| level_task(travel, rack)))
    }

    /// The least and the largest rack displacement along the kernel's +y with an equilibrium, at the design height.
    pub fn rack_ends(&self) -> Result<[EquilibriumEnd; 2], NoEquilibrium> {
        let at = self.at(0.0, 0.0)?;
        let ways = Way::of_motion(self.bounds.millimetre, DrivingForce::Rack);
        Ok(self.ends(&at.solution.state, ways, |rack| level_task(0.0, rack)))
    }

    /// The least and the largest multiple of a load beside those of a station.
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
            task.loads.trail = unit.trail;
            task
        })
    }
}
