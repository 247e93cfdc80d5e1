//! Masses, springs and aerodynamic forces of the whole car.

use super::super::corner::Corner;
use super::super::parameters::{AxleParameter, BodyParameter, Parameters};
use super::super::road::Road;
use super::super::{Car, GRAVITY, LateralShares, Longitudinal, LongitudinalShares, Masses};
use super::{Held, LOADS, UNKNOWNS};
use crate::axle::RockerForces;
use crate::number::{Each, Local, Scalar, Vector3};

/// Energy of springs, stops and bars, relative to the design position.
pub(super) fn energy<T: Scalar>(
    car: &Car,
    parameters: &Parameters<T>,
    corners: &[Corner<T>; 4],
    bars: &[T; 2],
    rockers: &[RockerForces<T>; 2],
) -> T {
    let mut sum = corners[0].spring.zero();
    for (axle, own) in car.axles.iter().enumerate() {
        let of_axle = &corners[2 * axle..2 * axle + 2];
        if let Some(laws) = &own.setup.springs {
            for (law, corner) in laws.iter().zip(of_axle) {
                let shortened = corner.design_spring - corner.spring;
                let change = parameters.axle(axle, AxleParameter::SpringForce)
                    + (parameters.axle(axle, AxleParameter::SpringRate) * shortened).scaled(0.5);
                sum = sum + law.energy(corner.spring, corner.design_spring) + change * shortened;
            }
        }
        if own.setup.bar_rate.is_some() {
            sum = sum + (bars[axle] * (of_axle[0].bar - of_axle[1].bar)).scaled(0.5);
        }
        sum = sum + rockers[axle].energy;
    }
    sum
}

/// Masses of a car, and the centre of each mass.
pub(in crate::car) struct CarMasses<T> {
    /// Sprung mass, and its centre of gravity.
    pub sprung: (T, Vector3<T>),
    /// Mass of the whole car, and its centre of gravity.
    pub whole: (T, Vector3<T>),
    /// Mean of the four contact points in the design position.
    pub design_contact: Vector3<T>,
    /// Contact points in the design position.
    design_contacts: [Vector3<T>; 4],
}

/// Computes the masses of the car and the centre of each mass.
pub(in crate::car) fn masses<T: Local>(
    car: &Car,
    parameters: &Parameters<T>,
    corners: &[Corner<T>; 4],
) -> CarMasses<T> {
    let (mass, cg) = (parameters.body(BodyParameter::Mass), parameters.cg());
    let wheel = |number: usize| {
        parameters
            .axle(number / 2, AxleParameter::UnsprungMass)
            .scaled(0.5)
    };
    let add =
        |(mass, moment): (T, Vector3<T>), of: T, at: Vector3<T>| (mass + of, moment + at * of);
    let place = |(mass, moment): (T, Vector3<T>)| (mass, moment * (mass.one() / mass));
    let given = (mass, cg * mass);
    let mut sprung = given;
    if car.masses == Masses::Whole {
        // The total includes the wheels, so its centre of gravity moves with them.
        for (number, corner) in corners.iter().enumerate() {
            sprung = add(sprung, -wheel(number), corner.design_centre);
        }
    }
    let mut whole = sprung;
    for (number, corner) in corners.iter().enumerate() {
        whole = add(whole, wheel(number), corner.centre);
    }
    let level = Road::under(mass.zero(), mass.zero());
    let design_contacts = [0, 1, 2, 3].each(|number| {
        let corner = &corners[number];
        let down = level.up - corner.design_spin * level.up.dot(corner.design_spin);
        let radius = parameters.axle(number / 2, AxleParameter::Radius);
        corner.design_centre - down.normalised() * radius
    });
    let [a, b, c, d] = design_contacts;
    CarMasses {
        sprung: place(sprung),
        whole: place(whole),
        design_contact: (a + b + c + d) * mass.constant(0.25),
        design_contacts,
    }
}

/// Computes the load on each wheel of the front and rear axle, at rest in the design position, by the lever rule. Both
/// wheels of an axle carry equal loads. Returns zeros if no tyre spring needs these loads.
pub(in crate::car) fn static_loads<T: Local>(
    car: &Car,
    parameters: &Parameters<T>,
    corners: &[Corner<T>; 4],
    masses: &CarMasses<T>,
) -> [T; 2] {
    let is_needed = car
        .tyres
        .is_some_and(|tyres| tyres.iter().any(|tyre| tyre.load.is_none()));
    let like = parameters.body(BodyParameter::Mass);
    if !is_needed {
        return [like.zero(); 2];
    }
    let [front, rear] = [0, 2].each(|left| {
        (masses.design_contacts[left].x + masses.design_contacts[left + 1].x).scaled(0.5)
    });
    let (mut mass, mut moment) = (masses.sprung.0, masses.sprung.0 * masses.sprung.1.x);
    for (number, corner) in corners.iter().enumerate() {
        let own = parameters
            .axle(number / 2, AxleParameter::UnsprungMass)
            .scaled(0.5);
        mass = mass + own;
        moment = moment + own * corner.design_centre.x;
    }
    let on_front = (moment - mass * rear) / (front - rear);
    [on_front, mass - on_front].each(|carried| carried.scaled(0.5 * GRAVITY))
}

/// Torque of an axle's anti-roll bar: its rate times the difference of the lever angles, left minus right.
#[inline(always)]
pub(super) fn bar_torque<T: Local>(
    car: &Car,
    parameters: &Parameters<T>,
    axle: usize,
    [left, right]: [T; 2],
) -> T {
    match car.axles[axle].setup.bar_rate {
        Some(_) => parameters.axle(axle, AxleParameter::BarRate) * (left - right),
        None => parameters.body(BodyParameter::Mass).zero(),
    }
}

/// Returns the fraction of an axle's force that a wheel carries. The fraction is proportional to the wheel load, or
/// follows from the fraction that the study gives for the left wheel. A lifted wheel carries 0, and the other wheel then
/// carries 1.
#[inline(always)]
fn share<T: Local>(
    held: &Held<'_>,
    x: &[T; UNKNOWNS],
    own: usize,
    (is_by_load, of_left): (bool, f64),
) -> T {
    let other = own ^ 1;
    if held.lifted[own] {
        return x[0].zero();
    }
    if held.lifted[other] {
        return x[0].one();
    }
    if is_by_load {
        return x[LOADS + own] / (x[LOADS + own] + x[LOADS + other]);
    }
    x[0].constant(match own % 2 {
        0 => of_left,
        _ => 1.0 - of_left,
    })
}

/// Computes the fractions f and g of the axle's lateral and longitudinal force that a wheel carries: equation (3) of
/// [`super::super`].
#[inline(always)]
pub(super) fn shares<T: Local>(held: &Held<'_>, x: &[T; UNKNOWNS], number: usize) -> [T; 2] {
    let setting = &held.case.setting;
    let lateral = match setting.lateral_shares {
        LateralShares::ByLoad => (true, 0.5),
        LateralShares::Equal => (false, 0.5),
        LateralShares::Left(left) => (false, left[number / 2]),
    };
    let by_load = setting.longitudinal_shares == LongitudinalShares::ByLoad;
    [
        share(held, x, number, lateral),
        share(held, x, number, (by_load, 0.5)),
    ]
}

impl Car {
    /// Returns the fraction of the longitudinal force that an axle carries.
    #[inline(always)]
    pub(super) fn longitudinal_share<T: Local>(
        &self,
        axle: usize,
        longitudinal: Longitudinal,
        parameters: &Parameters<T>,
    ) -> T {
        let front = parameters.body(match longitudinal {
            Longitudinal::Brake => BodyParameter::BrakeShareFront,
            Longitudinal::Drive => BodyParameter::DriveShareFront,
        });
        match axle {
            0 => front,
            _ => front.one() - front,
        }
    }
}

/// Computes downforces and drag, each with the point of the body at which the force acts.
#[inline(always)]
pub(super) fn air<T: Local>(
    car: &Car,
    parameters: &Parameters<T>,
    [front, rear]: [T; 2],
) -> ([T; 3], [Vector3<f64>; 3]) {
    let zero = front.zero();
    let mut points = [Vector3::default(); 3];
    let mut forces = [zero; 3];
    let Some(air) = &car.air else {
        return (forces, points);
    };
    let pressure = parameters
        .body(BodyParameter::Speed)
        .squared()
        .scaled(0.5 * air.density);
    let given = [air.downforce[0], air.downforce[1], air.drag];
    for (number, force) in given.iter().enumerate() {
        let Some(force) = force else { continue };
        points[number] = force.point;
        let mut area = zero.constant(force.area[0]);
        // Without ride-height points, the coefficients of the ride heights are zero.
        if force.area[1..].iter().any(|factor| *factor != 0.0) {
            let powers = [front, rear, front.squared(), front * rear, rear.squared()];
            for (power, factor) in powers.into_iter().zip(&force.area[1..]) {
                area = area + power.scaled(*factor);
            }
        }
        forces[number] = pressure * area;
    }
    (forces, points)
}
