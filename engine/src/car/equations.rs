//! The equations of equilibrium, (1) to (9) of [`super`].

use super::corner::{Corner, WheelRates};
use super::parameters::{AxleParameter, BodyParameter, Parameters};
use super::road::Road;
use super::{
    Car, Case, GRAVITY, LateralShares, Longitudinal, LongitudinalShares, Masses, TyreAxes,
};
use crate::axle::RockerForces;
use crate::number::{Each, Scalar, Vector3};

/// Number of unknowns and equations.
pub const UNKNOWNS: usize = 14;

/// Places of the unknowns.
pub(super) const ROLL: usize = 0;
pub(super) const PITCH: usize = 1;
pub(super) const GROUND: usize = 2;
pub(super) const TRAVELS: usize = 3;
pub(super) const LOADS: usize = 7;
pub(super) const SIDE_FORCES: usize = 11;
pub(super) const LONGITUDINAL: usize = 13;

/// Places of the equations: contact and travels of the wheels, then the whole car.
pub(super) const CONTACTS: usize = 0;
pub(super) const BALANCES: usize = 4;
pub(super) const BODY: usize = 8;
/// Equations of the body whose residuals are the vertical force, the roll moment and the pitch moment.
pub(super) const VERTICAL: usize = 10;
pub(super) const ROLL_MOMENT: usize = 11;
pub(super) const PITCH_MOMENT: usize = 12;
/// Places of gamma, phi and theta among the held unknowns of the body, which stand for its equations.
pub(super) const HELD_ROWS: [usize; 3] = [2, 0, 1];

/// Inputs that stay fixed while the solver seeks the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held<'a> {
    pub car: &'a Car,
    pub case: &'a Case,
    /// Wheels off the ground: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
}

/// One wheel in a state.
#[derive(Clone, Copy, Debug)]
pub struct WheelState<T> {
    /// The wheel.
    pub corner: Corner<T>,
    /// Wheel load N.
    pub load: T,
    /// Parts of the load by (9): elastic, geometric, longitudinal, unsprung.
    pub parts: [T; 4],
    /// Lateral force S, to the left.
    pub side_force: T,
    /// Longitudinal force X, forward.
    pub longitudinal_force: T,
    /// Share of the axle's lateral force.
    pub share: T,
    /// Direction of longitudinal forces.
    pub heading: Vector3<T>,
    /// Direction of lateral forces.
    pub across: Vector3<T>,
    /// Contact point C.
    pub contact: Vector3<T>,
    /// C' by the wheel's own travel.
    pub contact_rate: Vector3<T>,
    /// The velocity of the carrier's point at C by the other wheel's travel, for a solid axle.
    pub contact_by_other: Option<Vector3<T>>,
    /// Loaded radius.
    pub radius: T,
    /// Height of the wheel's lowest point over the ground, the tyre not pressed in.
    pub gap: T,
    /// Force of the spring with its stops.
    pub spring_force: T,
    /// Gaps of bump stop and rebound stop, if there are any.
    pub stop_gaps: [Option<f64>; 2],
}

/// A state with its forces.
#[derive(Clone, Copy, Debug)]
pub struct Balance<T> {
    /// The unknowns.
    pub unknowns: [T; UNKNOWNS],
    /// The ground.
    pub road: Road<T>,
    /// The wheels: front left, front right, rear left, rear right.
    pub wheels: [WheelState<T>; 4],
    /// Sprung mass and its centre of gravity.
    pub sprung: (T, Vector3<T>),
    /// Mass and centre of gravity of the whole car.
    pub whole: (T, Vector3<T>),
    /// Mean contact point in the design position.
    pub design_contact: Vector3<T>,
    /// Downforces near the front and the rear axle, and the drag.
    pub air: [T; 3],
    /// Heights of the ride-height points; NaN without such a point.
    pub ride_heights: [T; 2],
    /// Torques of the anti-roll bars.
    pub bars: [T; 2],
    /// Springs between the rockers of each axle.
    pub rockers: [RockerForces<T>; 2],
    /// Energy of springs, stops and bars, from the design position.
    pub energy: T,
    /// Residuals of the equations.
    pub residuals: [T; UNKNOWNS],
    /// Wheels off the ground.
    pub lifted: [bool; 4],
}

impl<T: Scalar> Balance<T> {
    /// Forces and residuals of a state. The corners are at the travels of the unknowns.
    pub(super) fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        corners: [Corner<T>; 4],
        x: [T; UNKNOWNS],
    ) -> Self {
        let like = x[0];
        let zero = like.zero();
        let road = Road::under(x[ROLL], x[PITCH]);
        let masses = masses(held.car, parameters, &corners);
        let bars = bar_torques(held.car, parameters, &corners);
        let acceleration = road.forward * parameters.body(BodyParameter::Ax).scaled(GRAVITY)
            + road.left * parameters.body(BodyParameter::Ay).scaled(GRAVITY)
            + road.up * (parameters.body(BodyParameter::Az) + like.one()).scaled(GRAVITY);
        let shares = shares(held, &x);
        let static_loads = static_loads(held.car, parameters, &corners, &masses);
        let mut residuals = [zero; UNKNOWNS];
        let mut force = Vector3::new(zero, zero, zero);
        let mut moment = force;
        let mut act = |at: Vector3<T>, by: Vector3<T>| {
            force = force + by;
            moment = moment + at.cross(by);
        };
        let rockers = [0, 1].map(|axle| {
            let motions = [0, 1].map(|side| corners[2 * axle + side].rocker);
            let laws = parameters.rocker_springs(held.car, axle);
            laws.forces(&motions)
        });
        let wheels = [0, 1, 2, 3].map(|number| {
            let axle = number / 2;
            let corner = corners[number];
            let unsprung = parameters
                .axle(axle, AxleParameter::UnsprungMass)
                .scaled(0.5);
            let share =
                held.car
                    .longitudinal_share(axle, held.case.setting.longitudinal, parameters);
            let warp = parameters.body(BodyParameter::Warp);
            let forces = Forces {
                load: x[LOADS + number],
                side: x[SIDE_FORCES + axle] * shares[number][0],
                longitudinal: x[LONGITUDINAL] * share * shares[number][1],
                share: shares[number][0],
                bar: match corner.sign > 0.0 {
                    true => bars[axle],
                    false => -bars[axle],
                },
                rocker: rockers[axle].work[number % 2],
                inertia: acceleration * unsprung,
                static_load: static_loads[axle],
            };
            let ground = match number {
                0 | 3 => x[GROUND] + warp,
                _ => x[GROUND] - warp,
            };
            let pushed = wheel_balance(held, parameters, number, corner, &road, ground, &forces);
            residuals[CONTACTS + number] = pushed.contact;
            let wheel = &pushed.wheel;
            act(
                wheel.contact,
                road.up * forces.load
                    + wheel.across * forces.side
                    + wheel.heading * forces.longitudinal,
            );
            act(corner.centre, -forces.inertia);
            pushed
        });
        let [a, b, c, d] = wheels;
        let (front, rear) = (travel_rows([a, b]), travel_rows([c, d]));
        for (axle, rows) in [&front, &rear].into_iter().enumerate() {
            let row = BALANCES + 2 * axle;
            residuals[row..row + 2].copy_from_slice(&rows.residuals);
        }
        let wheels = {
            let ([a, b], [c, d]) = (front.wheels, rear.wheels);
            [a, b, c, d]
        };
        let energy = energy(held.car, parameters, &corners, &bars, &rockers);
        let (mass, cg) = masses.sprung;
        act(cg, -(acceleration * mass));
        let ride_heights = [0, 1].each(|axle| match held.car.ride_height_points[axle] {
            Some(point) => road.up.dot(road.up.constant(point)) - x[GROUND],
            None => like.constant(f64::NAN),
        });
        let (air, pushes) = air(held.car, parameters, ride_heights);
        for (point, size, direction) in [
            (pushes[0], air[0], -road.up),
            (pushes[1], air[1], -road.up),
            (pushes[2], air[2], -road.forward),
        ] {
            act(road.up.constant(point), direction * size);
        }
        let inertia = held.car.yaw_inertia.unwrap_or(0.0) * held.case.yaw_acceleration;
        moment = moment - road.up * like.constant(inertia * held.car.per_metre());
        // Along i, e, n; the roll moment is about the body's own axis x.
        let body = [
            force.dot(road.forward),
            force.dot(road.left),
            force.dot(road.up),
            moment.x,
            moment.dot(road.left),
            moment.dot(road.up),
        ];
        residuals[BODY..].copy_from_slice(&body);
        Balance {
            unknowns: x,
            road,
            wheels,
            sprung: masses.sprung,
            whole: masses.whole,
            design_contact: masses.design_contact,
            air,
            ride_heights,
            bars,
            rockers,
            energy,
            residuals,
            lifted: held.lifted,
        }
    }
}

/// Forces on one wheel.
struct Forces<T> {
    load: T,
    side: T,
    longitudinal: T,
    share: T,
    /// Torque of the bar on its lever, in the sense of its angle.
    bar: T,
    /// Rate of the energy of springs between the rockers by the wheel's own travel.
    rocker: T,
    /// Force that accelerates the wheel's mass.
    inertia: Vector3<T>,
    static_load: T,
}

/// Work by one travel of the axle.
#[derive(Clone, Copy)]
struct Work<T> {
    /// n.C'.
    rise: T,
    /// Forces that the wheel load balances: elastic, geometric, longitudinal, unsprung.
    parts: [T; 4],
}

/// A wheel with the residual of its contact, and the work of its forces.
#[derive(Clone, Copy)]
struct Pushed<T> {
    wheel: WheelState<T>,
    contact: T,
    own: Work<T>,
    other: Option<Work<T>>,
}

/// Both wheels of an axle, and the residuals of its travels.
struct TravelRows<T> {
    wheels: [WheelState<T>; 2],
    residuals: [T; 2],
}

/// The equations of both travels (7), and the parts of the loads (9). The wheels of a solid axle move with both travels, and
/// the parts solve two equations.
fn travel_rows<T: Scalar>([left, right]: [Pushed<T>; 2]) -> TravelRows<T> {
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

/// A wheel, the residual of its contact, and the work of its forces: (2) to (7).
fn wheel_balance<T: Scalar>(
    held: &Held<'_>,
    parameters: &Parameters<T>,
    number: usize,
    corner: Corner<T>,
    road: &Road<T>,
    ground: T,
    forces: &Forces<T>,
) -> Pushed<T> {
    let axle = number / 2;
    let setting = &held.case.setting;
    let up = road.up;
    let along = up.dot(corner.spin);
    let down = up - corner.spin * along;
    let tilt = down.norm();
    let height = up.dot(corner.centre) - ground;
    let radius = parameters.axle(axle, AxleParameter::Radius);
    let spring = match (setting.elastic_tyres, held.car.tyres) {
        (true, Some(tyres)) => {
            let rate = parameters.axle(axle, AxleParameter::TyreRate);
            let load = match tyres[axle].load {
                Some(load) => radius.constant(load),
                None => forces.static_load,
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
    let lever = down * (-loaded / tilt);
    let contact = corner.centre + lever;
    let carried = |rates: &WheelRates<T>| rates.centre + rates.turn.cross(lever);
    let (heading, across) = match setting.tyre_axes {
        TyreAxes::Road => (road.forward, road.left),
        TyreAxes::Wheel => {
            let heading = corner.spin.cross(up) * tilt.constant(corner.sign);
            let heading = heading.normalised();
            (heading, up.cross(heading))
        }
    };
    let by_carrier = held.car.carrier_takes_torque(axle, setting.longitudinal);
    let pushed = |rates: &WheelRates<T>| match by_carrier {
        true => carried(rates),
        false => {
            let turn = rates.turn - corner.spin * rates.turn.dot(corner.spin);
            rates.centre + turn.cross(lever)
        }
    };
    let law = &held.car.axles[axle].setup.springs;
    let spring_force = match law {
        Some(laws) => {
            let side = usize::from(corner.sign < 0.0);
            let shortened = corner.design_spring - corner.spring;
            laws[side].force(corner.spring, corner.design_spring)
                + parameters.axle(axle, AxleParameter::SpringForce)
                + parameters.axle(axle, AxleParameter::SpringRate) * shortened
        }
        None => tilt.zero(),
    };
    let has_bar = held.car.axles[axle].setup.bar_rate.is_some();
    let has_rocker_springs = !held.car.axles[axle].setup.rocker_springs.are_none();
    let work = |rates: &WheelRates<T>, is_own: bool| {
        let mut elastic = tilt.zero();
        if law.is_some() {
            elastic = elastic - spring_force * rates.spring;
        }
        if has_bar {
            elastic = elastic + forces.bar * rates.bar;
        }
        if has_rocker_springs && is_own {
            elastic = elastic + forces.rocker;
        }
        let contact_rate = carried(rates);
        Work {
            rise: up.dot(contact_rate),
            parts: [
                elastic,
                -(forces.side * across.dot(contact_rate)),
                -(forces.longitudinal * heading.dot(pushed(rates))),
                forces.inertia.dot(rates.centre),
            ],
        }
    };
    let contact_residual = match (held.lifted[number], spring) {
        (true, _) => forces.load,
        (false, None) => height - radius * tilt,
        (false, Some((rate, free))) => forces.load - rate * (free - loaded) / tilt,
    };
    let wheel = WheelState {
        corner,
        load: forces.load,
        parts: [tilt.zero(); 4],
        side_force: forces.side,
        longitudinal_force: forces.longitudinal,
        share: forces.share,
        heading,
        across,
        contact,
        contact_rate: carried(&corner.own),
        contact_by_other: corner.other.as_ref().map(carried),
        radius: loaded,
        gap: height - free * tilt,
        spring_force,
        stop_gaps: match law {
            Some(laws) => {
                let own = &laws[usize::from(corner.sign < 0.0)];
                [&own.bump_stop, &own.rebound_stop].map(|stop| stop.as_ref().map(|s| s.gap))
            }
            None => [None; 2],
        },
    };
    Pushed {
        wheel,
        contact: contact_residual,
        own: work(&corner.own, true),
        other: corner.other.as_ref().map(|rates| work(rates, false)),
    }
}

/// Energy of springs, stops and bars, from the design position.
fn energy<T: Scalar>(
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

/// Masses of a car.
struct CarMasses<T> {
    sprung: (T, Vector3<T>),
    whole: (T, Vector3<T>),
    design_contact: Vector3<T>,
    /// Contact points in the design position.
    design_contacts: [Vector3<T>; 4],
}

fn masses<T: Scalar>(
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
        // G moves with the wheels, whose masses are part of the whole.
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

/// Load of each wheel of the axles at rest in the design position, half the axle's: the lever rule.
fn static_loads<T: Scalar>(
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

/// Torque of each axle's bar, by the left lever's angle minus the right one's.
fn bar_torques<T: Scalar>(
    car: &Car,
    parameters: &Parameters<T>,
    corners: &[Corner<T>; 4],
) -> [T; 2] {
    [0, 1].each(|axle| match car.axles[axle].setup.bar_rate {
        Some(_) => {
            let [left, right] = [0, 1].each(|side| corners[2 * axle + side].bar);
            parameters.axle(axle, AxleParameter::BarRate) * (left - right)
        }
        None => corners[0].centre.x.zero(),
    })
}

/// Lateral and longitudinal share of each wheel in the force of its axle (3).
fn shares<T: Scalar>(held: &Held<'_>, x: &[T; UNKNOWNS]) -> [[T; 2]; 4] {
    let setting = &held.case.setting;
    let share = |number: usize, is_by_load: bool, of_left: f64| {
        let (own, other) = (number, number ^ 1);
        let like = x[0];
        if held.lifted[own] {
            return like.zero();
        }
        if held.lifted[other] {
            return like.one();
        }
        if is_by_load {
            return x[LOADS + own] / (x[LOADS + own] + x[LOADS + other]);
        }
        like.constant(match number % 2 {
            0 => of_left,
            _ => 1.0 - of_left,
        })
    };
    [0, 1, 2, 3].each(|number| {
        let lateral = match setting.lateral_shares {
            LateralShares::ByLoad => share(number, true, 0.5),
            LateralShares::Equal => share(number, false, 0.5),
            LateralShares::Left(left) => share(number, false, left[number / 2]),
        };
        let by_load = setting.longitudinal_shares == LongitudinalShares::ByLoad;
        [lateral, share(number, by_load, 0.5)]
    })
}

impl Car {
    /// An axle's share of the longitudinal force.
    fn longitudinal_share<T: Scalar>(
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

/// Downforces and drag, and the points of the body where they act.
fn air<T: Scalar>(
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
        // Without ride heights, their factors are zero.
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
