//! Set-ups: adjustments that give target static values.
//!
//! Here, threads are threaded adjusters, such as a tie rod. An aim is a value that the set-up must reach. It is a target
//! value of the study, or a value of the design that the set-up keeps. Threads are continuous, but shims come in whole
//! steps. So threads meet their aims exactly, for any choice of shims. Shims minimise the errors of the remaining aims.
//! The error of a shim never affects a value that a thread can meet.
//!
//! Notation: `x` are the amounts of threads and other continuous adjustments. `z` are the amounts of shims (`z_k = s_k
//! m_k`, with the step `s_k` and the whole number `m_k`). `w(x, z)` are the static values of the mechanism after
//! assembly, and `b` are the aims of these values. `W = D dw` are the exact derivatives, weighted by `D`: a tenth of a
//! degree weighs the same as a millimetre.
//!
//! *Aims of the threads.* The rank of `W_x` is the number of aims that the threads can meet. Gram-Schmidt with
//! pivoting over its rows chooses these aims. Each step takes the aim that the threads still change most:
//!
//! ```text
//! i = argmax |w_i|,   u = w_i / |w_i|,   w_j <- w_j - (w_j . u) u                      (1)
//! ```
//!
//! until no significant row remains. `S` are the chosen aims, `R` the others. So a tie rod sets toe, and a pushrod
//! sets the ride height.
//!
//! *First level.* The threads meet the aims `S` by Newton's method. If there are more threads than aims, the method finds
//! the smallest adjustment:
//!
//! ```text
//! x <- x - W_Sx^+ D (w_S - b_S)        which defines x = X(z)                           (2)
//! ```
//!
//! *Second level.* Shims minimise the errors of `R` along `X(z)`; `G` is a Schur complement:
//!
//! ```text
//! phi(z) = |r(z)|^2,   r(z) = D (w_R(X(z), z) - b_R)                                    (3)
//! G = dr/dz = W_Rz - W_Rx W_Sx^+ W_Sz                                                   (4)
//! ```
//!
//! First `z` is real. The Gauss-Newton method finds it, and each of its trials meets (2):
//!
//! ```text
//! z <- z - G^+ r                                                                        (5)
//! ```
//!
//! If the threads meet every aim, `R` is empty. Then (2) over threads and shims together gives the smallest adjustment.
//!
//! *Whole shims.* Near the real optimum `z0`, the `m_k` are `floor(z0_k / s_k)` or one more. A linear model estimates the
//! squared error of at most 2^10 of these combinations (neighbours), and ranks them by it:
//!
//! ```text
//! |r(z0) + G (z - z0)|^2                                                                (6)
//! ```
//!
//! If estimates are equal, the neighbour closer to `z0` ranks first. The program assembles the eight best neighbours and
//! the neighbour nearest to `z0`. Equation (2) sets the threads. The program prefers first the neighbours with errors of
//! at most half a step,
//!
//! ```text
//! |r_i| <= sum over shims of s_k |G_ik| / 2                                             (7)
//! ```
//!
//! then the neighbour with the least `phi`, then the one with the smallest adjustment. Errors `|r|` that differ by less
//! than 0.005 degrees or 0.05 mm count as equal.
//!
//! If (2) or (5) misses its aims, the solver drops the aim with the largest error and meets the other aims from that
//! state. So the solver never reports an aim as out of reach only because another aim prevented it.
//!
//! A mechanic fits shims first, then turns the threads by sixteenths of a turn. If toe has an aim, the thread that changes toe most
//! comes last. The solver also assembles the rounded state. The allowed errors of this state are the errors of equation (7), plus
//! the effect of half a sixteenth of a turn of each thread.

mod elastic;
mod levels;
mod problem;
mod shims;
mod subject;

use super::assembler::Assembler;
use super::assembly_error::AssemblyError;
use super::rest::Built;
use crate::ask::Unit;
use crate::axle::Quantity;
use crate::characteristics::Characteristic;
use crate::mechanism::{DesignFault, NoPose};
use crate::model::Side;
use crate::study::{AxleStudy, Increment, Setup, Study};
use problem::Problem;

/// Largest adjustment, relative to the size of the suspension.
const FARTHEST: f64 = 0.1;
/// Errors of a static value up to this size count as rounding errors, in degrees or length units.
const MET: f64 = 1e-9;
/// Number of steps per turn of a threaded adjuster. A mechanic turns it by sixteenths of a turn.
pub const PARTS_OF_A_TURN: f64 = 16.0;

/// A quantity of the static position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Static {
    /// A characteristic of one wheel at travel 0, or of each wheel if both wheels are alike.
    Characteristic(Characteristic),
    /// A static quantity of an axle whose wheels are set up together. Position and direction of a solid axle are
    /// measured from the nominal design.
    Axle(Quantity),
    /// Change of the ride height from the design. Positive if the car is higher. The change is the negative of the
    /// wheel travel of the static position.
    RideHeightChange,
}

impl Static {
    /// Unit of the value.
    pub fn unit(self) -> Unit {
        match self {
            Static::Characteristic(c) => c.info().unit,
            Static::Axle(quantity) => quantity.info().unit,
            Static::RideHeightChange => Unit::Length,
        }
    }

    /// Characteristic of a wheel. `None` if the value is not a characteristic.
    fn characteristic(self) -> Option<Characteristic> {
        match self {
            Static::Characteristic(of) | Static::Axle(Quantity::Corner(_, of)) => Some(of),
            _ => None,
        }
    }

    /// Wheel of the value, if it belongs to one wheel of an axle.
    fn side(self) -> Option<Side> {
        match self {
            Static::Axle(Quantity::Corner(side, _)) => Some(side),
            _ => None,
        }
    }
}

/// A suspension in its static position, with its parts adjusted.
#[derive(Clone, Debug)]
pub struct AdjustedSuspension {
    /// Amount of each adjustment, in the order of the study.
    pub amounts: Vec<f64>,
    /// Assembled parts. For a solid axle, in the frame of its left wheel.
    pub built: Built,
    /// For a solid axle, the same axle in the frame of its right wheel. For independent wheels that are set up
    /// together, the right wheel. `None` for one wheel, and if both wheels are alike.
    pub seen_from_right: Option<Built>,
    /// Static values, in printed units. With elastic parts, these are the values in equilibrium.
    pub values: Vec<f64>,
    /// Derivatives of the static values, `[adjustment][value]`.
    pub by: Vec<Vec<f64>>,
}

/// Aim of a static value: the value that the set-up must reach, if there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Target value of the study, in printed units.
    Wanted(f64),
    /// Value of the design, which the set-up must keep. The study gives no target for this value, but an adjustment
    /// that changes it.
    Kept(f64),
    /// No target. The value may change.
    Free,
}

impl Aim {
    /// Value to meet. `None` if the value may change.
    pub fn value(self) -> Option<f64> {
        match self {
            Aim::Wanted(value) | Aim::Kept(value) => Some(value),
            Aim::Free => None,
        }
    }
}

/// A solved set-up.
#[derive(Clone, Debug)]
pub struct SetUp {
    /// Static values: camber, toe, caster and bump steer (if they are defined), other values with targets, and the
    /// change of ride height. An axle that is set up as a whole has camber, toe and caster of both wheels, and no bump
    /// steer. A solid axle also has its own position and direction.
    pub statics: Vec<Static>,
    /// Aim of each static value.
    pub aims: Vec<Aim>,
    /// State of the nominal design. This state is at the target ride height if no adjustment sets that height.
    pub drawn: AdjustedSuspension,
    /// Indices of the adjustments in the order in which a mechanic makes them: shims, then threaded adjusters. If toe
    /// has a target or is kept, the adjuster that changes toe most comes last.
    pub order: Vec<usize>,
    /// State after each adjustment, in the order of `order`. Only shims are rounded.
    pub steps: Vec<AdjustedSuspension>,
    /// State with amounts that a mechanic can set: whole shims, sixteenths of turns, hundredths of a millimetre.
    pub rounded: AdjustedSuspension,
    /// State after each adjustment with the amounts of `rounded`, in the order of `order`. The last one is
    /// [`SetUp::rounded`].
    pub rounded_steps: Vec<AdjustedSuspension>,
    /// Allowed error of each value: the effect of half a step of each shim. 0 for a value that threads meet.
    pub allowed: Vec<f64>,
    /// Allowed error of each value after rounding. It also includes the effect of half a sixteenth of a turn of each
    /// threaded adjuster.
    pub allowed_rounded: Vec<f64>,
}

/// A target value that the set-up misses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissedTarget {
    /// Static value that misses its target.
    pub of: Static,
    /// Value that is reached, in printed units.
    pub value: f64,
    /// Target value, in printed units.
    pub wanted: f64,
}

/// Reason why a set-up has no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum SetUpError {
    /// The parts of the design, or slightly adjusted parts, cannot be assembled.
    AssemblyError(AssemblyError),
    /// The assembled parts form a design that cannot move.
    Fault(DesignFault),
    /// The elastic parts have no equilibrium at rest.
    NoEquilibrium(NoPose),
    /// The adjustments cannot keep the values that must stay constant: they have no effect on one of them, or cannot
    /// change them independently of each other.
    Unsettled,
    /// The adjustments cannot reach these target values.
    OutOfReach(Vec<MissedTarget>),
    /// The target values need an unrealistic adjustment: more than a tenth of the suspension's size.
    Absurd {
        /// Index of the adjustment.
        adjustment: usize,
        /// Required amount of this adjustment.
        amount: f64,
    },
}

impl From<AssemblyError> for SetUpError {
    fn from(reject: AssemblyError) -> Self {
        SetUpError::AssemblyError(reject)
    }
}

impl From<DesignFault> for SetUpError {
    fn from(fault: DesignFault) -> Self {
        SetUpError::Fault(fault)
    }
}

impl SetUp {
    /// Finds the adjustments that give the target values. They apply to one wheel, or to both wheels of an axle with
    /// elastic parts and equal wheels.
    pub fn solve(study: &Study, setup: &Setup, assembler: &Assembler) -> Result<SetUp, SetUpError> {
        SetUp::solve_problem(Problem::of(study, setup, assembler)?, setup)
    }

    /// Finds the adjustments of an axle whose wheels are set up together, from the assemblers of its left and its right
    /// wheel. For a solid axle, each assembler assembles the whole axle, as seen from one wheel.
    pub fn solve_axle(
        both: &AxleStudy,
        setup: &Setup,
        assemblers: [&Assembler; 2],
    ) -> Result<SetUp, SetUpError> {
        SetUp::solve_problem(Problem::of_axle(both, setup, assemblers)?, setup)
    }

    fn solve_problem(
        (problem, drawn): (Problem, AdjustedSuspension),
        setup: &Setup,
    ) -> Result<SetUp, SetUpError> {
        let (state, levels) = problem.solve(&drawn)?;
        let most = FARTHEST * problem.size();
        let mut amounts = state.amounts.iter().copied().enumerate();
        if let Some((adjustment, amount)) = amounts.find(|(_, amount)| amount.abs() > most) {
            return Err(SetUpError::Absurd { adjustment, amount });
        }
        let order = problem.order(&drawn);
        let after_each = |amounts: &[f64]| -> Result<Vec<AdjustedSuspension>, SetUpError> {
            let mut set = vec![0.0; order.len()];
            let step = |adjustment: &usize| {
                set[*adjustment] = amounts[*adjustment];
                problem.state(&set)
            };
            order.iter().map(step).collect()
        };
        let steps = after_each(&state.amounts)?;
        let increments = setup.adjust.iter().map(|a| a.increment);
        let rounded: Vec<f64> = increments
            .zip(&state.amounts)
            .map(|(increment, amount)| problem.rounded(increment, *amount))
            .collect();
        let rounded_steps = after_each(&rounded)?;
        let allowed = problem.half_steps(&levels, &state);
        Ok(SetUp {
            allowed_rounded: problem.with_half_turns(&allowed, &state),
            allowed,
            rounded: rounded_steps.last().unwrap_or(&drawn).clone(),
            rounded_steps,
            drawn,
            order,
            steps,
            statics: problem.statics,
            aims: problem.aims,
        })
    }

    /// Returns the state of the nominal design with the effects of each adjustment, even if there is no set-up.
    pub fn drawn(study: &Study, setup: &Setup, assembler: &Assembler) -> Result<SetUp, SetUpError> {
        Problem::of(study, setup, assembler).map(SetUp::unsolved)
    }

    /// Returns the same state as [`SetUp::drawn`] for an axle whose wheels are set up together, from the assemblers of
    /// its left and its right wheel.
    pub fn drawn_axle(
        both: &AxleStudy,
        setup: &Setup,
        assemblers: [&Assembler; 2],
    ) -> Result<SetUp, SetUpError> {
        Problem::of_axle(both, setup, assemblers).map(SetUp::unsolved)
    }

    fn unsolved((problem, drawn): (Problem, AdjustedSuspension)) -> SetUp {
        SetUp {
            allowed: vec![0.0; problem.statics.len()],
            allowed_rounded: vec![0.0; problem.statics.len()],
            rounded: drawn.clone(),
            order: problem.order(&drawn),
            steps: Vec::new(),
            rounded_steps: Vec::new(),
            drawn,
            statics: problem.statics,
            aims: problem.aims,
        }
    }

    /// State after all adjustments, not rounded.
    pub fn last(&self) -> &AdjustedSuspension {
        self.steps.last().unwrap_or(&self.drawn)
    }

    /// Error of each static value with the unrounded amounts: the value minus its target. `None` for a value without a
    /// target.
    pub fn misses(&self) -> Vec<Option<f64>> {
        self.errors(self.last())
    }

    /// Error of each static value with the amounts that a mechanic can set: the value minus its target. `None` for a
    /// value without a target.
    pub fn misses_rounded(&self) -> Vec<Option<f64>> {
        self.errors(&self.rounded)
    }

    fn errors(&self, state: &AdjustedSuspension) -> Vec<Option<f64>> {
        let values = state.values.iter().zip(&self.aims);
        values
            .map(|(value, aim)| Some(value - aim.value()?))
            .collect()
    }

    /// Returns for each static value whether the unrounded amounts meet its target. The allowed error is the effect of
    /// half a step of each shim. A value without a target counts as met.
    pub fn met(&self) -> Vec<bool> {
        within(&self.misses(), &self.allowed)
    }

    /// Returns for each static value whether the rounded amounts meet its target. The allowed error is the effect of
    /// half a step of each shim and half a sixteenth of a turn of each threaded adjuster. A value without a target
    /// counts as met.
    pub fn met_rounded(&self) -> Vec<bool> {
        within(&self.misses_rounded(), &self.allowed_rounded)
    }

    /// Returns true if the unrounded and the rounded amounts both meet every target.
    pub fn is_met(&self) -> bool {
        let mut met = self.met().into_iter().chain(self.met_rounded());
        met.all(|met| met)
    }
}

/// Returns for each error whether it is at most the allowed error plus rounding. A missing error, of a value without a
/// target, counts as allowed.
fn within(errors: &[Option<f64>], allowed: &[f64]) -> Vec<bool> {
    let pairs = errors.iter().zip(allowed);
    pairs
        .map(|(error, allowed)| error.is_none_or(|error| error.abs() <= MET + allowed))
        .collect()
}

/// Returns true if an adjustment is continuous, that is, not made with whole shims.
fn is_continuous(increment: Increment) -> bool {
    !matches!(increment, Increment::Shims { .. })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value meets its target if the error is at most the allowed error plus 1e-9.
    #[test]
    fn aims_are_met_to_rounding() {
        let errors = [5e-9, -5e-9, 5e-10, -5e-10, 0.5, -0.501].map(Some);
        let allowed = [0.0, 0.0, 0.0, 0.0, 0.5, 0.5];
        let expected = [false, false, true, true, true, false];
        assert_eq!(within(&errors, &allowed), expected);
        assert_eq!(within(&[None], &[0.0]), [true]);
    }
}
