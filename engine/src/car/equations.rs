//! Equations of equilibrium, (1) to (9) of [`super`].

mod body;
mod wheel;

use super::corner::Corner;
use super::parameters::{AxleParameter, BodyParameter, Parameters};
use super::road::Road;
use super::{Car, Case, GRAVITY};
use crate::axle::RockerForces;
use crate::number::{Each, Scalar, Vector3};
use body::{air, bar_torques, energy, masses, shares, static_loads};
use wheel::{Forces, Pushed, travel_rows, wheel_balance};

/// Number of unknowns and equations.
pub const UNKNOWNS: usize = 14;

/// Indices of the unknowns.
pub(super) const ROLL: usize = 0;
pub(super) const PITCH: usize = 1;
pub(super) const GROUND: usize = 2;
pub(super) const TRAVELS: usize = 3;
pub(super) const LOADS: usize = 7;
pub(super) const SIDE_FORCES: usize = 11;
pub(super) const LONGITUDINAL: usize = 13;

/// First indices of the equations: contacts and travels of the wheels, then the whole car.
pub(super) const CONTACTS: usize = 0;
pub(super) const BALANCES: usize = 4;
pub(super) const BODY: usize = 8;
/// Indices of three equations of the body: vertical force, roll moment, pitch moment.
pub(super) const VERTICAL: usize = 10;
pub(super) const ROLL_MOMENT: usize = 11;
pub(super) const PITCH_MOMENT: usize = 12;
/// Equations that make way for gamma, phi and theta, in this order, if these unknowns of the body are held.
pub(super) const HELD_ROWS: [usize; 3] = [2, 0, 1];

/// Inputs that stay fixed while the solver varies the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held<'a> {
    pub car: &'a Car,
    pub case: &'a Case,
    /// True for each lifted wheel: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
}

/// State of one wheel with its forces.
#[derive(Clone, Copy, Debug)]
pub struct WheelState<T> {
    /// Pose of the wheel in the car's axes.
    pub corner: Corner<T>,
    /// Wheel load N.
    pub load: T,
    /// Parts of the load by (9): elastic, geometric, longitudinal, unsprung.
    pub parts: [T; 4],
    /// Lateral force S, to the left.
    pub side_force: T,
    /// Longitudinal force X, positive forward.
    pub longitudinal_force: T,
    /// Share of the axle's lateral force, f in (3).
    pub share: T,
    /// Unit vector along which longitudinal forces act.
    pub heading: Vector3<T>,
    /// Unit vector along which lateral forces act.
    pub across: Vector3<T>,
    /// Contact point C.
    pub contact: Vector3<T>,
    /// Derivative C' by the wheel's own travel.
    pub contact_rate: Vector3<T>,
    /// Velocity of the carrier's point at C by the other wheel's travel, for a solid axle.
    pub contact_by_other: Option<Vector3<T>>,
    /// Loaded radius.
    pub radius: T,
    /// Height of the wheel's lowest point over the ground, with the tyre not compressed.
    pub gap: T,
    /// Force of the spring and its stops.
    pub spring_force: T,
    /// Gaps of the bump stop and the rebound stop, if present.
    pub stop_gaps: [Option<f64>; 2],
}

/// A state of the car with its forces.
#[derive(Clone, Copy, Debug)]
pub struct Balance<T> {
    /// Values of the unknowns.
    pub unknowns: [T; UNKNOWNS],
    /// Directions of the ground.
    pub road: Road<T>,
    /// The wheels: front left, front right, rear left, rear right.
    pub wheels: [WheelState<T>; 4],
    /// Sprung mass, and its centre of gravity.
    pub sprung: (T, Vector3<T>),
    /// Mass of the whole car, and its centre of gravity.
    pub whole: (T, Vector3<T>),
    /// Mean contact point in the design position.
    pub design_contact: Vector3<T>,
    /// Downforces near the front and the rear axle, then the drag.
    pub air: [T; 3],
    /// Heights of the ride-height points; NaN without such a point.
    pub ride_heights: [T; 2],
    /// Torque of each axle's anti-roll bar.
    pub bars: [T; 2],
    /// Forces of the springs between the rockers of each axle.
    pub rockers: [RockerForces<T>; 2],
    /// Energy of springs, stops and bars, relative to the design position.
    pub energy: T,
    /// Residuals of the equations.
    pub residuals: [T; UNKNOWNS],
    /// True for each lifted wheel.
    pub lifted: [bool; 4],
}

impl<T: Scalar> Balance<T> {
    /// Computes forces and residuals of a state. The corners belong to the travels among the unknowns.
    pub(super) fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        corners: [Corner<T>; 4],
        x: [T; UNKNOWNS],
    ) -> Self {
        let zero = x[0].zero();
        let road = Road::under(x[ROLL], x[PITCH]);
        let masses = masses(held.car, parameters, &corners);
        let bars = bar_torques(held.car, parameters, &corners);
        let acceleration = acceleration(&road, parameters);
        let rockers = [0, 1].map(|axle| {
            let motions = [0, 1].map(|side| corners[2 * axle + side].rocker);
            let laws = parameters.rocker_springs(held.car, axle);
            laws.forces(&motions)
        });
        let supports = Supports {
            shares: shares(held, &x),
            static_loads: static_loads(held.car, parameters, &corners, &masses),
            acceleration,
            bars,
            rockers: &rockers,
        };
        let mut residuals = [zero; UNKNOWNS];
        let mut on_body = Resultant {
            force: Vector3::new(zero, zero, zero),
            moment: Vector3::new(zero, zero, zero),
        };
        let wheels = [0, 1, 2, 3].map(|number| {
            let pushed = supports.wheel(held, parameters, number, corners[number], (&road, &x));
            residuals[CONTACTS + number] = pushed.contact;
            let wheel = &pushed.wheel;
            on_body.act(
                wheel.contact,
                road.up * wheel.load
                    + wheel.across * wheel.side_force
                    + wheel.heading * wheel.longitudinal_force,
            );
            let unsprung = parameters.axle(number / 2, AxleParameter::UnsprungMass);
            on_body.act(
                corners[number].centre,
                -(acceleration * unsprung.scaled(0.5)),
            );
            pushed
        });
        let [a, b, c, d] = wheels;
        let (front, rear) = (travel_rows([a, b]), travel_rows([c, d]));
        for (axle, rows) in [&front, &rear].into_iter().enumerate() {
            let row = BALANCES + 2 * axle;
            residuals[row..row + 2].copy_from_slice(&rows.residuals);
        }
        let ([a, b], [c, d]) = (front.wheels, rear.wheels);
        let energy = energy(held.car, parameters, &corners, &bars, &rockers);
        let (mass, cg) = masses.sprung;
        on_body.act(cg, -(acceleration * mass));
        let ride_heights = [0, 1].each(|axle| match held.car.ride_height_points[axle] {
            Some(point) => road.up.dot(road.up.constant(point)) - x[GROUND],
            None => zero.constant(f64::NAN),
        });
        let (air, pushes) = air(held.car, parameters, ride_heights);
        on_body.act_by_air(&air, &pushes, &road);
        residuals[BODY..].copy_from_slice(&on_body.residuals(held, &road));
        Balance {
            unknowns: x,
            road,
            wheels: [a, b, c, d],
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

/// Acceleration that the masses feel: that of the case, and gravity.
#[inline]
fn acceleration<T: Scalar>(road: &Road<T>, parameters: &Parameters<T>) -> Vector3<T> {
    let along = |own: BodyParameter| parameters.body(own);
    let az = along(BodyParameter::Az);
    road.forward * along(BodyParameter::Ax).scaled(GRAVITY)
        + road.left * along(BodyParameter::Ay).scaled(GRAVITY)
        + road.up * (az + az.one()).scaled(GRAVITY)
}

/// Resultant force of everything that acts on the car, and its moment about the origin.
struct Resultant<T> {
    force: Vector3<T>,
    moment: Vector3<T>,
}

impl<T: Scalar> Resultant<T> {
    fn act(&mut self, at: Vector3<T>, by: Vector3<T>) {
        self.force = self.force + by;
        self.moment = self.moment + at.cross(by);
    }

    /// Adds downforces and drag at their points.
    #[inline]
    fn act_by_air(&mut self, air: &[T; 3], points: &[Vector3<f64>; 3], road: &Road<T>) {
        for (point, size, direction) in [
            (points[0], air[0], -road.up),
            (points[1], air[1], -road.up),
            (points[2], air[2], -road.forward),
        ] {
            self.act(road.up.constant(point), direction * size);
        }
    }

    /// Computes the residuals of the body. Forces are along i, e and n; the roll moment is about the body's own x axis.
    fn residuals(&self, held: &Held<'_>, road: &Road<T>) -> [T; 6] {
        let inertia = held.car.yaw_inertia.unwrap_or(0.0) * held.case.yaw_acceleration;
        let force = self.force;
        let turning = road.up * force.x.constant(inertia * held.car.per_metre());
        let moment = self.moment - turning;
        [
            force.dot(road.forward),
            force.dot(road.left),
            force.dot(road.up),
            moment.x,
            moment.dot(road.left),
            moment.dot(road.up),
        ]
    }
}

/// Forces that the rest of the car applies to the wheels.
struct Supports<'a, T> {
    /// Shares of each wheel in the lateral and longitudinal force of its axle.
    shares: [[T; 2]; 4],
    static_loads: [T; 2],
    acceleration: Vector3<T>,
    bars: [T; 2],
    rockers: &'a [RockerForces<T>; 2],
}

impl<T: Scalar> Supports<'_, T> {
    /// Computes the balance of a wheel.
    fn wheel(
        &self,
        held: &Held<'_>,
        parameters: &Parameters<T>,
        number: usize,
        corner: Corner<T>,
        (road, x): (&Road<T>, &[T; UNKNOWNS]),
    ) -> Pushed<T> {
        let axle = number / 2;
        let unsprung = parameters
            .axle(axle, AxleParameter::UnsprungMass)
            .scaled(0.5);
        let source = held.case.setting.longitudinal;
        let share = held.car.longitudinal_share(axle, source, parameters);
        let warp = parameters.body(BodyParameter::Warp);
        let shares = self.shares[number];
        let forces = Forces {
            load: x[LOADS + number],
            side: x[SIDE_FORCES + axle] * shares[0],
            longitudinal: x[LONGITUDINAL] * share * shares[1],
            share: shares[0],
            bar: if corner.sign > 0.0 {
                self.bars[axle]
            } else {
                -self.bars[axle]
            },
            rocker: self.rockers[axle].work[number % 2],
            inertia: self.acceleration * unsprung,
            static_load: self.static_loads[axle],
        };
        let ground = match number {
            0 | 3 => x[GROUND] + warp,
            _ => x[GROUND] - warp,
        };
        wheel_balance(held, parameters, number, corner, (road, ground), &forces)
    }
}
