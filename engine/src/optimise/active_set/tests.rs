//! Compares solutions of quadratic optimisation problems with an enumeration of active sets. Also tests degenerate problems.

use super::{ActiveSet, Held, Outcome, Rows};
use crate::optimise::test_problems::Noise;
use nalgebra::{DMatrix, DVector};

/// A quadratic optimisation problem, as plain matrices. `triangle` and `offset` are the objective; the other fields are the
/// constraints.
struct Program {
    triangle: DMatrix<f64>,
    offset: DVector<f64>,
    normals: DMatrix<f64>,
    offsets: DVector<f64>,
    equalities: usize,
    lower: DVector<f64>,
    upper: DVector<f64>,
}

impl Program {
    /// A random problem. Every third problem has parallel and repeated rows. Every fifth problem has a factor R whose
    /// pivots span up to seven decades. In every second problem, the bounds can be very close to the random point `inside`.
    fn random(seed: u64, n: usize, rows: usize, equalities: usize) -> Self {
        let mut noise = Noise::new(seed);
        let mut triangle = DMatrix::from_fn(n, n, |_, _| noise.next()).qr().r();
        for k in 0..n {
            let size = if seed.is_multiple_of(5) {
                10f64.powf(-7.0 * k as f64 / n as f64)
            } else {
                1.0
            };
            triangle[(k, k)] = size * (1.0 + noise.next().abs());
            triangle
                .row_mut(k)
                .columns_mut(k + 1, n - k - 1)
                .scale_mut(size);
        }
        let mut normals = DMatrix::from_fn(rows, n, |_, _| noise.next());
        let inside = DVector::from_fn(n, |_, _| noise.next());
        // Most problems have `inside` as an interior point. In degenerate problems this point lies on the boundary of every
        // row.
        let spread = if seed.is_multiple_of(4) { 0.0 } else { 1.0 };
        let mut slack: Vec<f64> = (0..rows).map(|_| spread * noise.next().abs()).collect();
        if seed.is_multiple_of(7) {
            slack.iter_mut().for_each(|s| *s -= 0.3);
        }
        if seed.is_multiple_of(3) {
            for row in equalities + 1..rows {
                if row % 2 == 0 {
                    let scale = if row % 4 == 0 { 1.0 } else { -2.0 };
                    let before = normals.row(row - 1) * scale;
                    normals.set_row(row, &before);
                }
            }
        }
        let values = &normals * &inside;
        let offsets = DVector::from_fn(rows, |i, _| {
            let slack = if i < equalities { 0.0 } else { slack[i] };
            -values[i] - slack
        });
        let wide = if seed.is_multiple_of(2) { 0.0 } else { 0.5 };
        let lower = inside.map(|x| x - wide - noise.next().abs() * 0.5);
        let upper = inside.map(|x| x + wide + noise.next().abs() * 0.5);
        Program {
            offset: DVector::from_fn(n, |_, _| 3.0 * noise.next()),
            triangle,
            normals,
            offsets,
            equalities,
            lower,
            upper,
        }
    }

    fn run(&self) -> (Outcome, ActiveSet) {
        let mut method = ActiveSet::new(self.offset.len());
        let normals: Vec<f64> = self.normals.transpose().as_slice().to_vec();
        let rows = Rows {
            normals: &normals,
            offsets: self.offsets.as_slice(),
            equalities: self.equalities,
            slack: 0.0,
        };
        let (triangle, offset) = (self.triangle.as_slice(), self.offset.as_slice());
        let (lower, upper) = (self.lower.as_slice(), self.upper.as_slice());
        let outcome = method.solve(triangle, offset, rows, lower, upper);
        (outcome, method)
    }

    fn value(&self, d: &DVector<f64>) -> f64 {
        0.5 * (&self.triangle * d + &self.offset).norm_squared()
    }

    /// Largest violation of rows and bounds at a point.
    fn violation(&self, d: &DVector<f64>) -> f64 {
        let rows = &self.normals * d + &self.offsets;
        let rows = rows.iter().enumerate().map(|(i, value)| {
            if i < self.equalities {
                value.abs()
            } else {
                *value
            }
        });
        let bounds = (0..d.len()).map(|j| (self.lower[j] - d[j]).max(d[j] - self.upper[j]));
        rows.chain(bounds).fold(0.0, crate::number::larger)
    }

    /// Gradient of a constraint.
    fn gradient(&self, held: Held) -> DVector<f64> {
        let mut gradient = DVector::zeros(self.offset.len());
        match held {
            Held::Row(row) => gradient = self.normals.row(row).transpose(),
            Held::Lower(j) => gradient[j] = -1.0,
            Held::Upper(j) => gradient[j] = 1.0,
        }
        gradient
    }

    /// Smallest objective, by a trial of all sets of held constraints. For each set, the point is the minimum with these
    /// constraints held. Only feasible points count.
    fn by_enumeration(&self) -> f64 {
        let n = self.offset.len();
        let mut all: Vec<Held> = (self.equalities..self.offsets.len())
            .map(Held::Row)
            .collect();
        all.extend((0..n).flat_map(|j| [Held::Lower(j), Held::Upper(j)]));
        let inverse = self.triangle.clone().try_inverse().unwrap();
        let free = -(&inverse * &self.offset);
        let mut least = f64::INFINITY;
        for code in 0..1_u32 << all.len() {
            let chosen = (0..all.len())
                .filter(|k| code >> k & 1 == 1)
                .map(|k| all[k]);
            let held: Vec<Held> = (0..self.equalities).map(Held::Row).chain(chosen).collect();
            if held.len() > n {
                continue;
            }
            let mut point = free.clone();
            if !held.is_empty() {
                let gradients: Vec<_> = held.iter().map(|h| self.gradient(*h)).collect();
                let goal = DVector::from_fn(held.len(), |k, _| match held[k] {
                    Held::Row(row) => -self.offsets[row],
                    Held::Lower(j) => -self.lower[j],
                    Held::Upper(j) => self.upper[j],
                });
                let gradients = DMatrix::from_columns(&gradients);
                let across = inverse.transpose() * &gradients;
                let Some(cholesky) = (across.transpose() * &across).cholesky() else {
                    continue;
                };
                let away = goal - gradients.transpose() * &free;
                point += &inverse * &across * cholesky.solve(&away);
            }
            if self.violation(&point) < 1e-9 {
                least = least.min(self.value(&point));
            }
        }
        least
    }
}

#[test]
fn minima_obey_the_kuhn_tucker_conditions_and_refusals_are_proved() {
    let (mut solved, mut refused) = (0, 0);
    for seed in 0..400 {
        let n = 1 + seed as usize % 9;
        let equalities = if seed % 3 == 1 { n / 3 } else { 0 };
        let rows = equalities + (seed as usize * 7) % 40;
        let program = Program::random(seed, n, rows, equalities);
        let (outcome, method) = program.run();
        let d = DVector::from_column_slice(method.step());
        match outcome {
            Outcome::Solved => {
                solved += 1;
                let mut slope = program
                    .triangle
                    .tr_mul(&(&program.triangle * &d + &program.offset));
                let mut size = program.triangle.norm() * program.offset.norm();
                for (held, multiplier) in method.multipliers() {
                    let is_equality = matches!(held, Held::Row(row) if row < equalities);
                    assert!(
                        is_equality || multiplier >= -1e-9 * size,
                        "{seed}: {held:?}"
                    );
                    let push = program.gradient(held) * multiplier;
                    size += push.norm();
                    slope += push;
                }
                assert!(
                    slope.norm() < 1e-8 * size,
                    "{seed}: {}",
                    slope.norm() / size
                );
                assert!(
                    program.violation(&d) < 1e-8,
                    "{seed}: {}",
                    program.violation(&d)
                );
            }
            // Farkas' lemma shows the contradiction. With multipliers of the right signs, the weighted sum of the gradients
            // is zero. So the weighted sum of the values is the same at every point, and it is positive.
            Outcome::Infeasible(culprits) => {
                refused += 1;
                let gradients: Vec<_> = culprits.iter().map(|h| program.gradient(*h)).collect();
                let gradients = DMatrix::from_columns(&gradients);
                // The eigenvector of the smallest eigenvalue has the factors of the linear dependence of the gradients.
                let square = gradients.tr_mul(&gradients);
                let eigen = square.symmetric_eigen();
                let least = eigen.eigenvalues.imin();
                let factors = eigen.eigenvectors.column(least).into_owned();
                assert!(
                    (&gradients * &factors).norm() < 1e-6,
                    "{seed}: {culprits:?}"
                );
                let constants = DVector::from_fn(culprits.len(), |k, _| match culprits[k] {
                    Held::Row(row) => program.offsets[row],
                    Held::Lower(j) => program.lower[j],
                    Held::Upper(j) => -program.upper[j],
                });
                let value = factors.dot(&constants);
                for (held, factor) in culprits.iter().zip(&factors) {
                    let is_equality = matches!(held, Held::Row(row) if *row < equalities);
                    assert!(
                        is_equality || factor * value > -1e-9,
                        "{seed}: {culprits:?}"
                    );
                }
                assert!(value.abs() > 1e-12, "{seed}: {value}");
            }
            Outcome::Stalled => panic!("{seed}: stalled"),
        }
    }
    assert!(solved > 200 && refused > 30, "{solved} {refused}");
}

#[test]
fn the_minimum_is_the_least_of_all_active_sets() {
    // The enumeration squares the condition number of R, so badly conditioned problems are omitted.
    for seed in (0..75).filter(|seed| seed % 5 != 0) {
        let n = 1 + seed as usize % 3;
        let equalities = usize::from(seed % 3 == 1 && n > 1);
        let program = Program::random(1000 + seed, n, equalities + seed as usize % 5, equalities);
        let (outcome, method) = program.run();
        let least = program.by_enumeration();
        match outcome {
            Outcome::Solved => {
                let found = program.value(&DVector::from_column_slice(method.step()));
                assert!(
                    (found - least).abs() < 1e-8 * (1.0 + least),
                    "{seed}: {found} {least}"
                );
            }
            _ => assert!(least.is_infinite(), "{seed}: {outcome:?} {least}"),
        }
    }
}

/// The test expects that the method names the two rows that contradict one another, and no other row.
#[test]
fn a_planted_contradiction_is_named_alone() {
    let normals = [1.0, 1.0, 0.0, 0.3, -1.0, 0.2, -1.0, -1.0, 0.0];
    let rows = Rows {
        normals: &normals,
        offsets: &[1.0, -5.0, 2.0],
        equalities: 0,
        slack: 0.0,
    };
    let mut method = ActiveSet::new(3);
    let triangle = DMatrix::<f64>::identity(3, 3);
    let wide = [1e3; 3];
    let narrow = wide.map(|w| -w);
    let outcome = method.solve(triangle.as_slice(), &[0.0; 3], rows, &narrow, &wide);
    // x + y <= -1 and -x - y <= -2.
    assert_eq!(
        outcome,
        Outcome::Infeasible(vec![Held::Row(0), Held::Row(2)])
    );
}
