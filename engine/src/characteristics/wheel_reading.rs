//! Reads values along the motion, and their gradients with respect to the hardpoints, from a pose.

use super::{Characteristic, Constants, Gradient, Inputs, Quantity, Slot, Slots};
use crate::derive::{Linearised, Seeds};
use crate::mechanism::Configuration;
use crate::model::{Axis, PointId};
use crate::number::{Jet, Real, Vector3, array_of};

/// Inputs of formulas, read from a pose as series with `N` coefficients. The values are computed from these inputs.
pub struct WheelReading<const N: usize> {
    inputs: Inputs<Jet<f64, N>>,
}

/// Returns a vector with the component `value` along `axis`. The other components are zero.
#[inline]
fn along<T: Real>(axis: Axis, value: T) -> Vector3<T> {
    let zero = value.zero();
    let mut vector = Vector3::new(zero, zero, zero);
    vector[axis] = value;
    vector
}

impl<const N: usize> WheelReading<N> {
    /// Reads wheel and steering axis from a configuration. `constants` are the constants of the suspension.
    #[inline]
    pub fn of(at: &Configuration<Jet<f64, N>>, constants: Constants) -> Self {
        WheelReading::reading(at, constants, Slots::ALL)
    }

    /// Reads only these slots of a configuration. All other slots are NaN. [`WheelReading::of`] reads all slots.
    pub fn reading(at: &Configuration<Jet<f64, N>>, constants: Constants, slots: Slots) -> Self {
        let nothing = Jet([f64::NAN; N]);
        let mut inputs = Inputs::of_configuration(at, nothing, constants, slots);
        if N > 1 {
            inputs.rate = inputs.now.map(Jet::differentiated);
            if slots.contains(Slot::Turn) {
                inputs.turn = at.angular_velocity();
            }
        }
        WheelReading { inputs }
    }

    /// Value of a quantity as a series along the motion. The last [`Quantity::rate_order`] coefficients are unknown.
    #[inline]
    pub fn value(&self, at: &Configuration<Jet<f64, N>>, quantity: Quantity) -> Jet<f64, N> {
        match quantity {
            Quantity::Characteristic(c) => self.characteristic(c),
            Quantity::Coordinate(point, axis) => at.point(point)[axis],
            Quantity::AngularVelocity(axis) => self.inputs.turn[axis],
        }
    }

    /// Inputs of formulas.
    pub(super) fn inputs(&self) -> &Inputs<Jet<f64, N>> {
        &self.inputs
    }

    /// Contact point along the series. [`Slot::SpinAxis`] and [`Slot::Centre`] must have been read.
    pub fn contact_point(&self) -> Vector3<Jet<f64, N>> {
        self.inputs.contact_point()
    }

    /// Value of a characteristic as a series along the motion. Its last coefficients are unknown if it contains velocities.
    #[inline]
    pub fn characteristic(&self, c: Characteristic) -> Jet<f64, N> {
        c.evaluate(&self.inputs)
    }

    /// Computes gradients of a quantity with respect to every hardpoint coordinate. Also computes the gradients of its
    /// derivatives with respect to the drive coordinate, up to the order `highest`. `buffer` has one entry per point.
    /// `receive` gets the order, the point and the gradient, for every order and point.
    #[inline]
    pub fn gradients(
        &self,
        linearised: &Linearised<'_, N>,
        quantity: Quantity,
        highest: usize,
        buffer: &mut [Vector3<Jet<f64, N>>],
        receive: &mut dyn FnMut(usize, PointId, Vector3<f64>),
    ) {
        let zero = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        let mut gradient = [zero; Slot::MOST];
        match quantity {
            Quantity::Characteristic(c) => gradient = c.gradient(&self.inputs),
            Quantity::AngularVelocity(axis) => gradient[0] = along(axis, Jet::constant(1.0)),
            Quantity::Coordinate(..) => {}
        }
        if quantity.rate_order() > 0 {
            let slots = quantity.reads();
            return self.rate_gradients(linearised, slots, gradient, highest, buffer, receive);
        }
        buffer.fill(zero);
        linearised.gradient(buffer, |seeds: &mut Seeds<'_, '_, _>| {
            if let Quantity::Coordinate(point, axis) = quantity {
                seeds.point(point, along(axis, Jet::constant(1.0)));
            }
            for (slot, seed) in quantity.reads().iter().zip(gradient) {
                slot.push(seed, &linearised.at, seeds);
            }
        });
        each_derivative(buffer, highest, receive);
    }

    /// Gradients of a quantity that contains velocities, from its derivatives with respect to the inputs that it reads.
    fn rate_gradients(
        &self,
        linearised: &Linearised<'_, N>,
        slots: &[Slot],
        gradient: Gradient<Jet<f64, N>>,
        highest: usize,
        buffer: &mut [Vector3<Jet<f64, N>>],
        receive: &mut dyn FnMut(usize, PointId, Vector3<f64>),
    ) {
        let (turn, at) = (self.inputs.turn, &linearised.at);
        for order in 0..=highest {
            let shifted = |h: Jet<f64, N>| Jet(array_of(|i| if i == 0 { 0.0 } else { h[i - 1] }));
            let by_rate =
                |g: Jet<f64, N>| Jet(array_of(|i| g[i] * (order as f64 + 1.0 - i as f64)));
            buffer.fill(Vector3::new(0.0, 0.0, 0.0).map(Jet::constant));
            linearised.gradient(buffer, |seeds: &mut Seeds<'_, '_, _>| {
                let shifted = |h: Vector3<_>| h.map(shifted);
                let by_rate = |g: Vector3<_>| g.map(by_rate);
                Slot::push_rates(slots, &gradient, turn, shifted, by_rate, at, seeds);
            });
            // Coefficient j+1 of the series gives the j-th derivative of the quantity, after multiplication by j!.
            let share = 1.0 / (order + 1) as f64;
            for (point, series) in buffer.iter().enumerate() {
                let gradient = series.map(|c| c.derivative(order + 1) * share);
                receive(order, PointId(point), gradient);
            }
        }
    }
}

/// Passes the derivatives of gradients with respect to the drive coordinate to `receive`, up to the order `highest`.
/// `buffer` has one gradient per point.
pub(super) fn each_derivative<const N: usize>(
    buffer: &[Vector3<Jet<f64, N>>],
    highest: usize,
    receive: &mut dyn FnMut(usize, PointId, Vector3<f64>),
) {
    for order in 0..=highest {
        for (point, series) in buffer.iter().enumerate() {
            receive(order, PointId(point), series.map(|c| c.derivative(order)));
        }
    }
}
