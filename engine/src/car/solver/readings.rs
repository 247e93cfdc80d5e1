//! Wheels in a state, computed from poses or from curves.

use super::super::corner::{Corner, Steps};
use super::super::equations::{Balance, Held, TRAVELS, UNKNOWNS, residuals};
use super::super::parameters::{AxleParameter, Parameters};
use super::super::tangent::{Matrix, tangent};
use crate::axle::{AxlePose, Carriers, CurveWheel, Read, Reading, WheelParts};
use crate::model::Side;
use crate::number::{Each, Real, Scalar};

/// Values of the wheels in a state, during the iteration towards equilibrium.
pub(in crate::car) enum Wheels<'a> {
    /// Values that were computed from the wheels' curves.
    Near(Box<OnCurves>),
    /// Values that were computed from poses.
    Exact(Box<Readings<'a>>),
}

/// Values of the wheels, computed from their curves.
#[derive(Clone, Debug)]
pub(in crate::car) struct OnCurves {
    pub wheels: [CurveWheel; 4],
    pub travels: [f64; 4],
}

impl Default for OnCurves {
    fn default() -> Self {
        OnCurves {
            wheels: [CurveWheel::unknown(); 4],
            travels: [f64::NAN; 4],
        }
    }
}

impl OnCurves {
    /// Returns the inputs from which nearby states are computed.
    #[inline]
    pub(in crate::car) fn base<'h>(&self, held: Held<'h>) -> Base<'h, '_, CurveWheel> {
        Base {
            held,
            racks: None,
            carriers: [Carriers::Independent; 2],
            readings: self.wheels.each_ref(),
            travels: self.travels,
        }
    }
}

impl Wheels<'_> {
    /// Computes a state with its forces.
    pub(in crate::car) fn balance(
        &self,
        held: Held<'_>,
        parameters: &Parameters<f64>,
        x: [f64; UNKNOWNS],
    ) -> Balance<f64> {
        match self {
            Wheels::Near(near) => near.base(held).balance(parameters, x, |c: f64| c),
            Wheels::Exact(exact) => exact.base(held).balance(parameters, x, |c: f64| c),
        }
    }

    /// Computes the residuals of the equations.
    pub(in crate::car) fn residuals(
        &self,
        held: Held<'_>,
        parameters: &Parameters<f64>,
        x: [f64; UNKNOWNS],
    ) -> [f64; UNKNOWNS] {
        match self {
            Wheels::Near(near) => near.base(held).residuals(parameters, x, |c: f64| c),
            Wheels::Exact(exact) => exact.base(held).residuals(parameters, x, |c: f64| c),
        }
    }

    /// Computes the residuals of the equations, and their derivatives with respect to the unknowns.
    pub(in crate::car) fn tangent(
        &self,
        held: Held<'_>,
        parameters: &Parameters<f64>,
        x: &[f64; UNKNOWNS],
    ) -> ([f64; UNKNOWNS], Matrix) {
        match self {
            Wheels::Near(near) => tangent(&near.base(held), parameters, x),
            Wheels::Exact(exact) => tangent(&exact.base(held), parameters, x),
        }
    }
}

/// Wheels in a state, computed from poses.
pub(in crate::car) struct Readings<'a> {
    pub placed: [AxlePose; 2],
    /// True if the values include the dependence of the wheels on the racks.
    pub by_rack: bool,
    pub axles: [Read<'a>; 2],
}

impl Readings<'_> {
    /// Returns the wheels in this order: front left, front right, rear left, rear right.
    #[inline]
    pub(in crate::car) fn wheels(&self) -> [&Reading<f64>; 4] {
        let [front, rear] = &self.axles;
        let ([a, b], [c, d]) = (&front.state.readings, &rear.state.readings);
        [a, b, c, d]
    }

    /// Returns the inputs from which nearby states are computed.
    #[inline]
    pub(in crate::car) fn base<'h>(&self, held: Held<'h>) -> Base<'h, '_, Reading<f64>> {
        let [front, rear] = &self.placed;
        Base {
            held,
            racks: self.by_rack.then(|| self.placed.each(|placed| placed.rack)),
            carriers: self.axles.each_ref().each(|read| read.state.carriers),
            readings: self.wheels(),
            travels: [
                front.travels[0],
                front.travels[1],
                rear.travels[0],
                rear.travels[1],
            ],
        }
    }
}

/// Inputs from which nearby states are computed, with the wheels at their travels.
pub(in crate::car) struct Base<'h, 'r, R> {
    pub held: Held<'h>,
    /// Wheels in the frames of their sides: front left, front right, rear left, rear right.
    pub readings: [&'r R; 4],
    /// Travels at which the wheels were computed.
    pub travels: [f64; 4],
    /// Racks of both axles; `None` if the wheels do not include the dependence on the racks.
    pub racks: Option<[f64; 2]>,
    /// Type of the wheel carriers of each axle.
    pub carriers: [Carriers; 2],
}

impl<R> Base<'_, '_, R> {
    /// Computes a state with its forces. `lift` converts the wheels' numbers to this number type.
    pub(in crate::car) fn balance<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        x: [T; UNKNOWNS],
        lift: impl Fn(U) -> T + Copy,
    ) -> Balance<T>
    where
        R: WheelParts<U>,
    {
        let corners = self.corners(parameters, &x, lift);
        Balance::of(&self.held, parameters, corners, x)
    }

    /// Computes only the residuals of the equations, without the other results of a state.
    pub(in crate::car) fn residuals<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        x: [T; UNKNOWNS],
        lift: impl Fn(U) -> T + Copy,
    ) -> [T; UNKNOWNS]
    where
        R: WheelParts<U>,
    {
        let corners = self.corners(parameters, &x, lift);
        residuals(&self.held, parameters, corners, &x)
    }

    fn corners<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        x: &[T; UNKNOWNS],
        lift: impl Fn(U) -> T + Copy,
    ) -> [Corner<T>; 4]
    where
        R: WheelParts<U>,
    {
        [0, 1, 2, 3].each(|number: usize| {
            let travels = [number, number ^ 1].each(|wheel| x[TRAVELS + wheel]);
            self.corner(parameters, number, travels, lift)
        })
    }

    /// Computes a wheel at its own travel and the other wheel's travel.
    pub(in crate::car) fn corner<T: Scalar, U: Real>(
        &self,
        parameters: &Parameters<T>,
        number: usize,
        [own, other]: [T; 2],
        lift: impl Fn(U) -> T + Copy,
    ) -> Corner<T>
    where
        R: WheelParts<U>,
    {
        let axle = number / 2;
        let sign = Side::ALL[number % 2].sign();
        let rack = self.racks.map(|racks| {
            let rack = parameters.axle(axle, AxleParameter::Rack);
            (rack - rack.constant(racks[axle])).scaled(sign)
        });
        let steps = Steps {
            own: own - own.constant(self.travels[number]),
            other: other - other.constant(self.travels[number ^ 1]),
            rack,
        };
        Corner::read(
            self.readings[number],
            (sign, self.carriers[axle]),
            parameters.offset(axle),
            steps,
            lift,
        )
    }
}
