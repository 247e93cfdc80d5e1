//! Contact and travels of the wheels: equations (2) to (9) of [`super::super`], which also explains the symbols.

use super::super::corner::{Corner, WheelRates};
use super::super::parameters::{AxleParameter, BodyParameter, Parameters};
use super::super::road::Road;
use super::super::{Car, TyreAxes};
use super::{Ground, Held, Resultant, WheelState};
use crate::axle::{RockerMotion, SpringLaw};
use crate::number::{Each, Local, LocalFunction, Scalar, Vector3, outlined};

/// Forces on one wheel, and the wheel's fraction of the lateral force of its axle.
#[derive(Clone, Copy)]
pub(super) struct Forces<T> {
    /// Wheel load N, along the upward normal of the ground.
    pub load: T,
    /// Lateral force.
    pub side: T,
    /// Longitudinal force.
    pub longitudinal: T,
    /// Fraction of the axle's lateral force that this wheel carries.
    pub share: T,
    /// Torque of the lever on the anti-roll bar, positive in the direction of the lever's angle.
    pub bar: T,
    /// Derivative of the energy of the springs between the rockers with respect to the wheel's own travel.
    pub rocker: T,
}

impl<T: Copy> Forces<T> {
    /// Forces that are all zero.
    #[inline(always)]
    pub(super) fn none(zero: T) -> Self {
        Forces {
            load: zero,
            side: zero,
            longitudinal: zero,
            share: zero,
            bar: zero,
            rocker: zero,
        }
    }
}

/// Works on a wheel while one travel of its axle changes by 1. The works of the tyre forces and of the torque on the
/// anti-roll bar are for a force or torque of 1.
#[derive(Clone, Copy)]
pub(super) struct Work<T> {
    /// Rise n.C' of the contact point. It is the work of a wheel load of 1.
    rise: T,
    /// Work lambda.C' of a unit lateral force.
    side: T,
    /// Work t.B' of a unit longitudinal force.
    longitudinal: T,
    /// Work of a unit torque of the lever on the anti-roll bar; zero without a bar.
    bar: T,
    /// Derivative of the energy of the wheel's spring and stops with respect to the travel.
    spring: T,
    /// Work m_b alpha.W' of the force that accelerates the wheel's mass m_b. alpha is the acceleration, and W' the
    /// velocity of the wheel centre.
    unsprung: T,
}

/// Contact of a tyre with the ground.
#[derive(Clone, Copy)]
enum Contact<T> {
    /// The wheel is lifted.
    Lifted,
    /// A rigid tyre. The number is the height of the tyre over the ground.
    Rigid(T),
    /// A tyre spring. The number is its load.
    Elastic(T),
}

/// A wheel on the ground, with all factors of its forces. These factors depend only on the ground and on the travels of
/// the axle.
#[derive(Clone, Copy)]
pub(in crate::car) struct Stance<T> {
    contact: Contact<T>,
    /// Contact point C.
    pub at: Vector3<T>,
    /// Unit vector along which longitudinal forces act.
    pub heading: Vector3<T>,
    /// Unit vector along which lateral forces act.
    pub across: Vector3<T>,
    /// Angle of the anti-roll bar's lever.
    pub bar: T,
    /// Motion of the rocker; `None` without springs between the rockers.
    pub rocker: Option<RockerMotion<T>>,
    /// Force and moment of the inertia of the wheel's mass.
    pub inertia: Resultant<T>,
    own: Work<T>,
    other: Option<Work<T>>,
}

impl<T: Copy> Work<T> {
    fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Work<U> {
        Work {
            rise: f(self.rise),
            side: f(self.side),
            longitudinal: f(self.longitudinal),
            bar: f(self.bar),
            spring: f(self.spring),
            unsprung: f(self.unsprung),
        }
    }
}

impl<T: Local> Work<T> {
    /// Returns the four terms that the work of the wheel load balances in equation (7) of [`super::super`]: elastic,
    /// geometric, longitudinal, unsprung. `is_own` is true if the travel is the wheel's own travel.
    #[inline(always)]
    fn parts(&self, forces: &Forces<T>, is_own: bool) -> [T; 4] {
        let springs = self.spring + forces.bar * self.bar;
        [
            if is_own {
                springs + forces.rocker
            } else {
                springs
            },
            -(forces.side * self.side),
            -(forces.longitudinal * self.longitudinal),
            self.unsprung,
        ]
    }

    /// Residual of equation (7) of [`super::super`] (balance of a wheel along its travel) for one wheel.
    #[inline(always)]
    fn residual(&self, forces: &Forces<T>, is_own: bool) -> T {
        let [elastic, geometric, longitudinal, unsprung] = self.parts(forces, is_own);
        forces.load * self.rise - elastic - geometric - longitudinal - unsprung
    }
}

impl<T: Copy> Stance<T> {
    /// Converts all numbers to another number type.
    pub(in crate::car) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Stance<U> {
        Stance {
            contact: match self.contact {
                Contact::Lifted => Contact::Lifted,
                Contact::Rigid(height) => Contact::Rigid(f(height)),
                Contact::Elastic(load) => Contact::Elastic(f(load)),
            },
            at: self.at.map(f),
            heading: self.heading.map(f),
            across: self.across.map(f),
            bar: f(self.bar),
            rocker: self.rocker.as_ref().map(|rocker| rocker.map(f)),
            inertia: self.inertia.map(f),
            own: self.own.map(f),
            other: self.other.as_ref().map(|work| work.map(f)),
        }
    }
}

impl<T: Local> Stance<T> {
    /// Residual of the contact equation of [`super::super`]: (4) for a rigid tyre, (5) for a tyre spring, (6) for a
    /// lifted wheel.
    #[inline(always)]
    pub(super) fn contact_residual(&self, load: T) -> T {
        match self.contact {
            Contact::Lifted => load,
            Contact::Rigid(height) => height,
            Contact::Elastic(sprung) => load - sprung,
        }
    }
}

/// Residuals of equation (7) of [`super::super`] for both travels of an axle. Each travel of a solid axle or twist beam
/// moves both wheels.
#[inline(always)]
pub(super) fn travel_residuals<T: Local>(
    [left, right]: [&Stance<T>; 2],
    [on_left, on_right]: [&Forces<T>; 2],
) -> [T; 2] {
    let mut residuals = [
        left.own.residual(on_left, true),
        right.own.residual(on_right, true),
    ];
    if let (Some(left), Some(right)) = (&left.other, &right.other) {
        residuals[0] = residuals[0] + right.residual(on_right, false);
        residuals[1] = residuals[1] + left.residual(on_left, false);
    }
    residuals
}

/// Computes the components of the wheel loads of an axle by equation (9) of [`super::super`]. For a solid axle or twist
/// beam, these components are the solution of two simultaneous equations.
#[inline(always)]
pub(super) fn load_parts<T: Local>(
    [left, right]: [&Stance<T>; 2],
    [on_left, on_right]: [&Forces<T>; 2],
) -> [[T; 4]; 2] {
    let [by_left, by_right] = [
        left.own.parts(on_left, true),
        right.own.parts(on_right, true),
    ];
    let (Some(left_other), Some(right_other)) = (&left.other, &right.other) else {
        let divided = |parts: [T; 4], by: &Work<T>| parts.each(|part| part / by.rise);
        return [divided(by_left, &left.own), divided(by_right, &right.own)];
    };
    let of_right = right_other.parts(on_right, false);
    let of_left = left_other.parts(on_left, false);
    let (a, b) = (left.own.rise, right_other.rise);
    let (c, d) = (left_other.rise, right.own.rise);
    let inverse = a.one() / (a * d - b * c);
    let mut parts = [by_left, by_right];
    for part in 0..4 {
        let by_left = by_left[part] + of_right[part];
        let by_right = of_left[part] + by_right[part];
        parts[0][part] = (d * by_left - b * by_right) * inverse;
        parts[1][part] = (a * by_right - c * by_left) * inverse;
    }
    parts
}

/// Position of a tyre relative to the ground, by equation (2) of [`super::super`].
#[derive(Clone, Copy)]
struct Tread<T> {
    /// Length s of the component of the upward normal n that is perpendicular to the spin axis.
    tilt: T,
    /// Height of the wheel centre over the ground.
    height: T,
    /// Radius of the wheel in the study.
    radius: T,
    /// Rate and unloaded radius of a tyre spring.
    spring: Option<(T, T)>,
    /// Tyre radius without load.
    free: T,
    /// Tyre radius under load.
    loaded: T,
    /// Vector from the wheel centre to the lowest point of the tyre.
    lever: Vector3<T>,
}

impl<T: Local> Tread<T> {
    #[inline(always)]
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

    #[inline(always)]
    fn contact(&self, is_lifted: bool) -> Contact<T> {
        match (is_lifted, self.spring) {
            (true, _) => Contact::Lifted,
            (false, None) => Contact::Rigid(self.height - self.radius * self.tilt),
            (false, Some((rate, free))) => {
                Contact::Elastic(rate * (free - self.loaded) / self.tilt)
            }
        }
    }

    /// Velocity of the carrier's point at the contact point.
    #[inline(always)]
    fn carried(&self, rates: &WheelRates<T>) -> Vector3<T> {
        rates.centre + rates.turn.cross(self.lever)
    }

    /// Velocity of the carrier's point at which the longitudinal force acts. If the body carries the reaction to the
    /// torque, this velocity does not include rotation about the spin axis.
    #[inline(always)]
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
#[inline(always)]
fn tyre_axes<T: Local>(
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

/// Force law of a spring and its stops. The arguments of the function are the spring's present length and its length in
/// the design position.
struct ByLaw<'s>(&'s SpringLaw);

impl LocalFunction<2, 1> for ByLaw<'_> {
    #[inline(always)]
    fn at<T: Scalar>(&self, [length, design]: [T; 2]) -> [T; 1] {
        [self.0.force(length, design)]
    }
}

/// Force of the wheel's spring and its stops; zero without a spring.
#[inline(always)]
fn spring_force<T: Local>(
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
    let [by_law] = T::local([corner.spring, corner.design_spring], &ByLaw(&laws[side]));
    by_law
        + parameters.axle(axle, AxleParameter::SpringForce)
        + parameters.axle(axle, AxleParameter::SpringRate) * shortened
}

/// A wheel on the ground before its forces are known: its position by equation (2), and the factors of the forces in
/// equations (4) to (8) of [`super::super`].
#[derive(Clone, Copy)]
pub(in crate::car) struct Placed<T> {
    corner: Corner<T>,
    tread: Tread<T>,
    spring_force: T,
    pub stance: Stance<T>,
}

impl<T: Local> Placed<T> {
    /// Computes the position of a wheel on the ground, and the factors of its forces.
    #[inline(always)]
    pub(in crate::car) fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        number: usize,
        corner: Corner<T>,
        ground: &Ground<T>,
        static_load: T,
    ) -> Self {
        outlined!(
            [T: Local] static_load;
            held: &'p Held<'p> = held, parameters: &'p Parameters<T> = parameters, number: usize = number,
            corner: Corner<T> = corner, ground: &'p Ground<T> = ground, static_load: T = static_load => Placed<T> {
                Placed::inlined(held, parameters, number, corner, ground, static_load)
            }
        )
    }

    #[inline(always)]
    fn inlined(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        number: usize,
        corner: Corner<T>,
        ground: &Ground<T>,
        static_load: T,
    ) -> Self {
        let axle = number / 2;
        let (setting, setup) = (&held.case.setting, &held.car.axles[axle].setup);
        let road = &ground.road;
        let warp = parameters.body(BodyParameter::Warp);
        let height = match number {
            0 | 3 => ground.height + warp,
            _ => ground.height - warp,
        };
        let place = (road.up, height);
        let tread = Tread::of(held, parameters, number, &corner, place, static_load);
        let (heading, across) = tyre_axes(setting.tyre_axes, &corner, road, tread.tilt);
        let by_carrier = held.car.carrier_takes_torque(axle, setting.longitudinal);
        let spring_force = spring_force(held.car, parameters, axle, &corner);
        let unsprung = parameters
            .axle(axle, AxleParameter::UnsprungMass)
            .scaled(0.5);
        let inertia = ground.acceleration * unsprung;
        let zero = tread.tilt.zero();
        let work = |rates: &WheelRates<T>| {
            let contact_rate = tread.carried(rates);
            let pushed = tread.pushed(rates, corner.spin, by_carrier);
            Work {
                rise: road.up.dot(contact_rate),
                side: across.dot(contact_rate),
                longitudinal: heading.dot(pushed),
                bar: setup.bar_rate.map_or(zero, |_| rates.bar),
                spring: match setup.springs {
                    Some(_) => -(spring_force * rates.spring),
                    None => zero,
                },
                unsprung: inertia.dot(rates.centre),
            }
        };
        let mut resultant = Resultant::zero(zero);
        resultant.act(corner.centre, -inertia);
        let stance = Stance {
            contact: tread.contact(held.lifted[number]),
            at: corner.centre + tread.lever,
            heading,
            across,
            bar: corner.bar,
            rocker: (!setup.rocker_springs.are_none()).then_some(corner.rocker),
            inertia: resultant,
            own: work(&corner.own),
            other: corner.other.as_ref().map(work),
        };
        Placed {
            corner,
            tread,
            spring_force,
            stance,
        }
    }

    /// Computes the state of the wheel under the given forces.
    pub(super) fn under(
        &self,
        held: &Held<'_>,
        axle: usize,
        forces: &Forces<T>,
        parts: [T; 4],
    ) -> WheelState<T> {
        let Placed {
            corner,
            tread,
            spring_force,
            stance,
        } = self;
        let law = held.car.axles[axle].setup.springs.as_ref();
        let law = law.map(|laws| &laws[usize::from(corner.sign < 0.0)]);
        WheelState {
            corner: *corner,
            load: forces.load,
            parts,
            side_force: forces.side,
            longitudinal_force: forces.longitudinal,
            share: forces.share,
            heading: stance.heading,
            across: stance.across,
            contact: stance.at,
            contact_rate: tread.carried(&corner.own),
            contact_by_other: corner.other.as_ref().map(|rates| tread.carried(rates)),
            radius: tread.loaded,
            gap: tread.height - tread.free * tread.tilt,
            spring_force: *spring_force,
            stop_gaps: match law {
                Some(own) => {
                    [&own.bump_stop, &own.rebound_stop].each(|stop| stop.as_ref().map(|s| s.gap))
                }
                None => [None; 2],
            },
        }
    }
}
