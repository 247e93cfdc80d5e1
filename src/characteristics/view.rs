//! What can be read off a pose: values along the motion and gradients by the hardpoints.

use super::gains::angle_of_gain;
use super::{Characteristic, Constants, Gradient, Inputs, Slot, Slots, Wheel};
use crate::derive::{Linearised, Seeds};
use crate::mechanism::Configuration;
use crate::model::{Axis, AxlePosition, Mechanism, PointId, RockerId, Suspension, TorquePath};
use crate::number::{Jet, Real, Vector3};

/// Something that has a value in every pose. In the kernel's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A wheel characteristic.
    Characteristic(Characteristic),
    /// A coordinate of a point.
    Coordinate(PointId, Axis),
    /// A component of the knuckle's angular velocity by the drive. Its first derivative is the angular
    /// acceleration.
    AngularVelocity(Axis),
}

impl Quantity {
    /// Derivatives by the drive that the value itself takes: 1 for what is made of velocities, else 0.
    pub fn rate_order(self) -> usize {
        match self {
            Quantity::Characteristic(c) => c.info().reads_rates() as usize,
            Quantity::Coordinate(..) => 0,
            Quantity::AngularVelocity(_) => 1,
        }
    }

    /// What the value is made of; coordinates are read off the configuration directly.
    pub fn reads(self) -> &'static [Slot] {
        match self {
            Quantity::Characteristic(c) => c.info().reads,
            Quantity::Coordinate(..) => &[],
            Quantity::AngularVelocity(_) => &[Slot::Turn],
        }
    }

    /// The rockers the quantity moves with directly. At a toggle of one of them, or of one that turns it,
    /// the quantity has no value.
    pub fn rockers(self, mechanism: &Mechanism) -> Vec<RockerId> {
        let under = |id: PointId| mechanism.rockers_moving(id).next();
        let of_slot = |slot: &Slot| match slot {
            Slot::Spring | Slot::SpringLength | Slot::SpringLengthRate => {
                let spring = mechanism.spring?;
                under(spring.lower)
            }
            Slot::RockerAngle => mechanism.spring_rocker(),
            Slot::BarAngle | Slot::BarAngleRate => mechanism.anti_roll_bar(),
            _ => None,
        };
        match self {
            Quantity::Coordinate(point, _) => under(point).into_iter().collect(),
            _ => self.reads().iter().filter_map(of_slot).collect(),
        }
    }

    /// Whether the quantity is a derivative by the drive as it stands, so that a change of the drive
    /// changes its value. (Characteristics made of velocities are ratios of them.)
    pub fn is_rate(self) -> bool {
        matches!(self, Quantity::AngularVelocity(_))
    }

    /// Whether the quantity is how an angle changes with travel.
    pub fn is_gain(self) -> bool {
        match self {
            Quantity::Characteristic(c) => angle_of_gain(c).is_some(),
            _ => false,
        }
    }
}

/// A pose, made ready for reading. `N` coefficients of every series are known.
pub struct WheelReading<const N: usize> {
    inputs: Inputs<Jet<f64, N>>,
}

/// The vector with this one component.
#[inline]
fn along<T: Real>(axis: Axis, value: T) -> Vector3<T> {
    let zero = value.zero();
    let mut vector = Vector3::new(zero, zero, zero);
    vector[axis] = value;
    vector
}

impl<const N: usize> WheelReading<N> {
    /// Reads wheel and steering axis off a configuration. `constants` are those of the suspension.
    #[inline]
    pub fn of(at: &Configuration<Jet<f64, N>>, constants: Constants) -> Self {
        WheelReading::reading(at, constants, Slots::ALL)
    }

    /// As [`WheelReading::of`], for quantities that read no more than these slots. The rest is not computed, and
    /// is not a number.
    #[inline]
    pub fn reading(at: &Configuration<Jet<f64, N>>, constants: Constants, slots: Slots) -> Self {
        let mut inputs = Inputs::standing(at, constants, slots);
        if N > 1 {
            let now = &inputs.now;
            let rate = |slot: Slot, of: Vector3<Jet<f64, N>>, unknown| match slots.contains(slot) {
                true => of.map(Jet::differentiated),
                false => unknown,
            };
            let unknown = inputs.rate.centre;
            inputs.rate = Wheel {
                spin_axis: rate(Slot::SpinAxisRate, now.spin_axis, unknown),
                centre: rate(Slot::CentreRate, now.centre, unknown),
                steering_direction: rate(
                    Slot::SteeringDirectionRate,
                    now.steering_direction,
                    unknown,
                ),
                spring_length: match slots.contains(Slot::SpringLengthRate) {
                    true => now.spring_length.differentiated(),
                    false => unknown.x,
                },
                bar_angle: match slots.contains(Slot::BarAngleRate) {
                    true => now.bar_angle.differentiated(),
                    false => unknown.x,
                },
                // No formula reads these.
                spring: unknown,
                rocker_angle: unknown.x,
                steering_point: unknown,
                strut_upper: unknown,
            };
            if slots.contains(Slot::Turn) {
                inputs.turn = at.angular_velocity();
            }
        }
        WheelReading { inputs }
    }

    /// The value along the motion; the last [`Quantity::rate_order`] coefficients are unknown.
    #[inline]
    pub fn value(&self, at: &Configuration<Jet<f64, N>>, quantity: Quantity) -> Jet<f64, N> {
        match quantity {
            Quantity::Characteristic(c) => self.characteristic(c),
            Quantity::Coordinate(point, axis) => at.point(point)[axis],
            Quantity::AngularVelocity(axis) => self.inputs.turn[axis],
        }
    }

    /// What the formulas read.
    pub(super) fn inputs(&self) -> &Inputs<Jet<f64, N>> {
        &self.inputs
    }

    /// The contact point along the series; takes [`Slot::SpinAxis`] and [`Slot::Centre`].
    pub fn contact_point(&self) -> Vector3<Jet<f64, N>> {
        self.inputs.contact_point()
    }

    /// The value of a characteristic, likewise.
    #[inline]
    pub fn characteristic(&self, c: Characteristic) -> Jet<f64, N> {
        c.evaluate(&self.inputs)
    }

    /// The derivatives of a quantity, and of its derivatives by the drive up to `highest`, by every
    /// hardpoint coordinate. `buffer` has a place for each point; `receive` gets every order and point
    /// with the gradient.
    ///
    /// A quantity y(u, u') made of velocities has dy/dp = h.u_p + g.u_p' with h and g its derivatives by
    /// u and u'. An adjoint pass yields the series of S.u_p for any seed series S; with
    /// S_i = h_(i-1) + (j+1-i) g_i its coefficient j+1 is the coefficient j of dy/dp:
    /// sum_n h_(j-n) (u_p)_n + sum_n n g_(j+1-n) (u_p)_n.
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
        match quantity {
            Quantity::Coordinate(point, axis) => {
                buffer.fill(zero);
                linearised.gradient(buffer, |seeds| {
                    seeds.point(point, along(axis, Jet::constant(1.0)));
                });
                for order in 0..=highest {
                    for (point, series) in buffer.iter().enumerate() {
                        receive(order, PointId(point), series.map(|c| c.derivative(order)));
                    }
                }
            }
            Quantity::Characteristic(c) if !c.info().reads_rates() => {
                let gradient = c.gradient(&self.inputs);
                buffer.fill(zero);
                linearised.gradient(buffer, |seeds| {
                    for (slot, seed) in c.info().reads.iter().zip(gradient) {
                        slot.push_apart(seed, &linearised.at, seeds);
                    }
                });
                for order in 0..=highest {
                    for (point, series) in buffer.iter().enumerate() {
                        receive(order, PointId(point), series.map(|c| c.derivative(order)));
                    }
                }
            }
            Quantity::Characteristic(c) => {
                let gradient = c.gradient(&self.inputs);
                self.velocity_gradients(
                    linearised,
                    c.info().reads,
                    gradient,
                    highest,
                    buffer,
                    receive,
                );
            }
            Quantity::AngularVelocity(axis) => {
                let mut gradient = [zero; Slot::MOST];
                gradient[0] = along(axis, Jet::constant(1.0));
                self.velocity_gradients(
                    linearised,
                    &[Slot::Turn],
                    gradient,
                    highest,
                    buffer,
                    receive,
                );
            }
        }
    }

    fn velocity_gradients(
        &self,
        linearised: &Linearised<'_, N>,
        reads: &[Slot],
        gradient: Gradient<Jet<f64, N>>,
        highest: usize,
        buffer: &mut [Vector3<Jet<f64, N>>],
        receive: &mut dyn FnMut(usize, PointId, Vector3<f64>),
    ) {
        let zero = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        for order in 0..=highest {
            let shifted =
                |h: Jet<f64, N>| Jet(std::array::from_fn(|i| if i == 0 { 0.0 } else { h[i - 1] }));
            let by_rate = |g: Jet<f64, N>| {
                Jet(std::array::from_fn(|i| {
                    g[i] * (order as f64 + 1.0 - i as f64)
                }))
            };
            buffer.fill(zero);
            linearised.gradient(buffer, |seeds| {
                for (slot, seed) in reads.iter().zip(gradient) {
                    let seed = if slot.is_rate() {
                        if *slot == Slot::Turn {
                            // dw = d(turn)' + d(turn) x w, so g.dw has the part d(turn).(w x g).
                            seeds.turn(self.inputs.turn.cross(seed).map(shifted));
                        }
                        seed.map(by_rate)
                    } else {
                        seed.map(shifted)
                    };
                    slot.push_apart(seed, &linearised.at, seeds);
                }
            });
            // Coefficient j+1 of the series, as the j-th derivative of the quantity: times j!.
            let share = 1.0 / (order + 1) as f64;
            for (point, series) in buffer.iter().enumerate() {
                let gradient = series.map(|c| c.derivative(order + 1) * share);
                receive(order, PointId(point), gradient);
            }
        }
    }
}

impl Slot {
    /// As [`Slot::push`], in a function of its own.
    #[inline(never)]
    fn push_apart<T: Real, G: crate::derive::Gradient<T> + ?Sized>(
        self,
        seed: Vector3<T>,
        at: &Configuration<T>,
        seeds: &mut Seeds<'_, '_, T, G>,
    ) {
        self.push(seed, at, seeds);
    }

    /// Adds a seed for what the slot reads; a rate's slot seeds what it is the rate of.
    #[inline(always)]
    pub(crate) fn push<T: Real, G: crate::derive::Gradient<T> + ?Sized>(
        self,
        seed: Vector3<T>,
        at: &Configuration<T>,
        seeds: &mut Seeds<'_, '_, T, G>,
    ) {
        let mechanism = at.mechanism;
        match self {
            Slot::SpinAxis | Slot::SpinAxisRate => seeds.spin_axis(seed),
            Slot::Centre | Slot::CentreRate => seeds.point(mechanism.wheel_centre, seed),
            Slot::SteeringPoint => seeds.steering_axis(seed, seed.zero()),
            Slot::SteeringDirection | Slot::SteeringDirectionRate => {
                seeds.steering_axis(seed.zero(), seed);
            }
            Slot::SpringLength | Slot::SpringLengthRate => {
                if let Some(spring) = mechanism.spring {
                    let along = (at.point(spring.upper) - at.point(spring.lower)).normalised();
                    seeds.point(spring.upper, along * seed.x);
                    seeds.point(spring.lower, -(along * seed.x));
                }
            }
            Slot::Spring => {
                if let Some(spring) = mechanism.spring {
                    seeds.point(spring.upper, seed);
                    seeds.point(spring.lower, -seed);
                }
            }
            Slot::RockerAngle => {
                if let Some(rocker) = mechanism.spring_rocker() {
                    seeds.rocker_angle(rocker, seed.x);
                }
            }
            Slot::BarAngle | Slot::BarAngleRate => {
                if let Some(bar) = mechanism.anti_roll_bar() {
                    seeds.rocker_angle(bar, seed.x);
                }
            }
            Slot::StrutUpper => {
                if let Some(upper) = mechanism.strut_upper() {
                    seeds.point(upper, seed);
                }
            }
            Slot::Turn => seeds.turn(seed),
            Slot::DesignSpinAxis => seeds.designed_spin_axis(seed),
            Slot::DesignCentre => seeds.hardpoint(mechanism.wheel_centre, seed),
        }
    }
}

impl<T: Real> Inputs<T> {
    /// What can be read off a configuration without its rates, which are left unknown like everything that
    /// is not among the slots.
    #[inline]
    pub fn standing(at: &Configuration<T>, constants: Constants, slots: Slots) -> Self {
        let reads = |now: Slot, rate: Slot| slots.contain_either(now, rate);
        let mechanism = at.mechanism;
        let unknown = at.pose.origin.map(|c| c.lit(f64::NAN));
        let nothing = Wheel::filled(unknown.x);
        let (mut now, mut design) = (nothing, nothing);
        if reads(Slot::SpinAxis, Slot::SpinAxisRate) {
            now.spin_axis = at.spin_axis();
        }
        if reads(Slot::Centre, Slot::CentreRate) {
            now.centre = at.point(mechanism.wheel_centre);
        }
        if slots.contain_steering_axis()
            && let Some(axis) = at.steering_axis()
        {
            (now.steering_point, now.steering_direction) = axis;
        }
        if reads(Slot::SpringLength, Slot::SpringLengthRate)
            && let Some(spring) = mechanism.spring
        {
            now.spring_length = (at.point(spring.upper) - at.point(spring.lower)).norm();
        }
        if slots.contains(Slot::Spring)
            && let Some(spring) = mechanism.spring
        {
            now.spring = at.point(spring.upper) - at.point(spring.lower);
        }
        if slots.contains(Slot::RockerAngle)
            && let Some(rocker) = mechanism.spring_rocker()
        {
            now.rocker_angle = at.rocker_angle(rocker);
        }
        if reads(Slot::BarAngle, Slot::BarAngleRate)
            && let Some(bar) = mechanism.anti_roll_bar()
        {
            now.bar_angle = at.rocker_angle(bar);
        }
        if slots.contains(Slot::StrutUpper)
            && let Some(upper) = mechanism.strut_upper()
        {
            now.strut_upper = at.point(upper);
        }
        if slots.contains(Slot::DesignSpinAxis) {
            design.spin_axis = at.designed_spin_axis();
        }
        if slots.contains(Slot::DesignCentre) {
            design.centre = at.designed(mechanism.wheel_centre);
        }
        Inputs {
            now,
            rate: nothing,
            turn: unknown,
            design,
            constants,
        }
    }
}

impl Constants {
    /// The figures of a suspension.
    pub fn of(suspension: &Suspension) -> Self {
        let vehicle = suspension.vehicle;
        let is_front = vehicle.position == Some(AxlePosition::Front);
        let share = |of_front: Option<f64>| match (of_front, is_front) {
            (None, _) => 0.0,
            (Some(share), true) => share,
            (Some(share), false) => 1.0 - share,
        };
        let by_carrier = |path: Option<TorquePath>| match path {
            Some(TorquePath::Carrier) => 1.0,
            _ => 0.0,
        };
        Constants {
            wheel_radius: suspension.wheel_radius.unwrap_or(0.0),
            wheelbase: vehicle.wheelbase.unwrap_or(0.0),
            cg_height: vehicle.cg_height.unwrap_or(0.0),
            is_front,
            brake_share: share(vehicle.brake_share_front),
            drive_share: share(vehicle.drive_share_front),
            brake_torque_by_carrier: by_carrier(vehicle.brakes),
            drive_torque_by_carrier: by_carrier(vehicle.drive_torque),
        }
    }
}
