//! Contact and travels of the wheels, (2) to (9) of [`super::super`].

use super::super::corner::{Corner, WheelRates};
use super::super::parameters::{AxleParameter, Parameters};
use super::super::road::Road;
use super::super::{Car, TyreAxes};
use super::{Held, WheelState};
use crate::number::{Each, Scalar, Vector3};

/// Forces on one wheel, and shares that give them.
pub(super) struct Forces<T> {
    /// Wheel load.
    pub load: T,
    /// Lateral force.
    pub side: T,
    /// Longitudinal force.
    pub longitudinal: T,
    /// Share of the axle's lateral force.
    pub share: T,
    /// Torque of the bar on its lever, positive in the sense of the lever's angle.
    pub bar: T,
    /// Derivative, by the wheel's own travel, of the energy of the springs between the rockers.
    pub rocker: T,
    /// Force that accelerates the wheel's mass.
    pub inertia: Vector3<T>,
    /// Wheel load at rest, from which the free radius of the tyre follows.
    pub static_load: T,
}

/// Work per unit of one travel of the axle.
#[derive(Clone, Copy)]
struct Work<T> {
    /// Rise n.C' of the contact point.
    rise: T,
    /// Generalised forces that the wheel load balances: elastic, geometric, longitudinal, unsprung.
    parts: [T; 4],
}

/// A wheel, the residual of its contact, and the work of its forces.
#[derive(Clone, Copy)]
pub(super) struct Pushed<T> {
    pub wheel: WheelState<T>,
    pub contact: T,
    own: Work<T>,
    other: Option<Work<T>>,
}

/// Both wheels of an axle, and the residuals of its two travels.
pub(super) struct TravelRows<T> {
    pub wheels: [WheelState<T>; 2],
    pub residuals: [T; 2],
}

/// Equations (7) of both travels, and parts (9) of the loads. Each travel of a solid axle moves both wheels, so its parts
/// come from two simultaneous equations.
pub(super) fn travel_rows<T: Scalar>([left, right]: [Pushed<T>; 2]) -> TravelRows<T> {
    let mut wheels = [left.wheel, right.wheel];
    let row = |work: &Work<T>, load: T| {
        let [elastic, geometric, longitudinal, unsprung] = work.parts;
        load * work.rise - elastic - geometric - longitudinal - unsprung
    };
    let [left_load, right_load] = [left.wheel.load, right.wheel.load];
    let mut residuals = [row(&left.own, left_load), row(&right.own, right_load)];
    match (left.other, right.other) {
        (Some(left_by_other), Some(right_by_other)) => {
            residuals[0] = residuals[0] + row(&right_by_other, right_load);
            residuals[1] = residuals[1] + row(&left_by_other, left_load);
            let (a, b) = (left.own.rise, right_by_other.rise);
            let (c, d) = (left_by_other.rise, right.own.rise);
            let inverse = a.one() / (a * d - b * c);
            for part in 0..4 {
                let by_left = left.own.parts[part] + right_by_other.parts[part];
                let by_right = left_by_other.parts[part] + right.own.parts[part];
                wheels[0].parts[part] = (d * by_left - b * by_right) * inverse;
                wheels[1].parts[part] = (a * by_right - c * by_left) * inverse;
            }
        }
        _ => {
            for (wheel, own) in wheels.iter_mut().zip([left.own, right.own]) {
                wheel.parts = own.parts.each(|part| part / own.rise);
            }
        }
    }
    TravelRows { wheels, residuals }
}

/// Tyre on the ground, by (2).
struct Tread<T> {
    /// Length s of the upward normal's part across the spin axis.
    tilt: T,
    /// Height of the wheel centre over the ground.
    height: T,
    /// Tyre radius of the wheel in its study.
    radius: T,
    /// Rate and unloaded radius of an elastic tyre.
    spring: Option<(T, T)>,
    /// Tyre radius without load.
    free: T,
    /// Tyre radius under load.
    loaded: T,
    /// Vector from the wheel centre to the lowest point.
    lever: Vector3<T>,
}

impl<T: Scalar> Tread<T> {
    fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        number: usize,
        corner: &Corner<T>,
        (up, ground): (Vector3<T>, T),
        static_load: T,
    ) -> Self {
        let axle = number / 2;
        let along = up.dot(corner.spin);
        let down = up - corner.spin * along;
        let tilt = down.norm();
        let height = up.dot(corner.centre) - ground;
        let radius = parameters.axle(axle, AxleParameter::Radius);
        let spring = match (held.case.setting.elastic_tyres, held.car.tyres) {
            (true, Some(tyres)) => {
                let rate = parameters.axle(axle, AxleParameter::TyreRate);
                let load = match tyres[axle].load {
                    Some(load) => radius.constant(load),
                    None => static_load,
                };
                Some((rate, radius + load / rate))
            }
            _ => None,
        };
        let free = spring.map_or(radius, |(_, free)| free);
        let loaded = match (spring, held.lifted[number]) {
            (Some(_), false) => height / tilt,
            _ => free,
        };
        Tread {
            lever: down * (-loaded / tilt),
            tilt,
            height,
            radius,
            spring,
            free,
            loaded,
        }
    }

    /// Residual of the contact; for a lifted wheel, of its load.
    fn residual(&self, load: T, is_lifted: bool) -> T {
        match (is_lifted, self.spring) {
            (true, _) => load,
            (false, None) => self.height - self.radius * self.tilt,
            (false, Some((rate, free))) => load - rate * (free - self.loaded) / self.tilt,
        }
    }

    /// Velocity of the carrier's point at the contact.
    fn carried(&self, rates: &WheelRates<T>) -> Vector3<T> {
        rates.centre + rates.turn.cross(self.lever)
    }

    /// Velocity of the point at which the longitudinal force acts. If the body takes the torque, rotation about the spin
    /// axis does not count.
    fn pushed(&self, rates: &WheelRates<T>, spin: Vector3<T>, by_carrier: bool) -> Vector3<T> {
        if by_carrier {
            self.carried(rates)
        } else {
            let turn = rates.turn - spin * rates.turn.dot(spin);
            rates.centre + turn.cross(self.lever)
        }
    }
}

/// Unit vectors of the longitudinal and the lateral force.
fn tyre_axes<T: Scalar>(
    axes: TyreAxes,
    corner: &Corner<T>,
    road: &Road<T>,
    tilt: T,
) -> (Vector3<T>, Vector3<T>) {
    match axes {
        TyreAxes::Road => (road.forward, road.left),
        TyreAxes::Wheel => {
            let heading = corner.spin.cross(road.up) * tilt.constant(corner.sign);
            let heading = heading.normalised();
            (heading, road.up.cross(heading))
        }
    }
}

/// Force of the wheel's spring and its stops; zero without a spring.
fn spring_force<T: Scalar>(
    car: &Car,
    parameters: &Parameters<T>,
    axle: usize,
    corner: &Corner<T>,
) -> T {
    let Some(laws) = &car.axles[axle].setup.springs else {
        return corner.spring.zero();
    };
    let side = usize::from(corner.sign < 0.0);
    let shortened = corner.design_spring - corner.spring;
    laws[side].force(corner.spring, corner.design_spring)
        + parameters.axle(axle, AxleParameter::SpringForce)
        + parameters.axle(axle, AxleParameter::SpringRate) * shortened
}

/// Computes a wheel, the residual of its contact, and the work of its forces: (2) to (7).
pub(super) fn wheel_balance<T: Scalar>(
    held: &Held<'_>,
    parameters: &Parameters<T>,
    number: usize,
    corner: Corner<T>,
    (road, ground): (&Road<T>, T),
    forces: &Forces<T>,
) -> Pushed<T> {
    let axle = number / 2;
    let (setting, setup) = (&held.case.setting, &held.car.axles[axle].setup);
    let place = (road.up, ground);
    let tread = Tread::of(held, parameters, number, &corner, place, forces.static_load);
    let (heading, across) = tyre_axes(setting.tyre_axes, &corner, road, tread.tilt);
    let by_carrier = held.car.carrier_takes_torque(axle, setting.longitudinal);
    let spring_force = spring_force(held.car, parameters, axle, &corner);
    let has_rocker_springs = !setup.rocker_springs.are_none();
    let work = |rates: &WheelRates<T>, is_own: bool| {
        let mut elastic = tread.tilt.zero();
        if setup.springs.is_some() {
            elastic = elastic - spring_force * rates.spring;
        }
        if setup.bar_rate.is_some() {
            elastic = elastic + forces.bar * rates.bar;
        }
        if has_rocker_springs && is_own {
            elastic = elastic + forces.rocker;
        }
        let contact_rate = tread.carried(rates);
        let pushed = tread.pushed(rates, corner.spin, by_carrier);
        Work {
            rise: road.up.dot(contact_rate),
            parts: [
                elastic,
                -(forces.side * across.dot(contact_rate)),
                -(forces.longitudinal * heading.dot(pushed)),
                forces.inertia.dot(rates.centre),
            ],
        }
    };
    let law = setup.springs.as_ref();
    let law = law.map(|laws| &laws[usize::from(corner.sign < 0.0)]);
    let wheel = WheelState {
        corner,
        load: forces.load,
        parts: [tread.tilt.zero(); 4],
        side_force: forces.side,
        longitudinal_force: forces.longitudinal,
        share: forces.share,
        heading,
        across,
        contact: corner.centre + tread.lever,
        contact_rate: tread.carried(&corner.own),
        contact_by_other: corner.other.as_ref().map(|rates| tread.carried(rates)),
        radius: tread.loaded,
        gap: tread.height - tread.free * tread.tilt,
        spring_force,
        stop_gaps: match law {
            Some(own) => {
                [&own.bump_stop, &own.rebound_stop].map(|stop| stop.as_ref().map(|s| s.gap))
            }
            None => [None; 2],
        },
    };
    Pushed {
        wheel,
        contact: tread.residual(forces.load, held.lifted[number]),
        own: work(&corner.own, true),
        other: corner.other.as_ref().map(|rates| work(rates, false)),
    }
}
