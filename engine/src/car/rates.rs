//! Derivatives of a state with respect to accelerations, loads on the body, motions of the body and warp of the ground.

use super::Car;
use super::equations::{BODY, Balance, HELD_ROWS, PITCH, ROLL_MOMENT, UNKNOWNS};
use super::parameters::{BodyParameter, Parameter, Parameters};
use super::solver::Base;
use super::tangent::{Matrix, held, inverse, tangent};
use crate::axle::WheelParts;
use crate::number::{Dual, Each, Jet, Real, Scalar, array_of};

/// A state with its derivatives. All results are computed from these numbers.
#[derive(Clone, Debug)]
pub struct Solved<'c, T> {
    /// The car whose state this is.
    pub car: &'c Car,
    /// State without derivatives.
    pub now: Balance<T>,
    /// State with its derivative with respect to ay, per g.
    pub by_ay: Balance<Jet<T, 2>>,
    /// State with its derivative with respect to ax, per g.
    pub by_ax: Balance<Jet<T, 2>>,
    /// State with its derivative with respect to a couple on the body, about the forward direction along the ground.
    pub by_couple: Balance<Jet<T, 2>>,
    /// State with its derivative with respect to the ground height gamma. Roll, pitch and the tyre force factors A and B
    /// of equation (3) of [`super`] are held.
    pub by_heave: Balance<Jet<T, 2>>,
    /// State with its derivative with respect to the pitch theta. The ground height, roll and the tyre force factors A
    /// and B are held.
    pub by_pitch: Balance<Jet<T, 2>>,
    /// State with its derivative with respect to a warp of the ground. The body is free.
    pub by_warp: Balance<Jet<T, 2>>,
    /// Heave of the car at rest with the same type of tyres (rigid or elastic). NaN if it is not computed.
    pub rest_heave: f64,
}

/// Values without derivatives from which a state's derivatives are computed.
#[derive(Clone, Debug)]
pub(super) struct Plain {
    pub unknowns: [f64; UNKNOWNS],
    /// Inverse of the tangent: the matrix of derivatives of the equations with respect to the unknowns.
    pub inverse: Matrix,
    /// Inverse of the tangent of [`held`], in which the body and the tyre force factors are held.
    held_inverse: Matrix,
    /// Derivatives of the unknowns along each of the [`DIRECTIONS`].
    rates: [[f64; UNKNOWNS]; DIRECTIONS.len()],
}

/// Direction in which a state is differentiated.
#[derive(Clone, Copy, Debug)]
enum Direction {
    Parameter(BodyParameter),
    Couple,
    /// Motion of the body. The field is the index in [`HELD_ROWS`].
    Body(usize),
}

/// Parameters that occur in [`DIRECTIONS`], in the same order.
const PARAMETERS: [BodyParameter; 3] = [BodyParameter::Ay, BodyParameter::Ax, BodyParameter::Warp];

const DIRECTIONS: [Direction; 6] = [
    Direction::Parameter(BodyParameter::Ay),
    Direction::Parameter(BodyParameter::Ax),
    Direction::Couple,
    Direction::Body(0),
    Direction::Body(2),
    Direction::Parameter(BodyParameter::Warp),
];

impl Plain {
    /// Computes the values that the computation of a state's derivatives needs. `None` if the equations are singular.
    pub(super) fn of<R: WheelParts<f64>>(
        base: &Base<'_, '_, R>,
        parameters: &Parameters<f64>,
        unknowns: [f64; UNKNOWNS],
    ) -> Option<Self> {
        let (_, tangent) = tangent(base, parameters, &unknowns);
        let held = held(&tangent);
        let mut plain = Plain {
            unknowns,
            inverse: inverse(&tangent)?,
            held_inverse: inverse(&held)?,
            rates: [[0.0; UNKNOWNS]; DIRECTIONS.len()],
        };
        let mut by_parameters = by_parameters(base, parameters, &unknowns).into_iter();
        for (number, direction) in DIRECTIONS.into_iter().enumerate() {
            let mut right = [0.0; UNKNOWNS];
            let (matrix, inverse) = match direction {
                Direction::Parameter(_) => {
                    right = by_parameters.next().unwrap_or(right).each(|row| -row);
                    (&tangent, &plain.inverse)
                }
                Direction::Couple => {
                    right[ROLL_MOMENT] = -unknowns[PITCH].cos();
                    (&tangent, &plain.inverse)
                }
                Direction::Body(place) => {
                    right[BODY + HELD_ROWS[place]] = 1.0;
                    (&held, &plain.held_inverse)
                }
            };
            let mut rates = times(inverse, right);
            // One correction step removes the rounding error of the inverse.
            let product = times(matrix, rates);
            let defect = array_of(|k| right[k] - product[k]);
            for (rate, step) in rates.iter_mut().zip(times(inverse, defect)) {
                *rate += step;
            }
            plain.rates[number] = rates;
        }
        Some(plain)
    }
}

/// Returns the derivatives of the residuals with respect to [`PARAMETERS`], in this order.
fn by_parameters<R: WheelParts<f64>>(
    base: &Base<'_, '_, R>,
    parameters: &Parameters<f64>,
    unknowns: &[f64; UNKNOWNS],
) -> [[f64; UNKNOWNS]; PARAMETERS.len()] {
    let mut moved = parameters.map(Dual::<f64, { PARAMETERS.len() }>::constant);
    for (number, parameter) in PARAMETERS.into_iter().enumerate() {
        moved.0[Parameter::Body(parameter).place()].partials[number] = 1.0;
    }
    let still = unknowns.each(Dual::constant);
    let residuals = base.residuals(&moved, still, Dual::constant);
    array_of(|number| residuals.each(|row| row.partials[number]))
}

impl Direction {
    /// Returns the parameters with their derivatives in this direction.
    fn moving<T: Real>(self, parameters: &Parameters<T>) -> Parameters<Jet<T, 2>> {
        let mut moved = parameters.map(Jet::constant);
        if let Direction::Parameter(parameter) = self {
            let number = &mut moved.0[Parameter::Body(parameter).place()];
            number.0[1] = number.0[0].one();
        }
        moved
    }

    /// Returns the errors in the derivatives of the equations in this direction. `rates` are the derivatives of the
    /// residuals. `level` is the work of a unit couple about the forward direction of the ground, per roll angle.
    fn defect<T: Real>(self, mut rates: [T; UNKNOWNS], level: T) -> [T; UNKNOWNS] {
        match self {
            Direction::Parameter(_) => {}
            Direction::Couple => rates[ROLL_MOMENT] = rates[ROLL_MOMENT] + level,
            // If a motion of the body is prescribed, it replaces the equations of the whole car.
            Direction::Body(_) => rates[BODY..].fill(level.zero()),
        }
        rates
    }
}

/// Product of a matrix without derivatives and a vector.
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

/// Corrects the unknowns by Newton steps. If numbers carry gradients, one step adds the gradient of the unknowns, by
/// equation (10). For Taylor series, each step adds one order.
pub(super) fn settle<T: Scalar, U: Real, R: WheelParts<U>>(
    base: &Base<'_, '_, R>,
    parameters: &Parameters<T>,
    plain: &Plain,
    lift: impl Fn(U) -> T + Copy,
    steps: usize,
) -> [T; UNKNOWNS] {
    let mut x = plain.unknowns.each(|c| parameters.0[0].constant(c));
    for _ in 0..steps {
        let residuals = base.residuals(parameters, x, lift);
        for (unknown, step) in x.iter_mut().zip(times(&plain.inverse, residuals)) {
            *unknown = *unknown - step;
        }
    }
    x
}

impl<'c> Solved<'c, f64> {
    /// Computes a state with all its derivatives; `None` if the equations are singular.
    pub(super) fn at<R: WheelParts<f64>>(
        car: &'c Car,
        base: &Base<'_, '_, R>,
        parameters: &Parameters<f64>,
        unknowns: [f64; UNKNOWNS],
    ) -> Option<Self> {
        let plain = Plain::of(base, parameters, unknowns)?;
        Some(Solved::of(car, base, parameters, &plain, |c: f64| c, 0))
    }
}

impl<'c, T: Scalar> Solved<'c, T> {
    /// Computes the state with all its derivatives, from the values `plain`. `orders` is the number of derivative
    /// orders of the number type: 0 for plain numbers, 1 for gradients, 2 for Taylor series.
    pub(super) fn of<U: Real, R: WheelParts<U>>(
        car: &'c Car,
        base: &Base<'_, '_, R>,
        parameters: &Parameters<T>,
        plain: &Plain,
        lift: impl Fn(U) -> T + Copy,
        orders: usize,
    ) -> Self {
        let x = settle(base, parameters, plain, lift, orders.max(1));
        let along = |number: usize| {
            let direction = DIRECTIONS[number];
            let moved = direction.moving(parameters);
            let lifted = move |c: U| Jet::<T, 2>::constant(lift(c));
            let evaluate = |rates: [T; UNKNOWNS]| {
                let mut series = x.each(Jet::<T, 2>::constant);
                for (series, rate) in series.iter_mut().zip(rates) {
                    series.0[1] = rate;
                }
                base.balance(&moved, series, lifted)
            };
            let mut rates = plain.rates[number].each(|c| x[0].constant(c));
            if !T::IS_LARGE {
                return evaluate(rates);
            }
            let inverse = match direction {
                Direction::Parameter(_) | Direction::Couple => &plain.inverse,
                Direction::Body(_) => &plain.held_inverse,
            };
            // Each further step adds one order of the derivatives.
            for _ in 0..orders {
                let state = evaluate(rates);
                let level = state.road.forward.x[0];
                let defect = direction.defect(state.residuals.each(|row| row[1]), level);
                for (rate, step) in rates.iter_mut().zip(times(inverse, defect)) {
                    *rate = *rate - step;
                }
            }
            evaluate(rates)
        };
        Solved {
            car,
            now: base.balance(parameters, x, lift),
            by_ay: along(0),
            by_ax: along(1),
            by_couple: along(2),
            by_heave: along(3),
            by_pitch: along(4),
            by_warp: along(5),
            rest_heave: f64::NAN,
        }
    }
}
