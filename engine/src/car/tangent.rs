//! Exact tangent of the equations of [`super`], and its factors.

use super::equations::{
    BODY, Balance, GROUND, LONGITUDINAL, PITCH, ROLL, SIDE_FORCES, TRAVELS, UNKNOWNS,
};
use super::parameters::Parameters;
use super::solver::Base;
use crate::axle::Reading;
use crate::linear::lu::Lu;
use crate::number::Dual;

pub(super) type Matrix = [[f64; UNKNOWNS]; UNKNOWNS];

/// Factors of a tangent whose rows are divided by their largest entries.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    lu: Lu<f64, UNKNOWNS>,
    scales: [f64; UNKNOWNS],
}

impl Factors {
    /// Factors a tangent; `None` if it is singular.
    pub(super) fn of(tangent: &Matrix) -> Option<Self> {
        let (matrix, scales) = scaled(tangent);
        let lu = Lu::of(matrix, 1.0)?;
        Some(Factors { lu, scales })
    }

    /// Change of the unknowns that changes the residuals by `right`.
    pub(super) fn solve(&self, mut right: [f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
        for (residual, scale) in right.iter_mut().zip(self.scales) {
            *residual *= scale;
        }
        self.lu.solve(right)
    }

    /// Sign of the determinant.
    pub(super) fn orientation(&self) -> f64 {
        self.lu.determinant().signum()
    }
}

/// Residuals and their derivatives by the unknowns. A wheel depends only on the travels of its own axle.
pub(super) fn tangent(
    base: &Base<'_, '_, Reading<f64>>,
    parameters: &Parameters<f64>,
    x: &[f64; UNKNOWNS],
) -> ([f64; UNKNOWNS], Matrix) {
    type Number = Dual<f64, UNKNOWNS>;
    let parameters_of_wheels = parameters.map(Dual::<f64, 2>::constant);
    let corners = [0, 1, 2, 3].map(|number: usize| {
        let [own, other] = [number, number ^ 1].map(|wheel| TRAVELS + wheel);
        let travels = [Dual::input(x[own], 0), Dual::input(x[other], 1)];
        let corner = base.corner(&parameters_of_wheels, number, travels, Dual::constant);
        corner.map(|c: Dual<f64, 2>| {
            let mut number = Number::constant(c.value);
            [number.partials[own], number.partials[other]] = c.partials;
            number
        })
    });
    let mut unknowns = [Number::constant(0.0); UNKNOWNS];
    for (k, unknown) in unknowns.iter_mut().enumerate() {
        *unknown = Dual::input(x[k], k);
    }
    let parameters = parameters.map(Number::constant);
    let balance = Balance::of(&base.held, &parameters, corners, unknowns);
    (
        balance.residuals.map(|row| row.value),
        balance.residuals.map(|row| row.partials),
    )
}

/// Divides each row of a matrix by its largest entry. Returns that matrix and the factors on its rows.
fn scaled(matrix: &Matrix) -> (Matrix, [f64; UNKNOWNS]) {
    let scales = matrix.map(|row| 1.0 / row.iter().fold(0.0_f64, |m, c| m.max(c.abs())));
    let mut scaled = *matrix;
    for (row, scale) in scaled.iter_mut().zip(scales) {
        row.iter_mut().for_each(|c| *c *= scale);
    }
    (scaled, scales)
}

/// Inverse of a matrix; `None` if it is singular.
pub(super) fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let (scaled, scales) = scaled(matrix);
    let mut inverse = Lu::of(scaled, 1.0)?.inverse();
    for row in &mut inverse {
        for (c, scale) in row.iter_mut().zip(scales) {
            *c *= scale;
        }
    }
    Some(inverse)
}

/// Unknowns that stay fixed in motions of the body: the attitude, and the factors of the tyre forces.
pub(super) const HELD: [usize; 6] = [
    ROLL,
    PITCH,
    GROUND,
    SIDE_FORCES,
    SIDE_FORCES + 1,
    LONGITUDINAL,
];

/// Inverse of the tangent in which held unknowns replace the equations of the whole car, in the order of [`HELD`].
pub(super) fn held_inverse(tangent: &Matrix) -> Option<Matrix> {
    let mut matrix = *tangent;
    for (row, unknown) in matrix[BODY..].iter_mut().zip(HELD) {
        row.fill(0.0);
        row[unknown] = 1.0;
    }
    inverse(&matrix)
}
