//! Exact tangent of the equations of [`super`] (matrix of their derivatives with respect to the unknowns), and its LU
//! factors.

use super::corner::Corner;
use super::equations::{
    BODY, Body, GROUND, Ground, Held, LONGITUDINAL, Loaded, PITCH, Placed, ROLL, SIDE_FORCES,
    Stance, TRAVELS, UNKNOWNS, masses, static_loads,
};
use super::parameters::Parameters;
use super::solver::Base;
use crate::axle::WheelParts;
use crate::linear::lu::Lu;
use crate::number::{Dual, Each, array_of};

pub(super) type Matrix = [[f64; UNKNOWNS]; UNKNOWNS];

/// LU factors of a tangent. Each row of the tangent is divided by its largest entry.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    lu: Lu<f64, UNKNOWNS>,
    scales: [f64; UNKNOWNS],
}

impl Factors {
    /// Factorises a tangent; `None` if it is singular.
    pub(super) fn of(tangent: &Matrix) -> Option<Self> {
        let (matrix, scales) = scaled(tangent);
        let lu = Lu::of(matrix, 1.0)?;
        Some(Factors { lu, scales })
    }

    /// Solves the tangent's equations: returns the change of the unknowns that changes the residuals by `right`.
    pub(super) fn solve(&self, mut right: [f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
        for (residual, scale) in right.iter_mut().zip(self.scales) {
            *residual *= scale;
        }
        self.lu.solve(right)
    }

    /// Inverse of the tangent, from its LU factors.
    pub(super) fn inverse(&self) -> Matrix {
        let mut inverse = self.lu.inverse();
        for row in &mut inverse {
            for (c, scale) in row.iter_mut().zip(self.scales) {
                *c *= scale;
            }
        }
        inverse
    }

    /// Sign of the determinant of the tangent.
    pub(super) fn orientation(&self) -> f64 {
        self.lu.determinant().signum()
    }
}

/// Numbers with derivatives with respect to all unknowns.
type Wide = Dual<f64, UNKNOWNS>;

/// Converts a number with derivatives with respect to a list of unknowns. The result has derivatives with respect to
/// all unknowns.
fn widened<const N: usize>(narrow: Dual<f64, N>, unknowns: [usize; N]) -> Wide {
    let mut wide = Wide {
        value: narrow.value,
        partials: [0.0; UNKNOWNS],
    };
    for (unknown, partial) in unknowns.into_iter().zip(narrow.partials) {
        wide.partials[unknown] = partial;
    }
    wide
}

/// Unknowns on which the pose of a wheel depends: height and attitude of the body, and the wheel's own travel. For a
/// solid axle or twist beam, also the other wheel's travel.
fn unknowns_of<const N: usize>(number: usize) -> [usize; N] {
    let all = [
        ROLL,
        PITCH,
        GROUND,
        TRAVELS + number,
        TRAVELS + (number ^ 1),
    ];
    array_of(|k| all[k])
}

/// State of a wheel on the ground, with derivatives with respect to the first `N` unknowns on which its pose depends.
fn stance<const N: usize>(
    held: &Held<'_>,
    parameters: &Parameters<f64>,
    x: &[f64; UNKNOWNS],
    (number, corner): (usize, &Corner<Dual<f64, 2>>),
    static_load: f64,
) -> Stance<Wide> {
    let parameters = parameters.map(Dual::<f64, N>::constant);
    let corner = corner.map(|c| {
        let mut narrow = Dual::constant(c.value);
        narrow.partials[3..].copy_from_slice(&c.partials[..N - 3]);
        narrow
    });
    let attitude = [ROLL, PITCH, GROUND].each(|k| Dual::input(x[k], k));
    let ground = Ground::of(&parameters, attitude);
    let static_load = Dual::constant(static_load);
    let placed = Placed::of(held, &parameters, number, corner, &ground, static_load);
    let unknowns = unknowns_of(number);
    placed.stance.map(|c| widened(c, unknowns))
}

/// Computes the residuals of the equations and their derivatives with respect to the unknowns. The pose of a wheel
/// depends only on the attitude and on the travels of its axle. So most of the arithmetic uses only four or five
/// derivatives.
pub(super) fn tangent<R: WheelParts<f64>>(
    base: &Base<'_, '_, R>,
    parameters: &Parameters<f64>,
    x: &[f64; UNKNOWNS],
) -> ([f64; UNKNOWNS], Matrix) {
    let held = &base.held;
    let parameters_of_wheels = parameters.map(Dual::<f64, 2>::constant);
    let corners = [0, 1, 2, 3].each(|number: usize| {
        let [own, other] = [number, number ^ 1].each(|wheel| TRAVELS + wheel);
        let travels = [Dual::input(x[own], 0), Dual::input(x[other], 1)];
        base.corner(&parameters_of_wheels, number, travels, Dual::constant)
    });
    let values = corners.each_ref().each(|corner| corner.map(|c| c.value));
    let masses = masses(held.car, parameters, &values);
    let static_loads = static_loads(held.car, parameters, &values, &masses);
    let stances = [0, 1, 2, 3].each(|number: usize| {
        let axle = number / 2;
        let (of, load) = ((number, &corners[number]), static_loads[axle]);
        if base.carriers[axle].is_rigid() {
            stance::<5>(held, parameters, x, of, load)
        } else {
            stance::<4>(held, parameters, x, of, load)
        }
    });
    let attitude: [Dual<f64, 3>; 3] = [ROLL, PITCH, GROUND].each(|k| Dual::input(x[k], k));
    let parameters_of_body = parameters.map(Dual::<f64, 3>::constant);
    let ground = Ground::of(&parameters_of_body, attitude);
    let (mass, cg) = masses.sprung;
    let sprung = (Dual::constant(mass), cg.map(Dual::constant));
    let body = Body::of(held, &parameters_of_body, &ground, sprung);
    let wide = |c: Dual<f64, 3>| widened(c, [ROLL, PITCH, GROUND]);
    let unknowns: [Wide; UNKNOWNS] = array_of(|k| Wide::input(x[k], k));
    let parameters = parameters.map(Wide::constant);
    let wheels = stances.each_ref();
    let of = (wheels, &body.resultant.map(wide));
    let loaded = Loaded::of(held, &parameters, &ground.road.map(wide), of, &unknowns);
    (
        loaded.residuals.each(|row| row.value),
        loaded.residuals.each(|row| row.partials),
    )
}

/// Divides each row of a matrix by its largest entry. Returns the scaled matrix and the factors of the rows.
fn scaled(matrix: &Matrix) -> (Matrix, [f64; UNKNOWNS]) {
    let scales = matrix.each(|row| 1.0 / row.iter().fold(0.0_f64, |m, c| m.max(c.abs())));
    let mut scaled = *matrix;
    for (row, scale) in scaled.iter_mut().zip(scales) {
        row.iter_mut().for_each(|c| *c *= scale);
    }
    (scaled, scales)
}

/// Inverse of a matrix; `None` if it is singular.
pub(super) fn inverse(matrix: &Matrix) -> Option<Matrix> {
    Some(Factors::of(matrix)?.inverse())
}

/// Indices of the unknowns that stay fixed in motions of the body: height and attitude, and the factors A and B of the
/// tyre forces.
pub(super) const HELD: [usize; 6] = [
    ROLL,
    PITCH,
    GROUND,
    SIDE_FORCES,
    SIDE_FORCES + 1,
    LONGITUDINAL,
];

/// Tangent with the rows from [`BODY`] on replaced: these are the equations of the whole car. Each new row keeps one unknown
/// constant. The unknowns are those in [`HELD`], in its order.
pub(super) fn held(tangent: &Matrix) -> Matrix {
    let mut matrix = *tangent;
    for (row, unknown) in matrix[BODY..].iter_mut().zip(HELD) {
        row.fill(0.0);
        row[unknown] = 1.0;
    }
    matrix
}
