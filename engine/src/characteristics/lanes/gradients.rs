//! Gradients of quantities with respect to the hardpoints, for several poses at once (one in each SIMD lane). The
//! formulas give derivatives with respect to the pose. As seeds of the adjoint, these give the gradients.

use super::{LaneInputs, LaneReader, LaneWheels};
use crate::characteristics::gains::{angle_of_gain, by_direction, by_direction_along};
use crate::characteristics::{Characteristic, Inputs, Quantity, Slot};
use crate::derive::{Gradient, Seeds};
use crate::mechanism::Configuration;
use crate::model::{Axis, PointId, SteeringAxis};
use crate::number::{Jet, MOST_LANES, Outlined, SimdReal, Vector3};

impl LaneReader<'_> {
    /// Returns true if the derivatives with respect to the hardpoints can be computed in SIMD lanes. This is not possible with
    /// an instantaneous steering axis, or for quantities that contain velocities of springs and rockers.
    pub fn has_gradients(&self) -> bool {
        let instantaneous = self.mechanism.steering_axis == Some(SteeringAxis::Instantaneous);
        let can_be_had = |q: &Quantity| {
            let is_of_wheel = |slot: &Slot| !slot.may_turn() && *slot != Slot::StrutUpper;
            q.rate_order() == 0 || q.reads().iter().all(is_of_wheel)
        };
        self.quantities.iter().all(can_be_had)
            && !(self.slots.contain_steering_axis() && instantaneous)
    }

    /// Returns true if the quantity with this index contains velocities, so that [`LaneReader::differentiate_rates`]
    /// applies.
    #[inline(always)]
    pub fn is_of_rates(&self, number: usize) -> bool {
        self.of_rates[number]
    }

    /// Differentiates a quantity y(u, u') that contains velocities. u are the inputs of its formula, and u' their derivatives with
    /// respect to the travel. The configuration is a series in the travel, with the variable e. Coefficient 1 of the adjoint's
    /// result is the gradient with respect to the hardpoints p.
    ///
    /// Let h and g be the derivatives of y with respect to u and u'. Let u_p be the derivative of u with respect to p. Take the
    /// seed S = g + h e with constant g and h. Then dy/dp = h.u_p + g.u_p' is coefficient 1 of the series S.u_p.
    #[inline(always)]
    pub fn differentiate_rates<B: SimdReal, G: Gradient<Jet<B, 2>> + ?Sized>(
        &self,
        number: usize,
        weight: B,
        read: &LaneInputs<B>,
        at: &Configuration<'_, Jet<B, 2>>,
        seeds: &mut Seeds<'_, '_, Jet<B, 2>, G>,
    ) {
        weight.outlined(SeedingRates {
            quantity: self.quantities[number],
            weight,
            inputs: &read.inputs,
            at,
            seeds,
        });
    }

    /// Adds `weight` times the derivative of an angle with respect to the direction that it reads (spin axis or steering axis).
    /// Returns false if the quantity with this index is not camber, toe, caster or kingpin inclination. Then use
    /// [`LaneReader::differentiate`].
    #[inline(always)]
    pub fn add_by_directions<B: SimdReal>(
        &self,
        number: usize,
        weight: B,
        read: &LaneInputs<B>,
        by: &mut ByDirections<B>,
    ) -> bool {
        let Quantity::Characteristic(angle) = self.quantities[number] else {
            return false;
        };
        let Some(gradient) = by_direction(angle, &read.inputs) else {
            return false;
        };
        let sum = match angle.info().reads {
            [Slot::SpinAxis] => &mut by.spin_axis,
            _ => &mut by.steering_axis,
        };
        let before = sum.unwrap_or(gradient.zero());
        *sum = Some(before.plus_scaled(gradient, weight));
        true
    }

    /// Adds seeds for a quantity: `weight` times its derivatives with respect to the configuration from which the quantity was
    /// read. For camber, toe, caster and kingpin inclination, use [`LaneReader::add_by_directions`] instead.
    #[inline(always)]
    pub fn differentiate<B: SimdReal, G: Gradient<B> + ?Sized>(
        &self,
        number: usize,
        weight: B,
        read: &LaneInputs<B>,
        at: &Configuration<'_, B>,
        seeds: &mut Seeds<'_, '_, B, G>,
    ) {
        match self.quantities[number] {
            Quantity::Characteristic(c) => weight.outlined(Seeding {
                characteristic: c,
                weight,
                inputs: &read.inputs,
                at,
                seeds,
            }),
            Quantity::Coordinate(id, axis) => weight.outlined(SeedingPoint {
                id,
                axis,
                weight,
                seeds,
            }),
            // An angular velocity has a separate seed.
            Quantity::AngularVelocity(_) => {}
        }
    }
}

/// Derivatives with respect to the two directions that angles read: spin axis and steering axis. `None` for a direction that no
/// angle reads.
#[derive(Clone, Copy, Debug)]
pub struct ByDirections<B> {
    spin_axis: Option<Vector3<B>>,
    steering_axis: Option<Vector3<B>>,
}

impl<B> Default for ByDirections<B> {
    fn default() -> Self {
        ByDirections {
            spin_axis: None,
            steering_axis: None,
        }
    }
}

impl<B: SimdReal> ByDirections<B> {
    /// Adds the derivatives as seeds of the adjoint, at the configuration from which the inputs were read.
    #[inline(always)]
    pub fn seed<G: Gradient<B> + ?Sized>(
        &self,
        wheels: &LaneWheels<B>,
        read: &LaneInputs<B>,
        seeds: &mut Seeds<'_, '_, B, G>,
    ) {
        if let Some(gradient) = self.spin_axis {
            seeds.moved_spin_axis(
                &wheels.designed_spin_axis,
                read.inputs.now.spin_axis,
                gradient,
            );
        }
        if let Some(gradient) = self.steering_axis {
            seeds.steering_axis(gradient.zero(), gradient);
        }
    }
}

/// Task that seeds an adjoint with the inputs of a characteristic.
struct Seeding<'i, 'c, 's, 'a, B, G: ?Sized> {
    characteristic: Characteristic,
    weight: B,
    inputs: &'i Inputs<B>,
    at: &'i Configuration<'c, B>,
    seeds: &'i mut Seeds<'s, 'a, B, G>,
}

impl<B: SimdReal, G: Gradient<B> + ?Sized> Outlined for Seeding<'_, '_, '_, '_, B, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let by_slot = gradient(self.characteristic, self.inputs);
        for (slot, by) in self.characteristic.info().reads.iter().zip(by_slot) {
            slot.push(by * self.weight, self.at, self.seeds);
        }
    }
}

/// Task that seeds an adjoint along the travel with the inputs of a quantity that contains velocities.
struct SeedingRates<'i, 'c, 's, 'a, B, G: ?Sized> {
    quantity: Quantity,
    weight: B,
    inputs: &'i Inputs<B>,
    at: &'i Configuration<'c, Jet<B, 2>>,
    seeds: &'i mut Seeds<'s, 'a, Jet<B, 2>, G>,
}

impl<B: SimdReal, G: Gradient<Jet<B, 2>> + ?Sized> Outlined for SeedingRates<'_, '_, '_, '_, B, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let zero = self.weight.zero();
        if let Quantity::Characteristic(c) = self.quantity
            && let Some(angle) = angle_of_gain(c)
            && let Some(by) = by_direction_along(angle, self.inputs)
        {
            // The gain is the slope of the angle along the travel, because the travel is the rise of the wheel centre.
            for slot in angle.info().reads {
                slot.push(by * Jet::constant(self.weight), self.at, self.seeds);
            }
            return;
        }
        let mut by_slot = [Vector3::new(zero, zero, zero); Slot::MOST];
        match self.quantity {
            Quantity::Characteristic(c) => by_slot = gradient(c, self.inputs),
            Quantity::AngularVelocity(axis) => by_slot[0][axis] = zero.one(),
            Quantity::Coordinate(..) => {}
        }
        for by in &mut by_slot {
            *by = *by * self.weight;
        }
        Slot::push_rates(
            self.quantity.reads(),
            &by_slot,
            self.inputs.turn,
            #[inline(always)]
            |h| h.zero().with_rate(h),
            #[inline(always)]
            |g| g.with_rate(g.zero()),
            self.at,
            self.seeds,
        );
    }
}

/// Derivatives of a characteristic with respect to the slots that it reads, lane by lane. A single SIMD function of all
/// formulas over dual numbers would take too long to compile.
#[inline(always)]
fn gradient<B: SimdReal>(c: Characteristic, inputs: &Inputs<B>) -> [Vector3<B>; Slot::MOST] {
    let mut lanes = [[[0.0; MOST_LANES]; 3]; Slot::MOST];
    for lane in 0..B::LANES {
        let inputs = inputs.only(
            c.info().reads,
            f64::NAN,
            #[inline(always)]
            |number: B| number.in_lane(lane),
        );
        let gradient = c.gradient(&inputs);
        for (slot, by) in lanes.iter_mut().zip(gradient) {
            slot[0][lane] = by.x;
            slot[1][lane] = by.y;
            slot[2][lane] = by.z;
        }
    }
    let like = inputs.turn.x;
    let mut gradient = [inputs.turn; Slot::MOST];
    for (by, [x, y, z]) in gradient.iter_mut().zip(&lanes) {
        *by = Vector3::new(like.load(x), like.load(y), like.load(z));
    }
    gradient
}

/// Task that seeds an adjoint with a coordinate of a point.
struct SeedingPoint<'i, 's, 'a, B, G: ?Sized> {
    id: PointId,
    axis: Axis,
    weight: B,
    seeds: &'i mut Seeds<'s, 'a, B, G>,
}

impl<B: SimdReal, G: Gradient<B> + ?Sized> Outlined for SeedingPoint<'_, '_, '_, B, G> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        let zero = self.weight.zero();
        let mut along = Vector3::new(zero, zero, zero);
        along[self.axis] = self.weight;
        self.seeds.point(self.id, along);
    }
}
