//! Equilibrium by Newton's method, with the loads raised in shares.
//!
//! From one equilibrium to another, loads, wheel travel and rack move together along a straight line. The first try is
//! the whole way. A share is halved where
//!
//! - the first correction is above 60 mm or 0.3 rad: the linear prediction is not to be trusted,
//! - a correction is above 0.8 of the one before: the method does not contract,
//! - the state that is found is not stable.
//!
//! Corrections s converge as s_(k+1) <= C s_k^2, since the tangents are exact. C is taken as the largest of all
//! s_(k+1) / s_k^2 so far (P. Deuflhard, *Newton Methods for Nonlinear Problems*, Springer 2004, section 2.1, estimates
//! contraction in this way). If the correction that is foreseen so is far below the last one of an equilibrium, it is left
//! out. In 1,300 equilibria the corrections left out were below 0.13 of that bound.
//!
//! A state is stable if the symmetric part of the tangent is positive definite on the free motions. Rigid joints and
//! the held height leave these motions. This is checked first in every eliminated part, then in the rest of the
//! carrier. The share that is reached is known to 1e-6.

use super::limb::is_positive;
use super::system::{Equations, Held, Hold, Singular, State, System, Task};
use crate::linear::square::MOST;
use crate::number::Scalar;
use crate::threads::checkpoint;

/// Largest first correction, mm.
const LONGEST_SHIFT: f64 = 60.0;
/// Largest first correction, rad.
const LARGEST_TURN: f64 = 0.3;
/// A correction must be smaller than this share of the one before.
const CONTRACTION: f64 = 0.8;
/// Last correction of an equilibrium: mm.
const LAST_SHIFT: f64 = 1e-11;
/// Last correction of an equilibrium: rad.
const LAST_TURN: f64 = 1e-13;
/// A correction below this, mm, that no longer contracts is rounding: Newton's method would square it. Near the end
/// of a wheel's capacity, rounded forces move it further than the last correction.
const ROUNDING: f64 = 1e-8;
/// A correction that is foreseen must be this many times smaller than the last one of an equilibrium.
const FORESEEN: f64 = 100.0;
/// Least share of the way by which the loads are raised.
const LEAST_SHARE: f64 = 1e-6;
/// A turn is compared with a shift at this distance, mm.
const TURN_LEVER: f64 = 300.0;
/// Most Newton steps at one share. They contract by 0.8 at least, from 60 mm to 1e-11 mm.
const MOST_STEPS: usize = 140;

/// Reason why a share of the way has no equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Obstacle {
    /// Nothing holds a motion.
    Singular(Singular),
    /// Newton's method does not settle.
    Diverges,
    /// The state is not stable: the first part that moves away, or the carrier.
    Unstable(Option<usize>),
}

/// An equilibrium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution<T> {
    pub(super) state: State<T>,
    pub(super) task: Task<T>,
    /// Newton steps that led to it.
    pub(super) steps: usize,
}

/// An equilibrium that could not be reached.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stuck {
    /// Share of the way that was reached.
    pub(super) share: f64,
    pub(super) obstacle: Obstacle,
    /// The last equilibrium on the way, with its task; `None` if even the start is not one.
    pub(super) last: Option<(State<f64>, Task<f64>)>,
}

/// Bounds of Newton's method in the study's length unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Study units in a millimetre.
    pub(super) millimetre: f64,
}

impl Bounds {
    fn size(&self, [shift, turn]: [f64; 2]) -> f64 {
        (shift / self.millimetre).max(turn * TURN_LEVER)
    }

    fn is_last(&self, [shift, turn]: [f64; 2]) -> bool {
        shift <= LAST_SHIFT * self.millimetre && turn <= LAST_TURN
    }

    fn is_too_far(&self, [shift, turn]: [f64; 2]) -> bool {
        let near = shift <= LONGEST_SHIFT * self.millimetre && turn <= LARGEST_TURN;
        !near
    }
}

impl System<f64> {
    /// Newton's method from a state.
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
        loop {
            checkpoint();
            let equations = self
                .equations(&state, task, held)
                .map_err(Obstacle::Singular)?;
            let factors = equations
                .factors()
                .ok_or(Obstacle::Singular(Singular::Carrier))?;
            let solution = factors.solve(&equations.residual.map(|c| -c));
            let step = equations.step(&solution, false);
            let verdict = judge.judge(self.size_of(&step))?;
            state = self.stepped(&state, &step);
            if verdict == Verdict::Settled {
                self.check_stable(&equations, bounds)?;
                return Ok(Solution {
                    state,
                    task: *task,
                    steps: judge.steps(),
                });
            }
        }
    }

    /// Refuses a state that is not stable.
    pub(super) fn check_stable(
        &self,
        equations: &Equations<f64>,
        bounds: Bounds,
    ) -> Result<(), Obstacle> {
        if equations.unstable.is_some() {
            return Err(Obstacle::Unstable(equations.unstable));
        }
        match is_definite(equations, bounds, 0.0) {
            true => Ok(()),
            false => Err(Obstacle::Unstable(None)),
        }
    }

    /// From one equilibrium, or a pose that `held` holds, to another.
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

/// The end of a way that could not be raised to the whole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unraised<S> {
    pub(super) share: f64,
    pub(super) obstacle: Obstacle,
    /// The state at this share; `None` if even the start has none.
    pub(super) last: Option<S>,
}

/// Raises the loads: the whole way at once, or in shares. `newton` finds the state at a share from another state; its last
/// argument is true for the first try. Returns the state and the number of its steps.
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

/// Judges the corrections of Newton's method.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judge {
    bounds: Bounds,
    before: f64,
    /// Largest quotient of a correction and the square of the one before.
    quotient: f64,
    steps: usize,
}

/// Verdict about a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The state after it is settled.
    Settled,
    /// Another one is needed.
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

    /// Judges the next correction by its largest shift and turn.
    #[inline]
    pub(super) fn judge(&mut self, sizes: [f64; 2]) -> Result<Verdict, Obstacle> {
        self.steps += 1;
        if self.steps == 1 && self.bounds.is_too_far(sizes) || self.steps > MOST_STEPS {
            return Err(Obstacle::Diverges);
        }
        let size = self.bounds.size(sizes);
        // NaN is not smaller.
        let contracts = size < CONTRACTION * self.before;
        let is_rounding = size < ROUNDING && !contracts;
        // The first correction has none before it.
        let quotient = size / (self.before * self.before);
        self.quotient = self.quotient.max(quotient);
        let next = sizes.map(|part| FORESEEN * part * self.quotient * size);
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

    /// Number of corrections.
    pub(super) fn steps(&self) -> usize {
        self.steps
    }
}

/// A share of the way from one task to another of the same kind.
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

/// Returns true if the symmetric part of the carrier's tangent is positive definite on the motions that keep all rows
/// at zero, with pivots above this share of the largest.
pub(super) fn is_definite<T: Scalar>(
    equations: &Equations<T>,
    bounds: Bounds,
    least_share: f64,
) -> bool {
    let lever = TURN_LEVER * bounds.millimetre;
    let scale = |i: usize| if i < 3 { 1.0 } else { 1.0 / lever };
    let tangent = equations.tangent();
    let mut rows = [[0.0; 6]; MOST - 6];
    let mut count = 0;
    for row in equations.rows() {
        for (j, entry) in row.into_iter().enumerate() {
            rows[count][j] = entry * scale(j);
        }
        count += 1;
    }
    let Some((motions, free)) = null_space(&mut rows[..count]) else {
        return false;
    };
    let mut projected = [[0.0; 6]; 6];
    for a in 0..free {
        for b in 0..free {
            let mut sum = 0.0;
            for i in 0..6 {
                for j in 0..6 {
                    sum += motions[a][i] * tangent[i][j] * scale(i) * scale(j) * motions[b][j];
                }
            }
            projected[a][b] = sum;
        }
    }
    // On fewer than six motions, copies of the largest diagonal entry fill the matrix.
    let largest = (0..free).map(|a| projected[a][a]).fold(0.0, f64::max);
    for (a, row) in projected.iter_mut().enumerate().skip(free) {
        row[a] = if free == 0 { 1.0 } else { largest };
    }
    is_positive(&projected, least_share)
}

/// A basis of the motions along which all rows vanish, and their number. `None` if the rows depend on each other.
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
