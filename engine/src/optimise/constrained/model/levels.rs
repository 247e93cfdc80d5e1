//! Smallest weights with which a step meets the levels, which are upper limits for the norms of some residuals.

use super::super::super::active_set::Outcome;
use super::ConvexModel;

/// Largest relative deviation from a level that counts as met. For a high level the deviation must be even smaller: at most a
/// tenth of the largest violation that still counts as satisfied.
pub(super) const LEVEL_MET: f64 = 1e-7;
/// Number of moves of the same end of a bracket, one after another. From then on, each move halves the function value (`excess`)
/// at the other end (Illinois method).
const PATIENCE: usize = 4;
/// Largest number of weights tried in one search for the multiplier of a level.
const SECANTS: usize = 30;

impl<'a> ConvexModel<'a> {
    /// Logarithm of the ratio between the norm of the k-th level's residuals after the step and the level (limit) itself.
    fn excess(&mut self, k: usize) -> f64 {
        // A norm can approach zero but not reach it. So a level of zero is replaced by a small number.
        let goal = self.levels[k].max(1e-12);
        let norm = self.held[k].norm_after(&self.step, &mut self.scratch);
        (norm / goal).ln()
    }

    /// Finds the smallest weights that meet the levels from the k-th on. A level that is met without a weight gets weight
    /// zero. A norm falls as its weight grows. So the search uses a secant method for the logarithms of norm and weight,
    /// within a bracket of two weights. If the same end of the bracket moves again and again, the excess at the other end
    /// counts half each time (the Illinois method). Otherwise the search would be slow where the norm stops falling: at a
    /// corner of the bounds. Each trial weight needs a new search for the weights of the later levels.
    pub(super) fn meet_levels(&mut self, k: usize, curved: bool) {
        if k == self.levels.len() {
            return;
        }
        self.meet_levels(k + 1, curved);
        if self.excess(k) <= self.met[k] {
            return;
        }
        let scale = self.goal.largest_pivot() / self.held[k].largest_pivot();
        let scale = if scale.is_finite() && scale > 0.0 {
            scale * scale
        } else {
            1.0
        };
        let mut low: Option<(f64, f64)> = None;
        let mut high: Option<(f64, f64)> = None;
        let (mut was_low, mut repeats) = (None, 0);
        let mut weight = self.last_weights[k].unwrap_or(scale);
        for _ in 0..SECANTS {
            // Nested levels multiply the number of quadratic programs. So all levels of a step together have a limited
            // number of programs.
            if self.programs == 0 {
                break;
            }
            self.programs -= 1;
            self.weights[k] = weight;
            self.weights[k + 1..].fill(0.0);
            if self.program(curved) != Outcome::Solved {
                break;
            }
            self.meet_levels(k + 1, curved);
            let at = (weight.ln(), self.excess(k));
            if at.1.abs() <= self.met[k] {
                break;
            }
            let is_low = at.1 > 0.0;
            let (moved, other) = if is_low {
                (&mut low, &mut high)
            } else {
                (&mut high, &mut low)
            };
            *moved = Some(at);
            repeats = if was_low == Some(is_low) {
                repeats + 1
            } else {
                0
            };
            was_low = Some(is_low);
            if repeats >= PATIENCE
                && let Some(other) = other
            {
                other.1 *= 0.5;
            }
            weight = match (low, high) {
                // Beyond this weight the model cannot meet the level. The step comes as near to the level as the model
                // allows.
                (Some(low), None) if low.0 > (1e14 * scale).ln() => break,
                (Some(low), None) => low.0.exp() * 30.0,
                (None, Some(high)) if high.0 < (1e-14 * scale).ln() => break,
                (None, Some(high)) => high.0.exp() / 30.0,
                (Some(low), Some(high)) => {
                    let share = low.1 / (low.1 - high.1);
                    (low.0 + share.clamp(0.05, 0.95) * (high.0 - low.0)).exp()
                }
                (None, None) => unreachable!("one of both bounds is set"),
            };
            if let (Some(low), Some(high)) = (low, high)
                && high.0 - low.0 < 1e-12
            {
                break;
            }
        }
    }
}
