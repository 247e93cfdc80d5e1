//! Sub-problem of each tuning step: linear least squares with damping, between bounds.
//!
//! Minimise |J W s + r|^2 + damping |s|^2 subject to lower <= s <= upper, where W scales the columns of J. With damping > 0
//! the minimum is unique, whatever the rank of J. With g = W J^T (J W s + r) + damping s, the Kuhn-Tucker conditions
//! characterise this minimum:
//!
//! ```text
//! g_j = 0 where lower_j < s_j < upper_j,   g_j >= 0 where s_j = lower_j,   g_j <= 0 where s_j = upper_j
//! ```
//!
//! An active-set method finds this minimum exactly. Each variable is either free or held at a bound. An orthogonal
//! factorisation solves for the free variables. If this step crosses bounds, the method stops at the first of them and holds
//! this variable. If the step crosses no bound, the method frees the held variable whose release lowers the objective most.
//! (Ch. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23; P. B. Stark, R. L. Parker,
//! Bounded-variable least-squares: an algorithm and applications, Computational Statistics 10, 1995.) The method does not
//! form the normal equations. The normal equations would square the singular values of J W, which already spread over eight
//! decades.

use super::qr::{back_substitute, dot, scale_columns, triangularise, triangularise_within};
use nalgebra::{DMatrix, DVector};

/// Position of a variable relative to its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActiveBound {
    /// Between its bounds.
    Free,
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
}

/// The sub-problem, its solution and its workspace.
///
/// [`reduce`](Self::reduce) reduces J to a triangle once. Each [`solve`](Self::solve) then works on n x n numbers, for any
/// damping and bounds.
#[derive(Clone, Debug)]
pub struct BoundedLeastSquares {
    variables: usize,
    /// Factor R of J W = Q R: n columns of n entries, zero below the diagonal.
    triangle: Vec<f64>,
    /// First n entries of Q^T r.
    offset: Vec<f64>,
    /// Norms of the columns of R. They equal the norms of the columns of J W.
    norms: Vec<f64>,
    step: Vec<f64>,
    active_bounds: Vec<ActiveBound>,
    /// Remainder R s + offset for the present solution s.
    remainder: Vec<f64>,
    /// Indices of the free variables, in rising order.
    free: Vec<usize>,
    /// Flags of the variables: true if the method freed a held variable and the variable returned to its bound at once.
    turned_back: Vec<bool>,
    matrix: Vec<f64>,
    vector: Vec<f64>,
}

impl BoundedLeastSquares {
    /// Allocates the workspace for n `variables` and m `residuals`.
    pub fn new(variables: usize, residuals: usize) -> Self {
        let rows = residuals.max(2 * variables);
        BoundedLeastSquares {
            variables,
            triangle: vec![0.0; variables * variables],
            offset: vec![0.0; variables],
            norms: vec![0.0; variables],
            step: vec![0.0; variables],
            active_bounds: vec![ActiveBound::Free; variables],
            remainder: vec![0.0; variables],
            free: Vec::with_capacity(variables),
            turned_back: vec![false; variables],
            matrix: Vec::with_capacity(rows * variables),
            vector: Vec::with_capacity(rows),
        }
    }

    /// Reduces the m x n `jacobian` and the m `residuals` to a triangle. Each column of the Jacobian is first multiplied by
    /// its entry of `width`.
    pub fn reduce(
        &mut self,
        jacobian: &DMatrix<f64>,
        width: &DVector<f64>,
        residuals: &DVector<f64>,
    ) {
        let n = self.variables;
        // If there are fewer residuals than variables, additional rows of zeros fill the matrix.
        let rows = residuals.len().max(n);
        scale_columns(jacobian, width.as_slice(), rows, &mut self.matrix);
        self.vector.clear();
        self.vector.extend_from_slice(residuals.as_slice());
        self.vector.resize(rows, 0.0);
        triangularise(&mut self.matrix, rows, &mut self.vector);

        self.offset.copy_from_slice(&self.vector[..n]);
        for (j, column) in self.triangle.chunks_exact_mut(n).enumerate() {
            column[..=j].copy_from_slice(&self.matrix[j * rows..][..=j]);
            self.norms[j] = dot(&column[..=j], &column[..=j]).sqrt();
        }
    }

    /// Solves for the step between `lower` <= 0 and `upper` >= 0.
    pub fn solve(&mut self, damping: f64, lower: &[f64], upper: &[f64]) {
        self.step.fill(0.0);
        self.remainder.copy_from_slice(&self.offset);
        for j in 0..self.variables {
            let slope = self.slope(j, damping);
            self.active_bounds[j] = match slope {
                slope if slope > 0.0 && lower[j] == 0.0 => ActiveBound::Lower,
                slope if slope < 0.0 && upper[j] == 0.0 => ActiveBound::Upper,
                _ => ActiveBound::Free,
            };
        }
        self.descend(damping, lower, upper);

        // Each round lowers the objective. So no set of held variables occurs twice, and the rounds end. The limit on the
        // number of rounds only guards against rounding. If the limit stops the method, the step is still feasible and lowers
        // the objective.
        self.turned_back.fill(false);
        for _ in 0..10 * self.variables {
            let Some(j) = self.worst_multiplier(damping) else {
                return;
            };
            let held = std::mem::replace(&mut self.active_bounds[j], ActiveBound::Free);
            self.solve_free(damping);
            let place = self.free.iter().position(|&free| free == j);
            let goal = place.map_or(self.step[j], |place| self.vector[place]);
            let leaves = match held {
                ActiveBound::Lower => goal > lower[j],
                _ => goal < upper[j],
            };
            if leaves {
                self.descend(damping, lower, upper);
                self.turned_back.fill(false);
            } else {
                // The multiplier of this variable was zero except for a rounding error (Stark and Parker, step 6).
                self.active_bounds[j] = held;
                self.turned_back[j] = true;
            }
        }
    }

    /// Solution s of the sub-problem.
    pub fn step(&self) -> &[f64] {
        &self.step
    }

    /// Position of each variable of the solution relative to its bounds.
    pub fn active_bounds(&self) -> &[ActiveBound] {
        &self.active_bounds
    }

    /// Norms of the columns of J W.
    pub fn column_norms(&self) -> &[f64] {
        &self.norms
    }

    /// Largest diagonal entry of the triangle R of J W, as an absolute value.
    pub fn largest_pivot(&self) -> f64 {
        let n = self.variables;
        (0..n).fold(0.0, |most, k| self.triangle[k * n + k].abs().max(most))
    }

    /// Half the derivative of |J W s + r|^2 with respect to s_j at s = 0.
    pub fn gradient(&self, j: usize) -> f64 {
        dot(self.column(j), &self.offset)
    }

    /// |r|^2 - |J W s + r|^2 for the solution s, computed without the cancellation of this difference.
    pub fn predicted_reduction(&self) -> f64 {
        // With d = J W s: |r|^2 - |r + d|^2 = -d . (2 r + d). Q preserves inner products.
        let twice = self.remainder.iter().zip(&self.offset);
        -twice
            .map(|(after, before)| (after - before) * (after + before))
            .sum::<f64>()
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.triangle[j * self.variables..][..self.variables]
    }

    /// Slope g_j of the Kuhn-Tucker conditions.
    fn slope(&self, j: usize, damping: f64) -> f64 {
        dot(self.column(j), &self.remainder) + damping * self.step[j]
    }

    /// Index of the variable whose move away from its bound, alone, would reduce the damped sum of squares most. Variables that
    /// have turned back do not count. `None` if no move reduces the sum by more than rounding errors.
    fn worst_multiplier(&self, damping: f64) -> Option<usize> {
        // A slope is an inner product of n terms with the remainder. The remainder is a sum of the offset and n columns. The
        // sizes of the offset and of the columns bound the rounding error of the slope.
        let size = self.offset.iter().map(|c| c * c).sum::<f64>().sqrt()
            + dot(&self.norms, &self.step).abs()
            + self
                .norms
                .iter()
                .zip(&self.step)
                .map(|(n, s)| (n * s).abs())
                .sum::<f64>();
        let rounding = 2.0 * self.variables as f64 * f64::EPSILON * size;
        let mut best = (rounding, None);
        for j in 0..self.variables {
            let outward = match self.active_bounds[j] {
                ActiveBound::Lower => -self.slope(j, damping),
                ActiveBound::Upper => self.slope(j, damping),
                ActiveBound::Free => continue,
            };
            let gain = outward / self.norms[j].hypot(damping.sqrt());
            if !self.turned_back[j] && gain > best.0 {
                best = (gain, Some(j));
            }
        }
        best.1
    }

    /// Moves to the minimum over the free variables. Holds every variable whose bound the move reaches.
    fn descend(&mut self, damping: f64, lower: &[f64], upper: &[f64]) {
        // Every round except the last holds one more variable.
        for _ in 0..=self.variables {
            self.solve_free(damping);
            let mut fraction = 1.0;
            let mut nearest = None;
            for (place, &j) in self.free.iter().enumerate() {
                let (from, goal) = (self.step[j], self.vector[place]);
                let (bound, hold) = match goal {
                    goal if goal < lower[j] => (lower[j], ActiveBound::Lower),
                    goal if goal > upper[j] => (upper[j], ActiveBound::Upper),
                    _ => continue,
                };
                let reach = (bound - from) / (goal - from);
                if nearest.is_none() || reach < fraction {
                    fraction = reach;
                    nearest = Some((j, bound, hold));
                }
            }
            for (place, &j) in self.free.iter().enumerate() {
                let (from, goal) = (self.step[j], self.vector[place]);
                self.step[j] = match nearest {
                    None => goal,
                    Some(_) => (from + fraction * (goal - from)).clamp(lower[j], upper[j]),
                };
            }
            let Some((j, bound, hold)) = nearest else {
                break;
            };
            self.step[j] = bound;
            self.active_bounds[j] = hold;
        }
        self.remainder.copy_from_slice(&self.offset);
        for j in 0..self.variables {
            add_scaled(
                &self.triangle[j * self.variables..],
                self.step[j],
                &mut self.remainder,
            );
        }
    }

    /// Writes the minimum over the free variables into the head of `vector`, in the order of `free`. The held variables keep
    /// their values.
    ///
    /// The damping row of a variable follows the row of R that belongs to this variable. So the nonzero entries of each
    /// column end after few rows.
    fn solve_free(&mut self, damping: f64) {
        let n = self.variables;
        self.free.clear();
        for (j, hold) in self.active_bounds.iter().enumerate() {
            if *hold == ActiveBound::Free {
                self.free.push(j);
            }
        }
        let free = &self.free;
        let rows = n + free.len();
        self.matrix.clear();
        self.matrix.resize(free.len() * rows, 0.0);
        for (place, &j) in free.iter().enumerate() {
            let (from, to) = (&self.triangle[j * n..], &mut self.matrix[place * rows..]);
            let mut row = 0;
            for (i, entry) in from[..=j].iter().enumerate() {
                to[row] = *entry;
                row += 1 + usize::from(self.active_bounds[i] == ActiveBound::Free);
            }
            to[row - 1] = damping.sqrt();
        }
        self.vector.clear();
        self.vector.resize(rows, 0.0);
        let mut row = 0;
        for i in 0..n {
            let mut sum = -self.offset[i];
            for j in i..n {
                if self.active_bounds[j] != ActiveBound::Free {
                    sum -= self.triangle[j * n + i] * self.step[j];
                }
            }
            self.vector[row] = sum;
            row += 1 + usize::from(self.active_bounds[i] == ActiveBound::Free);
        }
        let end = |place: usize| free[place] + place + 2;
        triangularise_within(&mut self.matrix, rows, end, &mut self.vector);
        back_substitute(&self.matrix, rows, &mut self.vector);
    }
}

/// Adds `factor` times `x` to the first entries of `to`, one for each entry of `x`. If `x` is longer, only its first
/// entries count.
fn add_scaled(x: &[f64], factor: f64, to: &mut [f64]) {
    for (to, x) in to.iter_mut().zip(x) {
        *to += factor * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::Noise;

    struct Case {
        jacobian: DMatrix<f64>,
        residuals: DVector<f64>,
        damping: f64,
        lower: Vec<f64>,
        upper: Vec<f64>,
    }

    impl Case {
        /// A random problem with n variables and m residuals. Every third problem has a rank of at most 1 + n/2. In every
        /// second problem, some bounds may be active from the beginning.
        fn random(seed: u64, n: usize, m: usize) -> Self {
            let mut noise = Noise::new(seed);
            let mut jacobian = DMatrix::from_fn(m, n, |_, _| noise.next());
            if seed.is_multiple_of(3) {
                let rank = 1 + n / 2;
                let right = DMatrix::from_fn(rank, n, |_, _| noise.next());
                jacobian = jacobian.columns(0, rank) * right;
            }
            let scale = 10f64.powf(2.0 * noise.next());
            let mut bound = |blocked: bool| {
                let size = scale * (1.0 + noise.next());
                if blocked && noise.next() < 0.0 {
                    0.0
                } else {
                    size
                }
            };
            let lower = (0..n).map(|_| -bound(seed.is_multiple_of(2))).collect();
            let upper = (0..n).map(|_| bound(seed.is_multiple_of(2))).collect();
            Case {
                jacobian,
                residuals: DVector::from_fn(m, |_, _| noise.next()),
                damping: 10f64.powf(-5.0 + 5.0 * noise.next()),
                lower,
                upper,
            }
        }

        fn solve(&self) -> BoundedLeastSquares {
            let (m, n) = self.jacobian.shape();
            let mut solver = BoundedLeastSquares::new(n, m);
            solver.reduce(&self.jacobian, &DVector::repeat(n, 1.0), &self.residuals);
            solver.solve(self.damping, &self.lower, &self.upper);
            solver
        }

        fn objective(&self, s: &DVector<f64>) -> f64 {
            (&self.jacobian * s + &self.residuals).norm_squared() + self.damping * s.norm_squared()
        }

        /// Smallest objective, by a trial of all sets of held variables. Only minima whose free variables are within their
        /// bounds count.
        fn by_enumeration(&self) -> f64 {
            let n = self.lower.len();
            let mut least = f64::INFINITY;
            for code in 0..3usize.pow(n as u32) {
                let digit = |j: usize| code / 3usize.pow(j as u32) % 3;
                let free: Vec<usize> = (0..n).filter(|&j| digit(j) == 0).collect();
                let mut s =
                    DVector::from_fn(n, |j, _| [0.0, self.lower[j], self.upper[j]][digit(j)]);
                let m = self.residuals.len();
                let mut stacked = DMatrix::zeros(m + free.len(), free.len());
                let mut right = DVector::zeros(m + free.len());
                right
                    .rows_mut(0, m)
                    .copy_from(&-(&self.jacobian * &s + &self.residuals));
                for (place, &j) in free.iter().enumerate() {
                    stacked
                        .view_mut((0, place), (m, 1))
                        .copy_from(&self.jacobian.column(j));
                    stacked[(m + place, place)] = self.damping.sqrt();
                }
                if !free.is_empty() {
                    let qr = stacked.qr();
                    let goal = qr
                        .r()
                        .solve_upper_triangular(&(qr.q().transpose() * right))
                        .unwrap();
                    free.iter()
                        .zip(goal.iter())
                        .for_each(|(&j, &goal)| s[j] = goal);
                }
                if (0..n).all(|j| self.lower[j] <= s[j] && s[j] <= self.upper[j]) {
                    least = least.min(self.objective(&s));
                }
            }
            least
        }

        /// Asserts that the solution satisfies the Kuhn-Tucker conditions up to rounding errors. The test computes the conditions
        /// from J itself, not from the triangle.
        fn assert_optimal(&self, solver: &BoundedLeastSquares) {
            let s = DVector::from_column_slice(solver.step());
            let remainder = &self.jacobian * &s + &self.residuals;
            let size = self.jacobian.norm()
                * (self.jacobian.norm() * s.norm() + self.residuals.norm())
                + self.damping * s.norm();
            let rounding = 4.0 * (self.residuals.len() + s.len()) as f64 * f64::EPSILON * size;
            let slopes = self.jacobian.transpose() * remainder + self.damping * &s;
            for j in 0..s.len() {
                assert!(self.lower[j] <= s[j] && s[j] <= self.upper[j]);
                match solver.active_bounds()[j] {
                    ActiveBound::Free => {
                        assert!(slopes[j].abs() <= rounding, "{} {rounding:e}", slopes[j])
                    }
                    ActiveBound::Lower => assert!(slopes[j] >= -rounding && s[j] == self.lower[j]),
                    ActiveBound::Upper => assert!(slopes[j] <= rounding && s[j] == self.upper[j]),
                }
            }
        }
    }

    #[test]
    fn the_solution_is_the_best_of_all_active_sets() {
        for seed in 0..2000 {
            let case = Case::random(seed, 1 + seed as usize % 4, 2 + seed as usize % 7);
            let solver = case.solve();
            case.assert_optimal(&solver);
            let found = case.objective(&DVector::from_column_slice(solver.step()));
            let least = case.by_enumeration();
            assert!(
                (found - least).abs() <= 1e-12 * (least + case.residuals.norm_squared()),
                "seed {seed}"
            );
        }
    }

    #[test]
    fn the_conditions_of_kuhn_and_tucker_hold() {
        for seed in 0..600 {
            let n = 1 + seed as usize % 40;
            let case = Case::random(seed, n, [5, 60, 200][seed as usize % 3]);
            case.assert_optimal(&case.solve());
        }
    }

    #[test]
    fn the_predicted_reduction_is_the_difference_of_the_squares() {
        for seed in 0..100 {
            let case = Case::random(seed, 5, 30);
            let solver = case.solve();
            let s = DVector::from_column_slice(solver.step());
            let after = (&case.jacobian * s + &case.residuals).norm_squared();
            let difference = case.residuals.norm_squared() - after;
            let bound = 200.0 * f64::EPSILON * (after + case.residuals.norm_squared());
            assert!((solver.predicted_reduction() - difference).abs() <= bound);
        }
    }

    /// With two equal columns and one residual, damping divides the move equally between the two variables. If a bound stops
    /// one variable, the other moves by the rest.
    #[test]
    fn equal_columns_share_the_move() {
        let mut solver = BoundedLeastSquares::new(2, 1);
        let (jacobian, residuals) = (
            DMatrix::from_element(1, 2, 1.0),
            DVector::from_element(1, -1.0),
        );
        solver.reduce(&jacobian, &DVector::repeat(2, 1.0), &residuals);
        solver.solve(1e-8, &[-1.0, -1.0], &[1.0, 1.0]);
        assert!((solver.step()[0] - 0.5).abs() < 1e-8 && (solver.step()[1] - 0.5).abs() < 1e-8);
        solver.solve(1e-8, &[-1.0, -1.0], &[0.25, 1.0]);
        assert_eq!(solver.step()[0], 0.25);
        assert!((solver.step()[1] - 0.75).abs() < 1e-8);
        assert_eq!(
            solver.active_bounds(),
            [ActiveBound::Upper, ActiveBound::Free]
        );
    }
}
