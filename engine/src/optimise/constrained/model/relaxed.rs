//! Constraints that contradict one another. They are relaxed so that the largest violation is as small as possible.

use super::super::super::active_set::{Held, Outcome, Rows};
use super::super::super::qr::dot;
use super::super::KEPT;
use super::ConvexModel;

impl ConvexModel<'_> {
    /// Largest violation at the current point, among the rows that a step can violate.
    pub(super) fn worst(&self) -> f64 {
        let rows = self.kept_offsets.iter().enumerate();
        rows.fold(0.0_f64, |worst, (k, c)| {
            worst.max(if k < self.kept_equalities {
                c.abs()
            } else {
                *c
            })
        })
    }

    /// Makes the largest violation as small as possible within the bounds. Returns this violation, and the rows and bounds
    /// that prevent a smaller violation. Relaxes the rows to their values at the point found. Only rows that a step can
    /// violate count.
    pub(super) fn relax(&mut self) -> (f64, Vec<Held>) {
        let n = self.half.len();
        let worst = self.worst();
        if worst <= KEPT {
            // Rounding prevented a solution. The step is then zero.
            self.relaxed.fill(0.0);
            return (self.relax_rows(), Vec::new());
        }
        // A quadratic program for d and t: each violation may be at most t times the largest violation at the current point.
        // The program minimises |t|^2 + (small |d|)^2.
        let small = 1e-5;
        let mut triangle = vec![0.0; (n + 1) * (n + 1)];
        for k in 0..n {
            triangle[k * (n + 1) + k] = small;
        }
        triangle[(n + 1) * (n + 1) - 1] = 1.0;
        let twice = self.kept.len() + self.kept_equalities;
        let mut normals = Vec::with_capacity(twice * (n + 1));
        let mut offsets = Vec::with_capacity(twice);
        let mut of = Vec::with_capacity(offsets.capacity());
        let mut push = |sign: f64, k: usize, normal: &[f64], offset: f64| {
            normals.extend(normal.iter().map(|a| sign * a));
            normals.push(-worst);
            offsets.push(sign * offset);
            of.push(k);
        };
        for (k, offset) in self.kept_offsets.iter().enumerate() {
            let normal = &self.kept_normals[k * n..][..n];
            push(1.0, k, normal, *offset);
            if k < self.kept_equalities {
                push(-1.0, k, normal, *offset);
            }
        }
        let rows = Rows {
            normals: &normals,
            offsets: &offsets,
            equalities: 0,
            slack: 0.0,
        };
        let lower: Vec<f64> = self.lower.iter().copied().chain([0.0]).collect();
        let upper: Vec<f64> = self.upper.iter().copied().chain([2.0]).collect();
        let offset = vec![0.0; n + 1];
        let outcome = self.elastic.solve(&triangle, &offset, rows, &lower, &upper);
        if outcome != Outcome::Solved {
            self.relaxed.fill(0.0);
            return (self.relax_rows(), Vec::new());
        }
        let mut culprits: Vec<Held> = Vec::new();
        for (held, multiplier) in self.elastic.multipliers() {
            if multiplier < 1e-9 {
                continue;
            }
            match held {
                Held::Row(row) => culprits.push(Held::Row(self.kept[of[row]])),
                // This end of the step is a bound of the variable itself, not the limit by the trust radius.
                Held::Lower(j) if j < n && self.lower[j] == self.distance_below[j] => {
                    culprits.push(held);
                }
                Held::Upper(j) if j < n && self.upper[j] == self.distance_above[j] => {
                    culprits.push(held);
                }
                _ => {}
            }
        }
        culprits.sort_unstable();
        culprits.dedup();
        self.relaxed.copy_from_slice(&self.elastic.step()[..n]);
        (self.relax_rows(), culprits)
    }

    /// Relaxes the rows that a step can violate to their values at the relaxed point. Returns the largest violation at this
    /// point.
    fn relax_rows(&mut self) -> f64 {
        let n = self.half.len();
        let d = &self.relaxed;
        let mut remaining: f64 = 0.0;
        for (k, offset) in self.kept_offsets.iter_mut().enumerate() {
            let value = dot(&self.kept_normals[k * n..][..n], d) + *offset;
            let excess = if k < self.kept_equalities {
                value
            } else {
                value.max(0.0)
            };
            remaining = remaining.max(excess.abs());
            *offset -= excess + 1e-12 * excess.abs();
        }
        remaining
    }
}
