//! Multipliers of the binding constraints and bounds at the end of a run.

use super::super::super::Linearisation;
use super::super::super::stationarity::{CONVERGED, Pushes, Scale, Sizes};
use super::super::KEPT;
use super::super::solver::RESOLUTION;
use super::{ConvexModel, Settled};

/// Relative difference between a norm of residuals and its limit (level) up to which the limit counts as active.
const BINDING_LEVEL: f64 = 1e-6;
/// Distance from a bound, in half ranges, up to which a variable counts as at the bound.
const ON_BOUND: f64 = 1e-12;

/// A constraint, level or bound that binds at the end of a run.
#[derive(Clone, Copy, Debug)]
enum Push {
    Row(usize),
    Level(usize),
    /// A variable at a bound: the index of the variable, and -1 for the lower bound or 1 for the upper bound.
    Bound(usize, f64),
}

impl ConvexModel<'_> {
    /// Multipliers of the constraint rows, and of the levels (limits on norms of residuals).
    pub(in super::super) fn multipliers(&self) -> [&[f64]; 2] {
        [&self.row_multipliers, &self.level_multipliers]
    }

    /// Returns the imbalance between the slope of the goal and the gradients of the constraints times their multipliers. It
    /// is relative to the sizes of the terms, and 0 at a minimum.
    pub(in super::super) fn imbalance(&self) -> f64 {
        let n = self.half.len();
        let (mut left, mut size) = (0.0_f64, 0.0_f64);
        for j in 0..n {
            let goal = self.goal.gradient(j);
            let mut sum = goal + self.bound_multipliers[j];
            let mut most = goal.abs().max(self.bound_multipliers[j].abs());
            for (weight, held) in self.level_multipliers.iter().zip(&self.held) {
                let push = weight * held.gradient(j);
                sum += push;
                most = most.max(push.abs());
            }
            for (row, multiplier) in self.row_multipliers.iter().enumerate() {
                let push = multiplier * self.normals[row * n + j];
                sum += push;
                most = most.max(push.abs());
            }
            left = left.max(sum.abs());
            size = size.max(most);
        }
        self.scale().residual(left, size)
    }

    /// Returns the sizes to which slopes of the goal are compared.
    fn scale(&self) -> Scale {
        Scale::new(Sizes {
            residuals: self.residuals,
            norm: self.norm,
            pivot: self.goal.largest_pivot(),
            longest: self.goal.longest_column(),
            seen_rounding: 0.0,
            variables: self.half.len(),
            resolution: RESOLUTION,
        })
    }

    /// Improves the multipliers at the end of a run. If the multipliers of the last quadratic program do not satisfy the
    /// optimality conditions, the function computes the multipliers that satisfy them best. The function uses the gradients at
    /// this point and the gradients in `beside`.
    pub(in super::super) fn settle_multipliers(&mut self, beside: &[Linearisation]) -> Settled {
        let n = self.half.len();
        let slope: Vec<f64> = (0..n).map(|j| self.goal.gradient(j)).collect();
        let (mut pushes, mut of) = self.pushes();
        let scale = self.scale();
        let mut found = pushes.balance(&slope, scale);
        if found.residual >= CONVERGED && !beside.is_empty() {
            for k in 0..of.len() {
                let Push::Row(row) = of[k] else { continue };
                for side in beside {
                    let entries = side.jacobian.row(row);
                    let normal = entries.iter().zip(&self.half).map(|(a, half)| a * half);
                    pushes.add(&normal.collect::<Vec<_>>(), row < self.equalities);
                    of.push(Push::Row(row));
                }
            }
            found = pushes.balance(&slope, scale);
        }
        let before = self.imbalance();
        let mut rows = vec![0.0; self.offsets.len()];
        for (push, multiplier) in of.iter().zip(&found.multipliers) {
            if let Push::Row(row) = push {
                rows[*row] += multiplier;
            }
        }
        if before >= CONVERGED && found.residual < before {
            self.clear_multipliers();
            self.row_multipliers.copy_from_slice(&rows);
            for (push, multiplier) in of.iter().zip(&found.multipliers) {
                match push {
                    Push::Row(_) => {}
                    Push::Level(k) => self.level_multipliers[*k] = *multiplier,
                    Push::Bound(j, sign) => self.bound_multipliers[*j] += sign * multiplier,
                }
            }
        }
        Settled {
            residual: before.min(found.residual),
            alternatives: (found.residual < CONVERGED).then_some(rows),
        }
    }

    /// Gradients of all binding constraints and bounds, and the kind of each constraint or bound.
    fn pushes(&self) -> (Pushes, Vec<Push>) {
        let n = self.half.len();
        let (mut pushes, mut of) = (Pushes::default(), Vec::new());
        for (row, value) in self.offsets.iter().enumerate() {
            let is_equality = row < self.equalities;
            if self.speaks[row] && (is_equality || *value >= -KEPT) {
                pushes.add(&self.normals[row * n..][..n], is_equality);
                of.push(Push::Row(row));
            }
        }
        let (still, mut scratch) = (vec![0.0; n], vec![0.0; n]);
        for (k, held) in self.held.iter().enumerate() {
            if held.norm_after(&still, &mut scratch) >= (1.0 - BINDING_LEVEL) * self.levels[k] {
                let gradient: Vec<f64> = (0..n).map(|j| held.gradient(j)).collect();
                pushes.add(&gradient, false);
                of.push(Push::Level(k));
            }
        }
        for j in 0..n {
            for (distance, sign) in [
                (self.distance_below[j], -1.0),
                (self.distance_above[j], 1.0),
            ] {
                if distance.abs() <= ON_BOUND {
                    let mut normal = vec![0.0; n];
                    normal[j] = sign;
                    pushes.add(&normal, false);
                    of.push(Push::Bound(j, sign));
                }
            }
        }
        (pushes, of)
    }
}
