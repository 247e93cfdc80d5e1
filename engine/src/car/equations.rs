//! Equations of equilibrium of a car: equations (1) to (9) of [`super`].

mod body;
mod wheel;

use super::corner::Corner;
use super::parameters::{BodyParameter, Parameters};
use super::road::Road;
use super::{Car, Case, GRAVITY};
use crate::axle::RockerForces;
use crate::number::{Each, Local, Scalar, Vector3, outlined};
use body::{CarMasses, air, bar_torque, energy, shares};
pub(super) use body::{masses, static_loads};
use wheel::{Forces, load_parts, travel_residuals};
pub(super) use wheel::{Placed, Stance};

/// Number of unknowns, and also of equations.
pub const UNKNOWNS: usize = 14;

/// Index of each unknown in x of [`super`]: roll, pitch, height of the ground, travels, wheel loads, tyre force factors.
pub(super) const ROLL: usize = 0;
pub(super) const PITCH: usize = 1;
pub(super) const GROUND: usize = 2;
pub(super) const TRAVELS: usize = 3;
pub(super) const LOADS: usize = 7;
pub(super) const SIDE_FORCES: usize = 11;
pub(super) const LONGITUDINAL: usize = 13;

/// Index of the first equation of each group: contacts of the wheels, travels of the wheels, whole car.
pub(super) const CONTACTS: usize = 0;
pub(super) const BALANCES: usize = 4;
pub(super) const BODY: usize = 8;
/// Indices of three equations of the whole car, (8) of [`super`]: vertical force, roll moment, pitch moment.
pub(super) const VERTICAL: usize = 10;
pub(super) const ROLL_MOMENT: usize = 11;
pub(super) const PITCH_MOMENT: usize = 12;
/// Indices of the equations that prescribe these unknowns in a motion of the body: height gamma, roll phi, pitch theta.
/// Index 0 is the first equation that replaces an equation (8) of [`super`].
pub(super) const HELD_ROWS: [usize; 3] = [2, 0, 1];

/// Inputs that stay fixed while the solver changes the unknowns.
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
    /// Components of the load by equation (9) of [`super`]: elastic, geometric, longitudinal, unsprung.
    pub parts: [T; 4],
    /// Lateral force S, to the left.
    pub side_force: T,
    /// Longitudinal force X, positive forward.
    pub longitudinal_force: T,
    /// Fraction f of the axle's lateral force that this wheel carries, by equation (3) of [`super`].
    pub share: T,
    /// Unit vector along which longitudinal forces act.
    pub heading: Vector3<T>,
    /// Unit vector along which lateral forces act.
    pub across: Vector3<T>,
    /// Contact point C, in the car's axes.
    pub contact: Vector3<T>,
    /// Velocity C' of the carrier's point at the contact point, with respect to the wheel's own travel.
    pub contact_rate: Vector3<T>,
    /// Velocity of the carrier's point at the contact point, with respect to the other wheel's travel. Only for a solid
    /// axle or twist beam.
    pub contact_by_other: Option<Vector3<T>>,
    /// Loaded radius of the tyre.
    pub radius: T,
    /// Height of the wheel's lowest point over the ground, with the tyre not compressed.
    pub gap: T,
    /// Force of the spring and its stops.
    pub spring_force: T,
    /// Gaps of the bump stop and the rebound stop in the design position, if present.
    pub stop_gaps: [Option<f64>; 2],
}

/// A state of the car with its forces.
#[derive(Clone, Copy, Debug)]
pub struct Balance<T> {
    /// Values of the unknowns x of [`super`].
    pub unknowns: [T; UNKNOWNS],
    /// Directions of the ground in the body's axes.
    pub road: Road<T>,
    /// The wheels: front left, front right, rear left, rear right.
    pub wheels: [WheelState<T>; 4],
    /// Sprung mass, and its centre of gravity.
    pub sprung: (T, Vector3<T>),
    /// Mass of the whole car, and its centre of gravity.
    pub whole: (T, Vector3<T>),
    /// Mean of the four contact points in the design position.
    pub design_contact: Vector3<T>,
    /// Downforces near the front and the rear axle, and the drag, in this order.
    pub air: [T; 3],
    /// Heights of the ride-height points; NaN without such a point.
    pub ride_heights: [T; 2],
    /// Torque of each axle's anti-roll bar: [front, rear].
    pub bars: [T; 2],
    /// Forces of the springs between the rockers of each axle.
    pub rockers: [RockerForces<T>; 2],
    /// Energy of springs, stops and bars, relative to the design position.
    pub energy: T,
    /// Residuals of all equations, in the order of the equations.
    pub residuals: [T; UNKNOWNS],
    /// True for each lifted wheel: front left, front right, rear left, rear right.
    pub lifted: [bool; 4],
}

/// Masses, ground, wheels and forces of a state.
struct Assembled<T> {
    masses: CarMasses<T>,
    ground: Ground<T>,
    placed: [Placed<T>; 4],
    body: Body<T>,
    loaded: Loaded<T>,
}

impl<T: Scalar> Assembled<T> {
    /// Computes masses, ground, wheels and forces of a state. `corners` are the wheels at the travels that `x`
    /// contains.
    fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        corners: &[Corner<T>; 4],
        x: &[T; UNKNOWNS],
    ) -> Self {
        let masses = masses(held.car, parameters, corners);
        let static_loads = static_loads(held.car, parameters, corners, &masses);
        let ground = Ground::of(parameters, [x[ROLL], x[PITCH], x[GROUND]]);
        let placed = [0, 1, 2, 3].map(|number| {
            let static_load = static_loads[number / 2];
            let corner = corners[number];
            Placed::of(held, parameters, number, corner, &ground, static_load)
        });
        let stances = placed.each_ref().each(|placed| &placed.stance);
        let body = Body::of(held, parameters, &ground, masses.sprung);
        let wheels = (stances, &body.resultant);
        let loaded = Loaded::of(held, parameters, &ground.road, wheels, x);
        Assembled {
            masses,
            ground,
            placed,
            body,
            loaded,
        }
    }
}

/// Computes the residuals of the equations, as [`Balance::of`] does.
pub(super) fn residuals<T: Scalar>(
    held: &Held<'_>,
    parameters: &Parameters<T>,
    corners: [Corner<T>; 4],
    x: &[T; UNKNOWNS],
) -> [T; UNKNOWNS] {
    Assembled::of(held, parameters, &corners, x)
        .loaded
        .residuals
}

impl<T: Scalar> Balance<T> {
    /// Computes forces and residuals of a state. `corners` are the wheels at the travels that `x` contains.
    pub(super) fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        corners: [Corner<T>; 4],
        x: [T; UNKNOWNS],
    ) -> Self {
        let Assembled {
            masses,
            ground,
            placed,
            body,
            loaded,
        } = Assembled::of(held, parameters, &corners, &x);
        let stances = placed.each_ref().each(|placed| &placed.stance);
        let parts = loaded.parts(stances);
        let wheels = [0, 1, 2, 3].each(|number| {
            placed[number].under(held, number / 2, &loaded.forces[number], parts[number])
        });
        Balance {
            unknowns: x,
            road: ground.road,
            wheels,
            sprung: masses.sprung,
            whole: masses.whole,
            design_contact: masses.design_contact,
            air: body.air,
            ride_heights: body.ride_heights,
            bars: loaded.bars,
            rockers: loaded.rockers,
            energy: energy(
                held.car,
                parameters,
                &corners,
                &loaded.bars,
                &loaded.rockers,
            ),
            residuals: loaded.residuals,
            lifted: held.lifted,
        }
    }
}

/// Ground under a car, and the acceleration of the car's masses, including gravity.
pub(super) struct Ground<T> {
    /// Directions of the ground in the body's axes.
    pub road: Road<T>,
    /// Height gamma of the ground.
    pub height: T,
    /// Acceleration of all masses, including gravity: alpha of equation (7) of [`super`].
    pub acceleration: Vector3<T>,
}

impl<T: Local> Ground<T> {
    /// Computes the ground relative to a body with this roll and pitch. The last number is the height of the ground.
    #[inline(always)]
    pub(super) fn of(parameters: &Parameters<T>, [roll, pitch, height]: [T; 3]) -> Self {
        let road = Road::under(roll, pitch);
        let along = |own: BodyParameter| parameters.body(own);
        let az = along(BodyParameter::Az);
        Ground {
            acceleration: road.forward * along(BodyParameter::Ax).scaled(GRAVITY)
                + road.left * along(BodyParameter::Ay).scaled(GRAVITY)
                + road.up * (az + az.one()).scaled(GRAVITY),
            road,
            height,
        }
    }
}

/// Resultant of forces on the car, and the moment of these forces about the origin.
#[derive(Clone, Copy)]
pub(super) struct Resultant<T> {
    force: Vector3<T>,
    moment: Vector3<T>,
}

impl<T: Copy> Resultant<T> {
    /// Converts all numbers to another number type.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Resultant<U> {
        Resultant {
            force: self.force.map(f),
            moment: self.moment.map(f),
        }
    }
}

impl<T: Local> Resultant<T> {
    #[inline(always)]
    fn zero(zero: T) -> Self {
        let none = Vector3::new(zero, zero, zero);
        Resultant {
            force: none,
            moment: none,
        }
    }

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.force = self.force + other.force;
        self.moment = self.moment + other.moment;
    }

    #[inline(always)]
    fn act(&mut self, at: Vector3<T>, by: Vector3<T>) {
        self.force = self.force + by;
        self.moment = self.moment + at.cross(by);
    }

    /// Computes the residuals of the equations of the whole car, (8) of [`super`]. Forces are along i (forward), e (left)
    /// and n (up). The roll moment is about the body's own x axis.
    #[inline(always)]
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

/// Forces on the body, except the forces from its wheels.
pub(super) struct Body<T> {
    /// Resultant of the sprung mass's inertia force and weight, and of the aerodynamic forces.
    pub resultant: Resultant<T>,
    air: [T; 3],
    ride_heights: [T; 2],
}

impl<T: Local> Body<T> {
    /// Computes the inertia force and the weight of the sprung mass, and the aerodynamic forces. The last argument
    /// contains the sprung mass and its centre of gravity.
    #[inline(always)]
    pub(super) fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        ground: &Ground<T>,
        (mass, cg): (T, Vector3<T>),
    ) -> Self {
        let road = &ground.road;
        let zero = ground.height.zero();
        let mut resultant = Resultant::zero(zero);
        resultant.act(cg, -(ground.acceleration * mass));
        let ride_heights = [0, 1].each(|axle| match held.car.ride_height_points[axle] {
            Some(point) => road.up.dot(road.up.constant(point)) - ground.height,
            None => zero.constant(f64::NAN),
        });
        let (air, points) = air(held.car, parameters, ride_heights);
        if held.car.air.is_some() {
            for (point, size, direction) in [
                (points[0], air[0], -road.up),
                (points[1], air[1], -road.up),
                (points[2], air[2], -road.forward),
            ] {
                resultant.act(road.up.constant(point), direction * size);
            }
        }
        Body {
            resultant,
            air,
            ride_heights,
        }
    }
}

/// Forces of the wheels, and the residuals of all equations.
pub(super) struct Loaded<T> {
    forces: [Forces<T>; 4],
    /// Torque of each axle's anti-roll bar: [front, rear].
    bars: [T; 2],
    /// Forces of the springs between the rockers of each axle.
    rockers: [RockerForces<T>; 2],
    /// Residuals of all equations, in the order of the equations.
    pub residuals: [T; UNKNOWNS],
}

impl<T: Local> Loaded<T> {
    /// Returns the components of the wheel loads by equation (9) of [`super`]: elastic, geometric, longitudinal,
    /// unsprung.
    #[inline(always)]
    pub(super) fn parts(&self, wheels: [&Stance<T>; 4]) -> [[T; 4]; 4] {
        let [a, b, c, d] = wheels;
        let [on_a, on_b, on_c, on_d] = &self.forces;
        let [a, b] = load_parts([a, b], [on_a, on_b]);
        let [c, d] = load_parts([c, d], [on_c, on_d]);
        [a, b, c, d]
    }

    /// Computes the forces of the wheels and all residuals at the unknowns `x`. The arguments contain the wheels and
    /// the other forces on the body at these unknowns.
    #[inline(always)]
    pub(super) fn of(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        road: &Road<T>,
        (wheels, on_body): ([&Stance<T>; 4], &Resultant<T>),
        x: &[T; UNKNOWNS],
    ) -> Self {
        outlined!(
            [T: Local] x[0];
            held: &'p Held<'p> = held, parameters: &'p Parameters<T> = parameters, road: &'p Road<T> = road,
            wheels: [&'p Stance<T>; 4] = wheels, on_body: &'p Resultant<T> = on_body,
            x: &'p [T; UNKNOWNS] = x => Loaded<T> {
                Loaded::inlined(held, parameters, road, (wheels, on_body), x)
            }
        )
    }

    #[inline(always)]
    fn inlined(
        held: &Held<'_>,
        parameters: &Parameters<T>,
        road: &Road<T>,
        (wheels, on_body): ([&Stance<T>; 4], &Resultant<T>),
        x: &[T; UNKNOWNS],
    ) -> Self {
        let car = held.car;
        let zero = x[0].zero();
        let (mut bars, mut rockers) = ([zero; 2], [RockerForces::none(zero); 2]);
        for axle in 0..2 {
            let [left, right] = [wheels[2 * axle], wheels[2 * axle + 1]];
            bars[axle] = bar_torque(car, parameters, axle, [left.bar, right.bar]);
            if let (Some(left), Some(right)) = (left.rocker, right.rocker) {
                rockers[axle] = parameters.rocker_springs(car, axle).forces(&[left, right]);
            }
        }
        let source = held.case.setting.longitudinal;
        let mut forces = [Forces::none(zero); 4];
        for (number, forces) in forces.iter_mut().enumerate() {
            let axle = number / 2;
            let share = car.longitudinal_share(axle, source, parameters);
            let [lateral, longitudinal] = shares(held, x, number);
            *forces = Forces {
                load: x[LOADS + number],
                side: x[SIDE_FORCES + axle] * lateral,
                longitudinal: x[LONGITUDINAL] * share * longitudinal,
                share: lateral,
                bar: match number % 2 {
                    0 => bars[axle],
                    _ => -bars[axle],
                },
                rocker: rockers[axle].work[number % 2],
            };
        }
        let mut residuals = [x[0].zero(); UNKNOWNS];
        let mut sum = *on_body;
        for (number, (wheel, forces)) in wheels.iter().zip(&forces).enumerate() {
            residuals[CONTACTS + number] = wheel.contact_residual(forces.load);
            let by_tyre = road.up * forces.load
                + wheel.across * forces.side
                + wheel.heading * forces.longitudinal;
            sum.act(wheel.at, by_tyre);
            sum.add(&wheel.inertia);
        }
        for left in [0, 2] {
            let right = left + 1;
            let pair = [&forces[left], &forces[right]];
            let rows = travel_residuals([wheels[left], wheels[right]], pair);
            residuals[BALANCES + left..BALANCES + left + 2].copy_from_slice(&rows);
        }
        residuals[BODY..].copy_from_slice(&sum.residuals(held, road));
        Loaded {
            forces,
            bars,
            rockers,
            residuals,
        }
    }
}
