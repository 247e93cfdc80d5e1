//! A state with its derivatives along directions: by accelerations of the car and by motions of the body.

use super::Car;
use super::equations::{BODY, Balance, HELD_ROWS, UNKNOWNS};
use super::parameters::{BodyParameter, Parameter, Parameters};
use super::solver::{Base, Matrix, held_inverse, inverse, tangent};
use crate::axle::{Reading, WheelParts};
use crate::number::{Jet, Real, Scalar};

/// A state with its derivatives. Values of results are made of it.
#[derive(Clone, Debug)]
pub struct Solved<'c, T> {
    /// The car.
    pub car: &'c Car,
    /// The state.
    pub now: Balance<T>,
    /// The state along ay, per g.
    pub by_ay: Balance<Jet<T, 2>>,
    /// The state along ax, per g.
    pub by_ax: Balance<Jet<T, 2>>,
    /// The state along (gamma, phi, theta) of the body, the forces along the ground held.
    pub by_body: [Balance<Jet<T, 2>>; 3],
}

/// The plain numbers of a state that its derivatives are made with.
#[derive(Clone, Debug)]
pub(super) struct Plain {
    pub unknowns: [f64; UNKNOWNS],
    /// Inverse of the tangent, and of the tangent with the body held.
    pub inverse: Matrix,
    pub held_inverse: Matrix,
    /// Derivatives of the unknowns along ay, ax, gamma, phi, theta.
    pub rates: [[f64; UNKNOWNS]; 5],
}

/// The parameter that each direction changes.
const DIRECTIONS: [Option<Parameter>; 5] = [
    Some(Parameter::Body(BodyParameter::Ay)),
    Some(Parameter::Body(BodyParameter::Ax)),
    None,
    None,
    None,
];

impl Plain {
    /// `None` where the equations are singular.
    pub(super) fn of(
        base: &Base<'_, '_, Reading<f64>>,
        parameters: &Parameters<f64>,
        unknowns: [f64; UNKNOWNS],
    ) -> Option<Self> {
        let (_, tangent) = tangent(base, parameters, &unknowns);
        let (inverse, held_inverse) = (inverse(&tangent)?, held_inverse(&tangent)?);
        let mut rates = [[0.0; UNKNOWNS]; 5];
        for (rate, parameter) in rates.iter_mut().zip(DIRECTIONS) {
            if let Some(parameter) = parameter {
                let moved = moving(parameters, Some(parameter));
                let still = unknowns.map(Jet::constant);
                let balance = base.balance(&moved, still, |c: f64| Jet::constant(c));
                *rate = times(&inverse, balance.residuals.map(|row: Jet<f64, 2>| -row[1]));
            }
        }
        for (rate, column) in rates[2..].iter_mut().zip(HELD_ROWS) {
            *rate = std::array::from_fn(|k| held_inverse[k][BODY + column]);
        }
        Some(Plain {
            unknowns,
            inverse,
            held_inverse,
            rates,
        })
    }
}

/// The parameters along a direction.
fn moving<T: Real>(
    parameters: &Parameters<T>,
    direction: Option<Parameter>,
) -> Parameters<Jet<T, 2>> {
    let mut moved = parameters.map(Jet::constant);
    if let Some(parameter) = direction {
        let number = &mut moved.0[parameter.place()];
        number.0[1] = number.0[0].one();
    }
    moved
}

/// A matrix of plain numbers times a vector.
fn times<T: Real>(matrix: &Matrix, vector: [T; UNKNOWNS]) -> [T; UNKNOWNS] {
    let mut product = [vector[0].zero(); UNKNOWNS];
    for (sum, row) in product.iter_mut().zip(matrix) {
        for (factor, c) in row.iter().zip(vector) {
            if *factor != 0.0 {
                *sum = *sum + c.scaled(*factor);
            }
        }
    }
    product
}

/// The unknowns with one Newton step. For numbers that carry gradients it adds the gradient of the unknowns (10).
pub(super) fn settle<T: Scalar, U: Real, R: WheelParts<U>>(
    base: &Base<'_, '_, R>,
    parameters: &Parameters<T>,
    plain: &Plain,
    lift: impl Fn(U) -> T + Copy,
) -> [T; UNKNOWNS] {
    let mut x = plain.unknowns.map(|c| parameters.0[0].lit(c));
    let residuals = base.balance(parameters, x, lift).residuals;
    for (unknown, step) in x.iter_mut().zip(times(&plain.inverse, residuals)) {
        *unknown = *unknown - step;
    }
    x
}

impl<'c, T: Scalar> Solved<'c, T> {
    /// The state near plain numbers with all its derivatives.
    pub(super) fn of<U: Real, R: WheelParts<U>>(
        base: &Base<'c, '_, R>,
        parameters: &Parameters<T>,
        plain: &Plain,
        lift: impl Fn(U) -> T + Copy,
    ) -> Self {
        let x = settle(base, parameters, plain, lift);
        let along = |number: usize| {
            let moved = moving(parameters, DIRECTIONS[number]);
            let lifted = move |c: U| Jet::<T, 2>::constant(lift(c));
            let evaluate = |rates: [T; UNKNOWNS]| {
                let mut series = x.map(Jet::<T, 2>::constant);
                for (series, rate) in series.iter_mut().zip(rates) {
                    series.0[1] = rate;
                }
                base.balance(&moved, series, lifted)
            };
            let mut rates = plain.rates[number].map(|c| x[0].lit(c));
            let mut residuals = evaluate(rates).residuals.map(|row: Jet<T, 2>| row[1]);
            let inverse = match DIRECTIONS[number] {
                Some(_) => &plain.inverse,
                None => {
                    // The body moves as it is told.
                    residuals[BODY..].fill(x[0].zero());
                    &plain.held_inverse
                }
            };
            for (rate, step) in rates.iter_mut().zip(times(inverse, residuals)) {
                *rate = *rate - step;
            }
            evaluate(rates)
        };
        Solved {
            car: base.held.car,
            now: base.balance(parameters, x, lift),
            by_ay: along(0),
            by_ax: along(1),
            by_body: [along(2), along(3), along(4)],
        }
    }
}
