//! Problems with known answers, for the tests.
//!
//! Most problems are from J. J. Moré, B. S. Garbow, K. E. Hillstrom, Testing unconstrained optimization software, ACM Trans.
//! Math. Softw. 7, 1981 (numbers in brackets), which lists the sums of squares at the minima to six digits.

use super::{Assessment, Constrained, Infeasible, LeastSquares, Linearisation, Shape};
use nalgebra::DVector;

/// Reproducible pseudorandom numbers in [-1, 1) (G. Steele, D. Lea, Ch. Flood, Fast splittable pseudorandom number
/// generators, OOPSLA 2014).
pub(super) struct Noise(u64);

impl Noise {
    pub(super) fn new(seed: u64) -> Self {
        Noise(seed)
    }

    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

pub(super) fn vector(entries: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(entries)
}

/// Values with their gradients.
pub(super) type Values = Vec<(f64, Vec<f64>)>;

/// Residuals with their gradients, or the reason why there are no residuals.
pub(super) type Rows = Result<Values, Infeasible>;

/// Writes values with their gradients.
fn write(rows: Values, into: &mut Linearisation) {
    for (i, (value, gradient)) in rows.into_iter().enumerate() {
        into.residuals[i] = value;
        into.write_slopes(i, &gradient, 1.0);
    }
}

/// A problem written as a function of the variables.
#[derive(Clone)]
pub(super) struct Written<F> {
    variables: usize,
    residuals: usize,
    rows: F,
}

/// Makes the problem of a function. The function must have residuals at this point.
pub(super) fn written<F: Fn(&[f64]) -> Rows>(rows: F, at: &[f64]) -> Written<F> {
    Written {
        variables: at.len(),
        residuals: rows(at).expect("the start has residuals").len(),
        rows,
    }
}

impl<F: FnMut(&[f64]) -> Rows> LeastSquares for Written<F> {
    fn variables(&self) -> usize {
        self.variables
    }

    fn residuals(&self) -> usize {
        self.residuals
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible> {
        write((self.rows)(x.as_slice())?, into);
        Ok(())
    }
}

/// Test problem: residuals of the goal, residuals with a limited norm (level), and constraint rows, as functions of the
/// variables.
pub(super) struct Stated<F> {
    shape: Shape,
    at: F,
}

impl<F: FnMut(&[f64]) -> [Values; 3]> Constrained for Stated<F> {
    fn shape(&self) -> Shape {
        self.shape.clone()
    }
    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        let mut nothing = Linearisation::new(0, x.len());
        let level = into.levels.first_mut().unwrap_or(&mut nothing);
        let parts = [&mut into.goal, level, &mut into.rows];
        for (part, values) in parts.into_iter().zip((self.at)(x.as_slice())) {
            write(values, part);
        }
        Ok(())
    }
}

/// Makes the problem of a function with a start point. `level` limits the second group of values.
pub(super) fn stated<F: FnMut(&[f64]) -> [Values; 3]>(
    start: &[f64],
    equalities: usize,
    level: f64,
    mut at: F,
) -> Stated<F> {
    let [goal, held, rows] = at(start);
    Stated {
        shape: Shape {
            variables: start.len(),
            goal: goal.len(),
            levels: match held.len() {
                0 => Vec::new(),
                count => vec![(count, level)],
            },
            rows: rows.len(),
            equalities,
        },
        at,
    }
}

pub(super) type Function = fn(&[f64]) -> Rows;

/// A published problem: its start, its box (wide if none is published) and the least sum of squares that a run from this
/// start reaches.
pub(super) struct Published {
    pub name: &'static str,
    pub rows: Function,
    pub start: &'static [f64],
    pub ranges: &'static [[f64; 2]],
    pub sum_of_squares: f64,
}

const WIDE: [f64; 2] = [-100.0, 100.0];

pub(super) const PUBLISHED: &[Published] = &[
    Published {
        name: "Rosenbrock (1)",
        rows: rosenbrock,
        start: &[-1.2, 1.0],
        ranges: &[WIDE; 2],
        sum_of_squares: 0.0,
    },
    Published {
        name: "Freudenstein and Roth (2)",
        rows: freudenstein_roth,
        start: &[0.5, -2.0],
        ranges: &[WIDE; 2],
        sum_of_squares: 48.9842,
    },
    Published {
        name: "Beale (5)",
        rows: beale,
        start: &[1.0, 1.0],
        ranges: &[[-10.0, 10.0]; 2],
        sum_of_squares: 0.0,
    },
    Published {
        name: "Jennrich and Sampson (6)",
        rows: jennrich_sampson,
        start: &[0.3, 0.4],
        ranges: &[[-1.0, 1.0]; 2],
        sum_of_squares: 124.362,
    },
    Published {
        name: "Bard (8)",
        rows: bard,
        start: &[1.0, 1.0, 1.0],
        ranges: &[[-10.0, 10.0]; 3],
        sum_of_squares: 8.21487e-3,
    },
    Published {
        name: "Powell singular (13)",
        rows: powell_singular,
        start: &[3.0, -1.0, 0.0, 1.0],
        ranges: &[WIDE; 4],
        sum_of_squares: 0.0,
    },
    Published {
        name: "Wood (14)",
        rows: wood,
        start: &[-3.0, -1.0, -3.0, -1.0],
        ranges: &[[-10.0, 10.0]; 4],
        sum_of_squares: 0.0,
    },
    Published {
        name: "Kowalik and Osborne (15)",
        rows: kowalik_osborne,
        start: &[0.25, 0.39, 0.415, 0.39],
        ranges: &[[-1.0, 1.0]; 4],
        sum_of_squares: 3.07505e-4,
    },
    // W. Hock, K. Schittkowski, Test examples for nonlinear programming codes, 1981, problems 1, 2.
    Published {
        name: "Rosenbrock above -1.5 (Hock and Schittkowski 1)",
        rows: rosenbrock,
        start: &[-2.0, 1.0],
        ranges: &[[-100.0, 100.0], [-1.5, 100.0]],
        sum_of_squares: 0.0,
    },
    Published {
        name: "Rosenbrock above 1.5, from the right (Hock and Schittkowski 2)",
        rows: rosenbrock,
        start: &[2.0, 3.0],
        ranges: &[[-100.0, 100.0], [1.5, 100.0]],
        sum_of_squares: 0.050_426_187_9,
    },
];

pub(super) fn rosenbrock(x: &[f64]) -> Rows {
    Ok(vec![
        (10.0 * (x[1] - x[0] * x[0]), vec![-20.0 * x[0], 10.0]),
        (1.0 - x[0], vec![-1.0, 0.0]),
    ])
}

pub(super) fn freudenstein_roth(x: &[f64]) -> Rows {
    let y = x[1];
    Ok(vec![
        (
            -13.0 + x[0] + ((5.0 - y) * y - 2.0) * y,
            vec![1.0, 10.0 * y - 3.0 * y * y - 2.0],
        ),
        (
            -29.0 + x[0] + ((y + 1.0) * y - 14.0) * y,
            vec![1.0, 3.0 * y * y + 2.0 * y - 14.0],
        ),
    ])
}

fn beale(x: &[f64]) -> Rows {
    let row = |i: i32, wanted: f64| {
        let power = x[1].powi(i);
        let slope = x[0] * f64::from(i) * x[1].powi(i - 1);
        (wanted - x[0] * (1.0 - power), vec![power - 1.0, slope])
    };
    Ok(vec![row(1, 1.5), row(2, 2.25), row(3, 2.625)])
}

fn jennrich_sampson(x: &[f64]) -> Rows {
    let row = |i: i32| {
        let i = f64::from(i);
        let (a, b) = ((i * x[0]).exp(), (i * x[1]).exp());
        (2.0 + 2.0 * i - (a + b), vec![-i * a, -i * b])
    };
    Ok((1..=10).map(row).collect())
}

fn bard(x: &[f64]) -> Rows {
    let data = [
        0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39,
    ];
    let row = |(i, y): (usize, f64)| {
        let u = (i + 1) as f64;
        let v = 16.0 - u;
        let w = u.min(v);
        let below = v * x[1] + w * x[2];
        let slope = u / (below * below);
        (y - (x[0] + u / below), vec![-1.0, v * slope, w * slope])
    };
    Ok(data.into_iter().enumerate().map(row).collect())
}

fn powell_singular(x: &[f64]) -> Rows {
    let (five, ten) = (5.0_f64.sqrt(), 10.0_f64.sqrt());
    let (a, b) = (x[1] - 2.0 * x[2], x[0] - x[3]);
    Ok(vec![
        (x[0] + 10.0 * x[1], vec![1.0, 10.0, 0.0, 0.0]),
        (five * (x[2] - x[3]), vec![0.0, 0.0, five, -five]),
        (a * a, vec![0.0, 2.0 * a, -4.0 * a, 0.0]),
        (ten * b * b, vec![2.0 * ten * b, 0.0, 0.0, -2.0 * ten * b]),
    ])
}

fn wood(x: &[f64]) -> Rows {
    let (ninety, ten) = (90.0_f64.sqrt(), 10.0_f64.sqrt());
    Ok(vec![
        (
            10.0 * (x[1] - x[0] * x[0]),
            vec![-20.0 * x[0], 10.0, 0.0, 0.0],
        ),
        (1.0 - x[0], vec![-1.0, 0.0, 0.0, 0.0]),
        (
            ninety * (x[3] - x[2] * x[2]),
            vec![0.0, 0.0, -2.0 * ninety * x[2], ninety],
        ),
        (1.0 - x[2], vec![0.0, 0.0, -1.0, 0.0]),
        (ten * (x[1] + x[3] - 2.0), vec![0.0, ten, 0.0, ten]),
        ((x[1] - x[3]) / ten, vec![0.0, 1.0 / ten, 0.0, -1.0 / ten]),
    ])
}

fn kowalik_osborne(x: &[f64]) -> Rows {
    let data = [
        (0.1957, 4.0),
        (0.1947, 2.0),
        (0.1735, 1.0),
        (0.1600, 0.5),
        (0.0844, 0.25),
        (0.0627, 0.167),
        (0.0456, 0.125),
        (0.0342, 0.1),
        (0.0323, 0.0833),
        (0.0235, 0.0714),
        (0.0246, 0.0625),
    ];
    let row = |(y, u): (f64, f64)| {
        let above = u * (u + x[1]);
        let below = u * (u + x[2]) + x[3];
        let slope = x[0] * above / (below * below);
        (
            y - x[0] * above / below,
            vec![-above / below, -x[0] * u / below, slope * u, slope],
        )
    };
    Ok(data.into_iter().map(row).collect())
}
