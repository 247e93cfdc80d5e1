//! Convex model of a problem about a point, equation (1) of module `constrained`, and the step that it proposes.

mod levels;
mod multipliers;
mod relaxed;
mod squares;

use self::squares::Squares;
use super::super::active_set::{ActiveSet, Held, Outcome, Rows};
use super::super::qr::{dot, triangularise_within};
use super::super::{Bounds, Linearisation};
use super::curvature::Curvature;
use super::movable::Movable;
use super::solver::RESOLUTION;
use super::{Assessment, KEPT, Shape};
use levels::LEVEL_MET;
use nalgebra::DVector;

/// Damping relative to the largest pivot of the objective's triangular factor. It prevents moves in directions that change
/// neither goal nor rows.
const DAMPING: f64 = 1e-7;
/// Factor by which damping increases if the method did not solve a solvable quadratic program.
const MORE_DAMPING: f64 = 100.0;
/// Largest number of increases of the damping for one step.
const DAMPINGS: usize = 3;
/// Largest number of quadratic programs for one step in the search for the weights of all levels.
const PROGRAMS: usize = 300;
/// Largest violation with which a row that duplicates held rows still counts as satisfied. It is a hundredth of the largest
/// violation with which any row counts as satisfied.
const SLACK: f64 = 1e-9;

/// Kind of step that the model proposes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Proposal {
    /// The step is the minimum of the model.
    Optimal,
    /// The rows cannot all be satisfied by a step within the trust radius. Contains the smallest possible value of the
    /// largest violation, and the rows and bounds that contradict one another.
    Relaxed { remaining: f64, culprits: Vec<Held> },
}

/// Lagrange multipliers at the end of a run.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    /// Imbalance left in the optimality conditions: gradient of the goal plus gradients of the constraints times
    /// multipliers.
    pub residual: f64,
    /// Other multipliers of the rows with which the optimality conditions also hold. `None` if the conditions do not hold.
    pub alternatives: Option<Vec<f64>>,
}

/// The convex model of a problem about a point, with its workspace.
pub(super) struct ConvexModel<'a> {
    bounds: &'a Bounds,
    half: Vec<f64>,
    equalities: usize,
    levels: Vec<f64>,
    /// Tolerance of each level (limit of a norm of residuals). A level counts as met if log(norm / level) is at most its
    /// tolerance.
    met: Vec<f64>,
    goal: Squares,
    /// Number of residuals of the goal.
    residuals: usize,
    /// Norm of the residuals of the goal.
    norm: f64,
    /// Sum of squares of the residuals of each level (limit of a norm of residuals).
    held: Vec<Squares>,
    /// All rows of the problem, with gradients scaled by the half ranges of the variables.
    normals: Vec<f64>,
    offsets: Vec<f64>,
    /// True for each row that can restrict steps.
    speaks: Vec<bool>,
    /// Number of equalities among the rows that a step can violate.
    kept_equalities: usize,
    /// Number of quadratic programs that may still be solved for the present step.
    programs: usize,
    /// Damping of the quadratic programs, relative to the largest pivot of the objective's triangular factor.
    damping: f64,
    /// Indices of the constraint rows that a step can violate.
    kept: Vec<usize>,
    /// Normals of the rows in `kept`, one after another.
    kept_normals: Vec<f64>,
    /// Offsets of the rows in `kept`.
    kept_offsets: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    distance_below: Vec<f64>,
    distance_above: Vec<f64>,
    method: ActiveSet,
    elastic: ActiveSet,
    /// Step to the point at which the relaxed rows are satisfied.
    relaxed: Vec<f64>,
    step: Vec<f64>,
    /// Multipliers of the constraint rows, from the last quadratic program.
    row_multipliers: Vec<f64>,
    /// Multipliers of the bounds, negative at a lower bound.
    bound_multipliers: Vec<f64>,
    /// Multipliers of the levels (limits of a norm of residuals).
    level_multipliers: Vec<f64>,
    /// Weight of the squared residuals of each level (limit of a norm) in the next quadratic program.
    weights: Vec<f64>,
    /// Multipliers of the levels from the last search. The next search starts from these values.
    last_weights: Vec<Option<f64>>,
    curvature: Curvature,
    /// Normals and offsets of the rows that were active (at their limits) in the previous step. Curvature is added in the
    /// direction of their normals.
    across: Vec<(Vec<f64>, f64)>,
    matrix: Vec<f64>,
    vector: Vec<f64>,
    scratch: Vec<f64>,
}

impl<'a> ConvexModel<'a> {
    /// Allocates memory for the model of a problem.
    pub(super) fn new(bounds: &'a Bounds, shape: &Shape) -> Self {
        let (n, rows) = (bounds.variables(), shape.rows);
        let levels: Vec<f64> = shape.levels.iter().map(|level| level.1).collect();
        ConvexModel {
            bounds,
            half: bounds.width().iter().map(|w| 0.5 * w).collect(),
            equalities: shape.equalities,
            met: shape
                .levels
                .iter()
                .map(|(count, level)| {
                    LEVEL_MET.min(0.1 * KEPT * (*count as f64).sqrt() / level.max(1e-12))
                })
                .collect(),
            goal: Squares::new(n),
            residuals: shape.goal,
            norm: 0.0,
            held: vec![Squares::new(n); levels.len()],
            normals: vec![0.0; rows * n],
            offsets: vec![0.0; rows],
            speaks: vec![true; rows],
            kept_equalities: 0,
            programs: 0,
            damping: DAMPING,
            kept: Vec::with_capacity(rows),
            kept_normals: Vec::with_capacity(rows * n),
            kept_offsets: Vec::with_capacity(rows),
            lower: vec![0.0; n],
            upper: vec![0.0; n],
            distance_below: vec![0.0; n],
            distance_above: vec![0.0; n],
            method: ActiveSet::new(n),
            elastic: ActiveSet::new(n + 1),
            relaxed: vec![0.0; n],
            step: vec![0.0; n],
            row_multipliers: vec![0.0; rows],
            bound_multipliers: vec![0.0; n],
            level_multipliers: vec![0.0; levels.len()],
            weights: vec![0.0; levels.len()],
            last_weights: vec![None; levels.len()],
            levels,
            curvature: Curvature::new(n),
            across: Vec::new(),
            matrix: Vec::new(),
            vector: Vec::new(),
            scratch: vec![0.0; n],
        }
    }

    /// Builds the model about `x`. Rows that no variable has changed in this run are left out.
    pub(super) fn build(&mut self, x: &DVector<f64>, at: &Assessment, movable: Option<&Movable>) {
        let n = x.len();
        self.norm = at.goal.residuals.norm();
        for (row, speaks) in self.speaks.iter_mut().enumerate() {
            let value = at.rows.residuals[row];
            let missed = if row < self.equalities {
                value.abs() > KEPT
            } else {
                value > KEPT
            };
            // A row in use can be constant near this point and change elsewhere. If such a row is satisfied, it does not
            // restrict the step from this point. If it is violated, it stays in the model.
            *speaks = movable.is_none_or(|movable| {
                movable.takes_part(row) && (missed || movable.moves_at(row, &at.rows, self.bounds))
            });
        }
        self.goal.reduce(&at.goal, &self.half, &mut self.matrix);
        for (held, level) in self.held.iter_mut().zip(&at.levels) {
            held.reduce(level, &self.half, &mut self.matrix);
        }
        for (j, half) in self.half.iter().enumerate() {
            let column = at.rows.jacobian.column(j);
            for (normal, entry) in self.normals.chunks_exact_mut(n).zip(column.iter()) {
                normal[j] = entry * half;
            }
            self.distance_below[j] = (self.bounds.lower()[j] - x[j]) / half;
            self.distance_above[j] = (self.bounds.upper()[j] - x[j]) / half;
        }
        self.offsets.copy_from_slice(at.rows.residuals.as_slice());
    }

    /// Finds the step within a trust radius (largest component in half ranges). With `curved`, the model includes the
    /// estimate of the curvature.
    pub(super) fn solve(&mut self, radius: f64, curved: bool) -> Proposal {
        for j in 0..self.half.len() {
            self.lower[j] = self.distance_below[j].max(-radius);
            self.upper[j] = self.distance_above[j].min(radius);
        }
        self.keep_rows();
        self.propose(curved)
    }

    /// Finds the step with a second-order correction. The correction adds to each row the difference between its value at
    /// the trial point and the value that the linear model predicts there.
    pub(super) fn solve_corrected(&mut self, trial: &Assessment, curved: bool) -> Proposal {
        let n = self.half.len();
        self.kept_offsets.clear();
        for &row in &self.kept {
            let normal = &self.normals[row * n..][..n];
            self.kept_offsets
                .push(trial.rows.residuals[row] - dot(normal, &self.step));
        }
        // The norm of a level's residuals is curved, like the rows. So the difference between the norm at the trial and the
        // norm that the model predicts there is subtracted from the level.
        let levels = self.levels.clone();
        for (k, level) in self.levels.iter_mut().enumerate() {
            let promised = self.held[k].norm_after(&self.step, &mut self.scratch);
            let excess = trial.levels[k].residuals.norm() - promised;
            *level = (*level - excess).clamp(0.5 * *level, 2.0 * *level);
        }
        let proposal = self.propose(curved);
        self.levels = levels;
        proposal
    }

    /// Selects the rows that a step within the bounds can violate.
    fn keep_rows(&mut self) {
        let n = self.half.len();
        self.kept.clear();
        self.kept_normals.clear();
        self.kept_offsets.clear();
        for (row, offset) in self.offsets.iter().enumerate() {
            if !self.speaks[row] {
                continue;
            }
            let normal = &self.normals[row * n..][..n];
            let reach = || {
                let bounds = self.lower.iter().zip(&self.upper);
                let most = normal.iter().zip(bounds);
                most.map(|(a, (l, u))| (a * l).max(a * u)).sum::<f64>()
            };
            if row < self.equalities || offset + reach() > 0.0 {
                self.kept.push(row);
                self.kept_normals.extend_from_slice(normal);
                self.kept_offsets.push(*offset);
            }
        }
        let equalities = self.kept.iter().filter(|row| **row < self.equalities);
        self.kept_equalities = equalities.count();
    }

    fn propose(&mut self, curved: bool) -> Proposal {
        let mut proposal = Proposal::Optimal;
        self.across = if curved { self.held_rows() } else { Vec::new() };
        self.weights.fill(0.0);
        self.programs = PROGRAMS;
        self.damping = DAMPING;
        let mut outcome = self.program(curved);
        // If the current point already satisfies the rows, only rounding errors can make the search for a step fail.
        let is_kept = self.worst() <= KEPT;
        for _ in 0..DAMPINGS {
            if outcome == Outcome::Solved || !is_kept {
                break;
            }
            self.damping *= MORE_DAMPING;
            outcome = self.program(curved);
        }
        if outcome != Outcome::Solved {
            let (remaining, culprits) = self.relax();
            let bounds = culprits.clone();
            proposal = Proposal::Relaxed {
                remaining,
                culprits,
            };
            if self.program(curved) != Outcome::Solved {
                // The point `relaxed` satisfies the relaxed rows, but it is not a minimum.
                self.step.copy_from_slice(&self.relaxed);
                self.clear_multipliers();
                return proposal;
            }
            self.step_onto(&bounds);
        }
        self.meet_levels(0, curved);
        let found = self.level_multipliers.iter();
        self.last_weights = found.map(|w| (*w > 0.0).then_some(*w)).collect();
        proposal
    }

    /// Moves the step exactly onto these bounds. The relaxed rows have a small slack, so the step of the quadratic program
    /// can end slightly inside these bounds. The bounds prevent a smaller violation.
    fn step_onto(&mut self, bounds: &[Held]) {
        for held in bounds {
            match *held {
                Held::Lower(j) => self.step[j] = self.lower[j],
                Held::Upper(j) => self.step[j] = self.upper[j],
                Held::Row(_) => {}
            }
        }
    }

    /// Returns normals and offsets of the rows and bounds that were active (at their limits) in the previous step. They do
    /// not depend on the weights of the levels in the next quadratic program.
    fn held_rows(&self) -> Vec<(Vec<f64>, f64)> {
        let n = self.half.len();
        let rows = self.kept.iter().enumerate();
        let rows =
            rows.filter(|(_, row)| **row < self.equalities || self.row_multipliers[**row] > 0.0);
        let mut held: Vec<_> = rows
            .map(|(k, _)| {
                (
                    self.kept_normals[k * n..][..n].to_vec(),
                    self.kept_offsets[k],
                )
            })
            .collect();
        // Includes only the bounds of the variables themselves, not the limit by the trust radius.
        for (j, multiplier) in self.bound_multipliers.iter().enumerate() {
            let on_bound = self.distance_below[j] == 0.0 || self.distance_above[j] == 0.0;
            if on_bound && *multiplier != 0.0 {
                let mut normal = vec![0.0; n];
                normal[j] = 1.0;
                held.push((normal, 0.0));
            }
        }
        held
    }

    /// Solves the quadratic program. Its objective includes the squared residuals of each level, times the weight of the level.
    fn program(&mut self, curved: bool) -> Outcome {
        let n = self.half.len();
        let weighed = || {
            self.weights
                .iter()
                .zip(&self.held)
                .filter(|(w, _)| **w > 0.0)
        };
        let stacked = 2 + weighed().count();
        let rows = stacked * n;
        let pivot = weighed().fold(self.goal.largest_pivot(), |most, (w, held)| {
            most.max(w.sqrt() * held.largest_pivot())
        });
        let damping = if pivot > 0.0 {
            self.damping * pivot
        } else {
            1.0
        };
        // The matrix stacks the triangle of the goal and the triangles of the levels. The first rows of all triangles come
        // first, then the second rows, and so on. So the nonzero entries of each column end after few rows.
        self.matrix.clear();
        self.matrix.resize(n * rows, 0.0);
        self.vector.clear();
        self.vector.resize(rows, 0.0);
        let stack = std::iter::once((1.0, &self.goal));
        let stack = stack.chain(weighed().map(|(weight, held)| (weight.sqrt(), held)));
        for (place, (root, squares)) in stack.enumerate() {
            for j in 0..n {
                let (from, to) = (&squares.triangle[j * n..], &mut self.matrix[j * rows..]);
                for i in 0..=j {
                    to[i * stacked + place] = root * from[i];
                }
                self.vector[j * stacked + place] = root * squares.offset[j];
            }
        }
        for j in 0..n {
            self.matrix[j * rows + (j + 1) * stacked - 1] = damping;
        }
        let end = |k: usize| (k + 1) * stacked;
        triangularise_within(&mut self.matrix, rows, end, &mut self.vector);
        for j in 0..n {
            self.matrix.copy_within(j * rows..j * rows + n, j * n);
            self.matrix[j * n + j + 1..(j + 1) * n].fill(0.0);
        }
        self.matrix.truncate(n * n);
        self.vector.truncate(n);
        if curved {
            let (matrix, vector) = (&mut self.matrix, &mut self.vector);
            self.curvature.add_to(&self.across, matrix, vector);
        }
        let rows = Rows {
            normals: &self.kept_normals,
            offsets: &self.kept_offsets,
            equalities: self.kept_equalities,
            slack: SLACK,
        };
        let (lower, upper) = (&self.lower, &self.upper);
        let outcome = self
            .method
            .solve(&self.matrix, &self.vector, rows, lower, upper);
        if outcome == Outcome::Solved {
            for (j, step) in self.step.iter_mut().enumerate() {
                *step = self.method.step()[j].clamp(lower[j], upper[j]);
            }
            self.clear_multipliers();
            self.level_multipliers.copy_from_slice(&self.weights);
            for (held, multiplier) in self.method.multipliers() {
                match held {
                    Held::Row(row) => self.row_multipliers[self.kept[row]] = multiplier,
                    Held::Lower(j) => self.bound_multipliers[j] -= multiplier,
                    Held::Upper(j) => self.bound_multipliers[j] += multiplier,
                }
            }
        }
        outcome
    }

    fn clear_multipliers(&mut self) {
        self.row_multipliers.fill(0.0);
        self.bound_multipliers.fill(0.0);
        self.level_multipliers.fill(0.0);
    }

    /// The largest component of the step, in half ranges.
    pub(super) fn largest_component(&self) -> f64 {
        self.step.iter().fold(0.0, |most, s| s.abs().max(most))
    }

    /// Reduction of the goal by the step, from the model with the estimate of the curvature, if the estimate is in use.
    pub(super) fn predicted_reduction(&mut self) -> f64 {
        let Self {
            goal,
            step,
            scratch,
            curvature,
            ..
        } = self;
        -0.5 * (goal.change(step, scratch) + curvature.quadratic(step))
    }

    /// Updates the estimate of the curvature after an accepted step from `before` to `after`, with the multipliers of the
    /// last quadratic program.
    pub(super) fn learn(&mut self, before: &Assessment, after: &Assessment) {
        let n = self.half.len();
        let mut y = vec![0.0; n];
        for (j, y) in y.iter_mut().enumerate() {
            let part = |a: &Linearisation, b: &Linearisation, weights: &[f64]| {
                let (b, a) = (b.jacobian.column(j), a.jacobian.column(j));
                let (b, a) = (b.as_slice(), a.as_slice());
                let mut sum = 0.0;
                for row in 0..weights.len().min(b.len()) {
                    sum += (b[row] - a[row]) * weights[row];
                }
                sum * self.half[j]
            };
            *y = part(&before.goal, &after.goal, after.goal.residuals.as_slice())
                + part(&before.rows, &after.rows, &self.row_multipliers);
            for (k, weight) in self.level_multipliers.iter().enumerate() {
                if *weight > 0.0 {
                    let (before, after) = (&before.levels[k], &after.levels[k]);
                    *y += weight * part(before, after, after.residuals.as_slice());
                }
            }
        }
        self.curvature.learn(&self.step, &y);
    }

    /// Writes the end of the step from `x` into `to`. If a step ends within [`RESOLUTION`] of a bound, the variable is set
    /// exactly to the bound.
    pub(super) fn step_from(&self, x: &DVector<f64>, to: &mut DVector<f64>) {
        for j in 0..x.len() {
            let (lower, upper) = (self.bounds.lower()[j], self.bounds.upper()[j]);
            to[j] = if self.step[j] <= self.distance_below[j] + RESOLUTION {
                lower
            } else if self.step[j] >= self.distance_above[j] - RESOLUTION {
                upper
            } else {
                (x[j] + self.half[j] * self.step[j]).clamp(lower, upper)
            };
        }
    }
}
