//! Strictly convex quadratic programs by the dual active-set method.
//!
//! Minimise |R d + q|^2 / 2 over d subject to
//!
//! ```text
//! a_i . d + c_i  = 0    for the first rows,
//! a_i . d + c_i <= 0    for the others,
//! lower <= d <= upper
//! ```
//!
//! with R upper triangular and regular. The method begins at the minimum without constraints, -R^-1 q. Then it repeats this
//! step: it adds the most violated constraint to the set of held constraints, and moves to the minimum under the held
//! constraints (D. Goldfarb, A. Idnani, A numerically stable dual method for solving strictly convex quadratic programs,
//! Mathematical Programming 27, 1983). So the method needs no feasible point at the start. If there is no feasible point,
//! the method ends at a violated constraint. The gradient of this constraint is a combination of gradients of held
//! constraints, and each of these held constraints prevents the move. By Farkas' lemma these constraints contradict one
//! another. The held gradients are independent, so none of these constraints can be left out.
//!
//! The method works on a matrix J with J^T R^T R J = 1. The first q columns of J span the q held gradients. A move along the
//! other columns leaves the values of the held constraints unchanged. J begins as R^-1, so the normal equations are never
//! formed. The normals n point into the feasible side, n . d >= b. J_2 contains the columns of J after the first q. v_1
//! contains the first q numbers of v, and v_2 the other numbers of v.
//!
//! ```text
//! J^T [n_1 .. n_q] = [T; 0]        T upper triangular, kept so by plane rotations                   (1)
//! v = J^T n,   z = J_2 v_2,   w = T^-1 v_1       directions of d and of the multipliers when n is added    (2)
//! ```

#[cfg(test)]
mod tests;

use super::qr::{back_substitute, dot};

/// A constraint of the quadratic program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Held {
    /// A row of [`Rows`], given by its index.
    Row(usize),
    /// The lower bound of a variable, given by its index.
    Lower(usize),
    /// The upper bound of a variable, given by its index.
    Upper(usize),
}

/// Constraints a . d + c of a quadratic program, one constraint in each row. The equalities come first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rows<'a> {
    /// Vectors a, one row after another.
    pub normals: &'a [f64],
    /// Offsets c, one for each row.
    pub offsets: &'a [f64],
    /// Number of rows that must be zero. All other rows must be at most zero.
    pub equalities: usize,
    /// Largest violation, in the unit of the rows, with which a row still counts as satisfied. This limit applies only to rows
    /// whose gradient is a linear combination of the gradients of the held constraints. Without this limit, duplicate rows would
    /// contradict one another, because they are equal only up to rounding errors. All inequality rows may use 1 % of it.
    pub slack: f64,
}

/// Outcome of a quadratic program.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The step is the minimum of the quadratic program.
    Solved,
    /// These constraints contradict one another. If any one of them were removed, the others could be met.
    Infeasible(Vec<Held>),
    /// Rounding errors prevented the method from coming to an end.
    Stalled,
}

/// The dual active-set method, with its workspace.
#[derive(Clone, Debug)]
pub struct ActiveSet {
    variables: usize,
    /// Basis J of the method, column after column.
    basis: Vec<f64>,
    /// Triangle T of equation (1) of this module, column after column, n entries each.
    triangle: Vec<f64>,
    /// Held constraints, which are at their limits in the current step.
    held: Vec<Held>,
    /// Sign of each held constraint. Only equalities need a sign, because the normal of an equality may point in either
    /// direction.
    sign: Vec<f64>,
    /// Lagrange multiplier of each held constraint.
    multipliers: Vec<f64>,
    /// Flags of the rows, then of the lower bounds, then of the upper bounds. A flag is true if the constraint is held, or if
    /// its gradient depends on held constraints and its violation is within the tolerance.
    is_held: Vec<bool>,
    step: Vec<f64>,
    /// Vector n of equation (2) of this module: the normal of the constraint that is being added.
    normal: Vec<f64>,
    /// Vector v of equation (2) of this module: the normal n in the basis J.
    projected: Vec<f64>,
    /// Vector z of equation (2) of this module: direction of the step.
    way: Vec<f64>,
    /// Vector w of equation (2) of this module: direction in which the multipliers change.
    change: Vec<f64>,
    /// Lengths of the vectors a of the rows.
    norms: Vec<f64>,
}

/// Relative tolerance of an inequality row or bound. It counts as satisfied if its violation is at most this fraction of the
/// sum of the absolute values of its terms.
const ROUNDING: f64 = 1e-13;
/// Threshold of dependence: a gradient depends on the held gradients if less than this share of its squared length lies
/// outside their span.
const DEPENDENT: f64 = 1e-25;
/// Replaces the threshold [`DEPENDENT`] for a row that is violated by no more than [`Rows::slack`], because the gradients of
/// duplicate rows differ by rounding errors.
const NEARLY_DEPENDENT: f64 = 1e-18;
/// Fraction of [`Rows::slack`] up to which the violation of an inequality row counts as satisfied.
const UNFELT: f64 = 1e-2;
/// Relative tolerance of a constraint whose gradient depends on the held gradients. It is larger than [`ROUNDING`], because
/// the computed step has fewer correct digits if the triangle R of the objective is badly conditioned.
const MARGINAL: f64 = 1e-9;
/// Smallest coefficient in a combination of gradients. A constraint with a smaller coefficient does not belong to the
/// combination.
const UNINVOLVED: f64 = 1e-9;

impl ActiveSet {
    /// Allocates the workspace for quadratic programs with this number of variables.
    pub fn new(variables: usize) -> Self {
        let n = variables;
        ActiveSet {
            variables,
            basis: vec![0.0; n * n],
            triangle: vec![0.0; n * n],
            held: Vec::with_capacity(n),
            sign: Vec::with_capacity(n),
            multipliers: Vec::with_capacity(n + 1),
            is_held: Vec::new(),
            step: vec![0.0; n],
            normal: vec![0.0; n],
            projected: vec![0.0; n],
            way: vec![0.0; n],
            change: vec![0.0; n],
            norms: Vec::new(),
        }
    }

    /// Returns the step of the last quadratic program.
    pub fn step(&self) -> &[f64] {
        &self.step
    }

    /// Returns the held constraints with their multipliers. At the minimum, R^T (R d + q) + sum of multiplier times
    /// gradient = 0. The gradient of a row is the vector a. The gradient of a bound is -1 (lower bound) or +1 (upper
    /// bound). Multipliers of inequalities and bounds are not negative.
    pub fn multipliers(&self) -> impl Iterator<Item = (Held, f64)> {
        let held = self.held.iter().zip(&self.sign);
        held.zip(&self.multipliers)
            .map(|((held, sign), multiplier)| (*held, sign * multiplier))
    }

    /// Solves a quadratic program. `triangle` holds the n columns of R with n entries each; `offset` is q. `lower` and `upper`
    /// may be infinite.
    pub fn solve(
        &mut self,
        triangle: &[f64],
        offset: &[f64],
        rows: Rows<'_>,
        lower: &[f64],
        upper: &[f64],
    ) -> Outcome {
        let n = self.variables;
        self.begin(triangle, offset, rows);
        for row in 0..rows.equalities {
            if let Err(outcome) = self.add_equality(row, rows) {
                return outcome;
            }
        }
        // Every round adds a constraint and raises the minimum, so the rounds end by themselves. The limit only guards
        // against rounding errors.
        for _ in 0..20 * (n + rows.offsets.len()) + 100 {
            let Some((constraint, slack)) = self.most_violated(rows, lower, upper) else {
                return Outcome::Solved;
            };
            if let Err(outcome) = self.add(constraint, slack, rows) {
                return outcome;
            }
        }
        Outcome::Stalled
    }

    /// Starts with the basis J = R^-1, the step d = -R^-1 q and no held constraint.
    fn begin(&mut self, triangle: &[f64], offset: &[f64], rows: Rows<'_>) {
        let n = self.variables;
        self.held.clear();
        self.sign.clear();
        self.multipliers.clear();
        self.is_held.clear();
        self.is_held.resize(rows.offsets.len() + 2 * n, false);
        self.norms.clear();
        let normals = rows.normals.chunks_exact(n);
        self.norms.extend(normals.map(|a| dot(a, a).sqrt()));
        self.basis.fill(0.0);
        for column in 0..n {
            let inverse = &mut self.basis[column * n..][..=column];
            inverse[column] = 1.0;
            back_substitute(&triangle[..(column + 1) * n], n, inverse);
        }
        self.step.fill(0.0);
        for (j, column) in self.basis.chunks_exact(n).enumerate() {
            for (i, step) in self.step.iter_mut().enumerate() {
                *step -= offset[j] * column[i];
            }
        }
    }

    /// Adds an equality row to the held constraints.
    fn add_equality(&mut self, row: usize, rows: Rows<'_>) -> Result<(), Outcome> {
        let a = &rows.normals[row * self.variables..][..self.variables];
        let value = dot(a, &self.step) + rows.offsets[row];
        // The normal points in the direction in which the row's value approaches zero.
        let sign = if value > 0.0 { -1.0 } else { 1.0 };
        for (normal, a) in self.normal.iter_mut().zip(a) {
            *normal = sign * a;
        }
        self.project();
        let (gain, size) = self.gain();
        let slack = -value.abs();
        if depends(gain, size, -slack, rows) {
            if -slack <= rows.slack.max(MARGINAL * self.terms(Held::Row(row), rows)) {
                return Ok(());
            }
            return Err(self.exclusion(Held::Row(row)));
        }
        let length = -slack / gain;
        if !length.is_finite() {
            return Err(Outcome::Stalled);
        }
        self.advance(length, length);
        self.hold(Held::Row(row), -sign, length);
        Ok(())
    }

    /// Returns the inequality row or bound with the largest violation, measured as a distance, and its negative violation.
    /// `None` if all are satisfied. Constraints with a flag in `is_held` are not examined.
    fn most_violated(&self, rows: Rows<'_>, lower: &[f64], upper: &[f64]) -> Option<(Held, f64)> {
        let n = self.variables;
        let mut worst = (0.0, None);
        let mut note = |violation: f64, norm: f64, rounding: f64, constraint| {
            if violation > ROUNDING * rounding && violation > worst.0 * norm {
                worst = (violation / norm, Some((constraint, -violation)));
            }
        };
        for row in rows.equalities..rows.offsets.len() {
            let (a, c) = (&rows.normals[row * n..][..n], rows.offsets[row]);
            let value = dot(a, &self.step) + c;
            if value > UNFELT * rows.slack && !self.is_held[row] {
                let terms = a.iter().zip(&self.step).map(|(a, d)| (a * d).abs());
                // A violated row with a zero gradient cannot be satisfied. Division by the tiny length of its gradient
                // makes the distance of this row the largest. So the row is selected, and the next step reports it.
                let norm = self.norms[row].max(f64::MIN_POSITIVE);
                note(value, norm, c.abs() + terms.sum::<f64>(), Held::Row(row));
            }
        }
        let count = rows.offsets.len();
        for (j, step) in self.step.iter().enumerate() {
            let size = step.abs();
            if lower[j] > *step && !self.is_held[count + j] {
                note(lower[j] - step, 1.0, lower[j].abs() + size, Held::Lower(j));
            }
            if upper[j] < *step && !self.is_held[count + n + j] {
                note(step - upper[j], 1.0, upper[j].abs() + size, Held::Upper(j));
            }
        }
        worst.1
    }

    /// Adds a violated constraint. Releases the constraints whose multipliers get the wrong sign.
    fn add(&mut self, constraint: Held, slack: f64, rows: Rows<'_>) -> Result<(), Outcome> {
        let n = self.variables;
        match constraint {
            Held::Row(row) => {
                let a = &rows.normals[row * n..][..n];
                for (normal, a) in self.normal.iter_mut().zip(a) {
                    *normal = -a;
                }
            }
            Held::Lower(j) | Held::Upper(j) => {
                self.normal.fill(0.0);
                let inward = matches!(constraint, Held::Lower(_));
                self.normal[j] = if inward { 1.0 } else { -1.0 };
            }
        }
        let (mut slack, mut multiplier) = (slack, 0.0);
        // Every round except the last releases one constraint.
        for _ in 0..=n {
            self.project();
            let (gain, size) = self.gain();
            let dependent = depends(gain, size, -slack, rows) || self.held.len() == n;
            let full = if dependent {
                f64::INFINITY
            } else {
                -slack / gain
            };
            let mut nearest = None;
            let mut partial = f64::INFINITY;
            let largest = self.change.iter().take(self.held.len());
            let tiny = f64::EPSILON * largest.fold(0.0, |most: f64, w| most.max(w.abs()));
            for place in 0..self.held.len() {
                let change = self.change[place];
                if change > tiny && !self.is_equality(place, rows) {
                    let length = self.multipliers[place] / change;
                    if length < partial {
                        (partial, nearest) = (length, Some(place));
                    }
                }
            }
            if dependent && nearest.is_none() {
                if -slack <= rows.slack.max(MARGINAL * self.terms(constraint, rows)) {
                    let place = self.place_of(constraint);
                    self.is_held[place] = true;
                    return Ok(());
                }
                return Err(self.exclusion(constraint));
            }
            let length = full.min(partial);
            if !length.is_finite() {
                return Err(Outcome::Stalled);
            }
            let moved = if dependent { 0.0 } else { length };
            self.advance(moved, length);
            multiplier += length;
            if full <= partial {
                self.hold(constraint, 1.0, multiplier);
                return Ok(());
            }
            slack += moved * gain;
            self.release(nearest.expect("the step is limited by a held row"));
        }
        Err(Outcome::Stalled)
    }

    /// Sum of the absolute values of the terms in a constraint's value.
    fn terms(&self, constraint: Held, rows: Rows<'_>) -> f64 {
        match constraint {
            Held::Row(row) => {
                let a = &rows.normals[row * self.variables..][..self.variables];
                let terms = a.iter().zip(&self.step).map(|(a, d)| (a * d).abs());
                rows.offsets[row].abs() + terms.sum::<f64>()
            }
            Held::Lower(j) | Held::Upper(j) => 2.0 * self.step[j].abs(),
        }
    }

    /// Index of a constraint in `is_held`.
    fn place_of(&self, constraint: Held) -> usize {
        let n = self.variables;
        let rows = self.is_held.len() - 2 * n;
        match constraint {
            Held::Row(row) => row,
            Held::Lower(j) => rows + j,
            Held::Upper(j) => rows + n + j,
        }
    }

    fn is_equality(&self, place: usize, rows: Rows<'_>) -> bool {
        matches!(self.held[place], Held::Row(row) if row < rows.equalities)
    }

    /// Names a constraint that cannot be met, and the held constraints that contradict it.
    fn exclusion(&self, constraint: Held) -> Outcome {
        let held = self.held.iter().zip(&self.change);
        let pushing = held.filter(|(_, change)| change.abs() > UNINVOLVED);
        let mut culprits: Vec<Held> = pushing.map(|(held, _)| *held).collect();
        culprits.push(constraint);
        culprits.sort_unstable();
        Outcome::Infeasible(culprits)
    }

    /// Computes the vectors v, z and w of equation (2) of this module from the normal n in `normal`.
    fn project(&mut self) {
        let n = self.variables;
        let q = self.held.len();
        for (j, column) in self.basis.chunks_exact(n).enumerate() {
            self.projected[j] = dot(column, &self.normal);
        }
        self.way.fill(0.0);
        for k in q..n {
            let v = self.projected[k];
            let column = &self.basis[k * n..][..n];
            for (i, way) in self.way.iter_mut().enumerate() {
                *way += v * column[i];
            }
        }
        self.change[..q].copy_from_slice(&self.projected[..q]);
        back_substitute(&self.triangle[..q * n], n, &mut self.change);
    }

    /// Returns two squared lengths: the first of the part of `normal` outside the span of the held gradients, the second of
    /// the complete `normal`.
    fn gain(&self) -> (f64, f64) {
        let free = &self.projected[self.held.len()..];
        (dot(free, free), dot(&self.projected, &self.projected))
    }

    /// Adds `length` times z (`way`) to the step, and subtracts `by_multipliers` times w (`change`) from the multipliers.
    fn advance(&mut self, length: f64, by_multipliers: f64) {
        if length != 0.0 {
            for (step, way) in self.step.iter_mut().zip(&self.way) {
                *step += length * way;
            }
        }
        for (multiplier, change) in self.multipliers.iter_mut().zip(&self.change) {
            *multiplier -= by_multipliers * change;
        }
    }

    /// Adds a constraint to the active set; `projected` holds the gradient of the constraint in the basis J. Rotates the free
    /// columns of J so that only the first has a component along this gradient.
    fn hold(&mut self, constraint: Held, sign: f64, multiplier: f64) {
        let n = self.variables;
        let q = self.held.len();
        for k in (q + 1..n).rev() {
            let (above, below) = (self.projected[k - 1], self.projected[k]);
            if below == 0.0 {
                continue;
            }
            let length = above.hypot(below);
            let (cosine, sine) = (above / length, below / length);
            self.projected[k - 1] = length;
            self.projected[k] = 0.0;
            rotate(&mut self.basis, n, k, cosine, sine);
        }
        self.triangle[q * n..][..=q].copy_from_slice(&self.projected[..=q]);
        self.held.push(constraint);
        self.sign.push(sign);
        self.multipliers.push(multiplier);
        let place = self.place_of(constraint);
        self.is_held[place] = true;
    }

    /// Releases the held constraint with index `place`. The triangle T loses a column, and rotations make it triangular
    /// again.
    fn release(&mut self, place: usize) {
        let n = self.variables;
        let q = self.held.len();
        let freed = self.place_of(self.held[place]);
        self.is_held[freed] = false;
        self.held.remove(place);
        self.sign.remove(place);
        self.multipliers.remove(place);
        self.triangle.copy_within((place + 1) * n..q * n, place * n);
        for k in place..q - 1 {
            let column = &self.triangle[k * n..];
            let (above, below) = (column[k], column[k + 1]);
            if below == 0.0 {
                continue;
            }
            let length = above.hypot(below);
            let (cosine, sine) = (above / length, below / length);
            for column in self.triangle[k * n..(q - 1) * n].chunks_exact_mut(n) {
                let (above, below) = (column[k], column[k + 1]);
                column[k] = cosine * above + sine * below;
                column[k + 1] = cosine * below - sine * above;
            }
            rotate(&mut self.basis, n, k + 1, cosine, sine);
        }
    }
}

/// Returns true if a gradient depends on the held gradients. `size` is the squared length of the gradient. `gain` is the
/// squared length of its part outside the span of the held gradients. `lack` is the violation of the constraint that the
/// gradient belongs to.
fn depends(gain: f64, size: f64, lack: f64, rows: Rows<'_>) -> bool {
    let share = if lack <= rows.slack {
        NEARLY_DEPENDENT
    } else {
        DEPENDENT
    };
    gain <= share * size
}

/// Rotates the columns `k - 1` and `k` of a matrix with columns of n entries.
fn rotate(matrix: &mut [f64], n: usize, k: usize, cosine: f64, sine: f64) {
    let (before, from) = matrix.split_at_mut(k * n);
    let columns = before[(k - 1) * n..].iter_mut().zip(&mut from[..n]);
    for (x, y) in columns {
        (*x, *y) = (cosine * *x + sine * *y, cosine * *y - sine * *x);
    }
}
