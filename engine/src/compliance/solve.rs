//! Equilibrium by Newton's method, with a gradual increase of the loads.
//!
//! Between two equilibria, loads, wheel travel and rack change together along a straight line. The solver first tries the
//! whole change. It tries half of the present fraction of the change if
//!
//! - the first correction exceeds 60 mm or 0.3 rad: the linear prediction is not reliable,
//! - a correction exceeds 0.8 of the previous correction: the method does not contract,
//! - the equations are singular, or the method needs more than 140 steps,
//! - the result is not stable.
//!
//! Corrections s converge as s_(k+1) <= C s_k^2, since the tangents are exact. C is the largest s_(k+1) / s_k^2 so far
//! (P. Deuflhard, *Newton Methods for Nonlinear Problems*, Springer 2004, section 2.1, estimates contraction in this
//! way). If the estimate of the next correction is far below the limit for the last correction, the solver omits the
//! next correction. In 1,300 equilibria, the omitted corrections were below 0.13 of that limit.
//!
//! A state is stable if the symmetric part of the tangent is positive definite on the free motions. Rigid joints and
//! the held height restrict these motions. The solver checks the stability first in every eliminated part, then in the
//! remaining equations of the carrier. If the solver fails, the fraction of the change that it reached is accurate to
//! 2e-6.

use super::limb::is_positive;
use super::system::{Equations, Held, Hold, Singular, State, Step, System, Task};
use crate::linear::square::MOST;
use crate::number::{Each, Scalar, Valued, array_of, larger};
use crate::threads::checkpoint;

/// Lever, mm, that converts a rotation to a displacement for comparison with a shift.
const TURN_LEVER: f64 = 300.0;
/// Largest shift in the first correction of Newton's method, mm.
const LONGEST_SHIFT: f64 = 60.0;
/// Largest rotation in the first correction of Newton's method, radians.
const LARGEST_TURN: f64 = 0.3;
/// Largest ratio of a correction of Newton's method to the previous correction.
const CONTRACTION: f64 = 0.8;
/// The solver has converged if the shift in the last correction is at most this, mm.
const LAST_SHIFT: f64 = 1e-11;
/// The solver has converged if the rotation in the last correction is at most this, radians.
const LAST_TURN: f64 = 1e-13;
/// If a correction is below this limit, in mm, a lack of contraction is due to rounding errors. Without rounding,
/// Newton's method converges quadratically there. Near the largest load that a wheel can carry, rounding errors of the
/// forces move the wheel further than the limit for the last correction.
const ROUNDING: f64 = 1e-8;
/// The solver omits a correction if its estimate is below the limit for the last correction, divided by this number.
const FORESEEN: f64 = 100.0;
/// Smallest fraction of the change in one step.
const LEAST_SHARE: f64 = 1e-6;
/// Largest number of Newton steps for one fraction of the change. If every step reduces the correction by the factor 0.8,
/// this number of steps reduces 60 mm to 1e-11 mm.
const MOST_STEPS: usize = 140;

/// Reason why there is no equilibrium after a fraction of the change of loads, travel and rack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Obstacle {
    /// A motion has no stiffness.
    Singular(Singular),
    /// Newton's method does not converge.
    Diverges,
    /// The state is not stable. The field is the index of the first unstable part; `None` for the carrier.
    Unstable(Option<usize>),
}

/// Equilibrium with its inputs: loads, rack displacement, and the height or load that is held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution<T> {
    pub(super) state: State<T>,
    pub(super) task: Task<T>,
    /// Number of Newton steps to this equilibrium. Steps of failed attempts do not count.
    pub(super) steps: usize,
}

/// Result of a solver run that did not reach the equilibrium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stuck {
    /// Fraction of the change that the solver reached.
    pub(super) share: f64,
    pub(super) obstacle: Obstacle,
    /// Last state on the path, with its inputs; `None` if the solver reached no fraction. At this state, only the reached
    /// part of the load acts; the remaining unbalanced force may not be zero.
    pub(super) last: Option<(State<f64>, Task<f64>)>,
}

/// Limits of Newton's method, in the length unit of the study.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Study units per millimetre.
    pub(super) millimetre: f64,
}

impl Bounds {
    /// Lever, in the length unit of the study, that converts a rotation to a displacement.
    pub(super) fn lever(&self) -> f64 {
        TURN_LEVER * self.millimetre
    }

    fn size(&self, [shift, turn]: [f64; 2]) -> f64 {
        larger(shift / self.millimetre, turn * TURN_LEVER)
    }

    fn is_last(&self, [shift, turn]: [f64; 2]) -> bool {
        shift <= LAST_SHIFT * self.millimetre && turn <= LAST_TURN
    }

    fn is_too_far(&self, [shift, turn]: [f64; 2]) -> bool {
        let near = shift <= LONGEST_SHIFT * self.millimetre && turn <= LARGEST_TURN;
        !near
    }
}

impl Equations<f64> {
    /// Checks the stability of a state.
    pub(super) fn check_stable(&self, bounds: Bounds) -> Result<(), Obstacle> {
        if self.unstable.is_some() {
            return Err(Obstacle::Unstable(self.unstable));
        }
        if is_definite(self, bounds, 0.0) {
            Ok(())
        } else {
            Err(Obstacle::Unstable(None))
        }
    }
}

impl<T: Valued> System<T> {
    /// Computes the Newton step in a state. The equations of this state overwrite the equations of the earlier state.
    #[inline(always)]
    pub(super) fn newton_step(
        &self,
        state: &State<T>,
        task: &Task<T>,
        held: Option<&Held<T>>,
        equations: &mut Equations<T>,
    ) -> Result<Step<T>, Obstacle> {
        self.renew_equations(state, task, held, equations)
            .map_err(Obstacle::Singular)?;
        let solution = equations
            .solution()
            .ok_or(Obstacle::Singular(Singular::Carrier))?;
        Ok(equations.step(&solution, false))
    }
}

impl System<f64> {
    /// Runs Newton's method from a state.
    #[inline]
    pub(super) fn newton(
        &self,
        start: &State<f64>,
        task: &Task<f64>,
        held: Option<&Held<f64>>,
        bounds: Bounds,
    ) -> Result<Solution<f64>, Obstacle> {
        let mut state = *start;
        let mut judge = Judge::new(bounds);
        let mut equations = Equations::empty(task.rack, self.joints.len(), held);
        loop {
            checkpoint();
            let step = self.newton_step(&state, task, held, &mut equations)?;
            let verdict = judge.judge(self.size_of(&step))?;
            state = self.stepped(&state, &step);
            if verdict == Verdict::Settled {
                equations.check_stable(bounds)?;
                return Ok(Solution {
                    state,
                    task: *task,
                    steps: judge.steps(),
                });
            }
        }
    }

    /// Finds an equilibrium. The search starts from another equilibrium, or from a pose in which the external forces
    /// `held` keep the balance.
    #[inline]
    pub(super) fn solve(
        &self,
        start: &State<f64>,
        from: &Task<f64>,
        to: &Task<f64>,
        held: Option<&Held<f64>>,
        bounds: Bounds,
    ) -> Result<Solution<f64>, Box<Stuck>> {
        let newton = |state: &State<f64>, share: f64, is_first: bool| {
            let task = between(from, to, share);
            let rest = held
                .filter(|_| !is_first)
                .map(|held| held.share(1.0 - share));
            let found = self.newton(state, &task, rest.as_ref(), bounds)?;
            Ok((found.state, found.steps))
        };
        match raised(start, newton) {
            Ok((state, steps)) => Ok(Solution {
                state,
                task: *to,
                steps,
            }),
            Err(Unraised {
                share,
                obstacle,
                last,
            }) => Err(Box::new(Stuck {
                share,
                obstacle,
                last: last.map(|state| (state, between(from, to, share))),
            })),
        }
    }
}

/// Result of a load increase that stopped before the full load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unraised<S> {
    pub(super) share: f64,
    pub(super) obstacle: Obstacle,
    /// State at the fraction of the load that was reached; `None` if the solver reached no fraction.
    pub(super) last: Option<S>,
}

/// Increases the loads, first in one step, then in fractions if this step fails. `newton` finds the state at a fraction
/// from another state; its last argument is true for the first attempt. Returns the state and the number of Newton
/// steps of the successful attempts.
#[inline]
pub(super) fn raised<S: Copy>(
    start: &S,
    mut newton: impl FnMut(&S, f64, bool) -> Result<(S, usize), Obstacle>,
) -> Result<(S, usize), Unraised<S>> {
    if let Ok(found) = newton(start, 1.0, true) {
        return Ok(found);
    }
    let (mut reached, mut step, mut state) = (0.0, 0.5, *start);
    let mut steps = 0;
    let mut last = None;
    loop {
        let share: f64 = if reached + step < 1.0 {
            reached + step
        } else {
            1.0
        };
        match newton(&state, share, false) {
            Ok((found, more)) => {
                steps += more;
                if share >= 1.0 {
                    return Ok((found, steps));
                }
                (reached, state) = (share, found);
                last = Some(found);
                step *= 2.0;
            }
            Err(obstacle) => {
                step *= 0.5;
                if step < LEAST_SHARE {
                    return Err(Unraised {
                        share: reached,
                        obstacle,
                        last,
                    });
                }
            }
        }
    }
}

/// Checks the convergence of Newton's method from its corrections.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judge {
    bounds: Bounds,
    before: f64,
    /// Largest ratio of a correction to the square of the previous correction.
    quotient: f64,
    steps: usize,
}

/// Result of the convergence check after a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The state after the correction is final.
    Settled,
    /// The solver needs another correction.
    GoesOn,
}

impl Judge {
    pub(super) fn new(bounds: Bounds) -> Self {
        Judge {
            bounds,
            before: f64::INFINITY,
            quotient: 0.0,
            steps: 0,
        }
    }

    /// Checks a correction of Newton's method by its largest shift and its largest rotation.
    #[inline]
    pub(super) fn judge(&mut self, sizes: [f64; 2]) -> Result<Verdict, Obstacle> {
        self.steps += 1;
        if self.steps == 1 && self.bounds.is_too_far(sizes) || self.steps > MOST_STEPS {
            return Err(Obstacle::Diverges);
        }
        let size = self.bounds.size(sizes);
        // A correction that is NaN fails this comparison.
        let contracts = size < CONTRACTION * self.before;
        let is_rounding = size < ROUNDING && !contracts;
        // The first correction has no predecessor.
        let quotient = size / (self.before * self.before);
        self.quotient = self.quotient.max(quotient);
        let next = sizes.each(|part| FORESEEN * part * self.quotient * size);
        let is_foreseen = self.steps > 1 && contracts && self.bounds.is_last(next);
        if self.bounds.is_last(sizes) || is_rounding || is_foreseen {
            return Ok(Verdict::Settled);
        }
        if !contracts {
            return Err(Obstacle::Diverges);
        }
        self.before = size;
        Ok(Verdict::GoesOn)
    }

    /// Number of corrections that have been checked: the number of Newton steps.
    pub(super) fn steps(&self) -> usize {
        self.steps
    }
}

/// Returns the inputs of an equilibrium at a fraction of the way between two inputs with the same held quantity.
pub(super) fn between(from: &Task<f64>, to: &Task<f64>, share: f64) -> Task<f64> {
    let hold = match (from.hold, to.hold) {
        (Hold::Height(a), Hold::Height(b)) => Hold::Height(a + (b - a) * share),
        _ => to.hold,
    };
    Task {
        rack: from.rack + (to.rack - from.rack) * share,
        hold,
        loads: from.loads.towards(&to.loads, share),
    }
}

/// Returns true if the symmetric part of the carrier's tangent is positive definite for some motions. These are the motions that
/// keep the rigid joints closed and the held heights constant. Each pivot must exceed the fraction `least_share` of the largest
/// earlier pivot.
pub(super) fn is_definite<T: Scalar>(
    equations: &Equations<T>,
    bounds: Bounds,
    least_share: f64,
) -> bool {
    let mut rows = [[0.0; 6]; MOST - 6];
    let mut count = 0;
    for row in equations.rows() {
        rows[count] = row;
        count += 1;
    }
    is_definite_on(
        &equations.tangent(),
        &mut rows[..count],
        bounds,
        least_share,
    )
}

/// Returns true if a tangent of the carrier is positive definite for the motions that satisfy these rows, like
/// [`is_definite`].
pub(super) fn is_definite_on(
    tangent: &[[f64; 6]; 6],
    rows: &mut [[f64; 6]],
    bounds: Bounds,
    least_share: f64,
) -> bool {
    let lever = bounds.lever();
    let scale = |i: usize| if i < 3 { 1.0 } else { 1.0 / lever };
    for row in &mut *rows {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry *= scale(j);
        }
    }
    let Some((motions, free)) = null_space(rows) else {
        return false;
    };
    let mut projected = [[0.0; 6]; 6];
    for b in 0..free {
        let motion: [f64; 6] = array_of(|j| scale(j) * motions[b][j]);
        let mut moved = [0.0; 6];
        for i in 0..6 {
            for j in 0..6 {
                moved[i] += tangent[i][j] * motion[j];
            }
            moved[i] *= scale(i);
        }
        for a in 0..free {
            for i in 0..6 {
                projected[a][b] += motions[a][i] * moved[i];
            }
        }
    }
    is_positive_on(projected, free, least_share)
}

/// Returns true if the first `free` rows and columns of a matrix are positive definite. Each pivot must exceed the
/// fraction `least_share` of the largest earlier pivot. The function fills the rest of the diagonal with the largest
/// diagonal entry.
pub(super) fn is_positive_on<const N: usize>(
    mut matrix: [[f64; N]; N],
    free: usize,
    least_share: f64,
) -> bool {
    let largest = (0..free).map(|a| matrix[a][a]).fold(0.0, f64::max);
    for (a, row) in matrix.iter_mut().enumerate().skip(free) {
        row[a] = if free == 0 { 1.0 } else { largest };
    }
    is_positive(&matrix, least_share)
}

/// Returns a basis of the motions that satisfy all rows, and the number of these motions. `None` if the rows are
/// linearly dependent.
fn null_space(rows: &mut [[f64; 6]]) -> Option<([[f64; 6]; 6], usize)> {
    let mut pivots = [6; 6];
    let mut is_pivot = [false; 6];
    for k in 0..rows.len() {
        let mut largest = (0.0, k, 0);
        for (i, row) in rows.iter().enumerate().skip(k) {
            for (j, entry) in row.iter().enumerate() {
                if !is_pivot[j] && entry.abs() > largest.0 {
                    largest = (entry.abs(), i, j);
                }
            }
        }
        let (size, i, j) = largest;
        if size < 1e-12 {
            return None;
        }
        rows.swap(k, i);
        let inverse = 1.0 / rows[k][j];
        rows[k].iter_mut().for_each(|entry| *entry *= inverse);
        let row = rows[k];
        for (other, entries) in rows.iter_mut().enumerate() {
            if other != k {
                let factor = entries[j];
                for (entry, of_row) in entries.iter_mut().zip(row) {
                    *entry -= factor * of_row;
                }
            }
        }
        pivots[k] = j;
        is_pivot[j] = true;
    }
    let mut motions = [[0.0; 6]; 6];
    let mut count = 0;
    for free in (0..6).filter(|j| !is_pivot[*j]) {
        motions[count][free] = 1.0;
        for (row, pivot) in rows.iter().zip(pivots) {
            motions[count][pivot] = -row[free];
        }
        count += 1;
    }
    Some((motions, count))
}
