//! Parameters of a car and a case. Gradients are derivatives with respect to these parameters.

use super::{Car, Case};
use crate::axle::{Axle, AxleKind, Preloaded, RockerSprings};
use crate::model::Body;
use crate::number::{Each, Real, Vector3};

/// A parameter of one axle, for derivatives and design variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxleParameter {
    /// Change of the spring rates from the value in the study.
    SpringRate,
    /// Change of the spring forces in the design position from the value in the study.
    SpringForce,
    /// Rate of the anti-roll bar.
    BarRate,
    /// Rate of the heave spring.
    HeaveSpringRate,
    /// Force of the heave spring in the design position.
    HeaveSpringForce,
    /// Rate of the T-bar.
    TBarRate,
    /// Rate of the heave bar.
    HeaveBarRate,
    /// Torque of the heave bar in the design position.
    HeaveBarTorque,
    /// Rate of the tyres.
    TyreRate,
    /// Radius of the wheels.
    Radius,
    /// Mass of both wheels and of the parts that move with them.
    UnsprungMass,
    /// Forward coordinate of the axle's origin.
    OffsetX,
    /// Coordinate of the axle's origin to the left.
    OffsetY,
    /// Upward coordinate of the axle's origin.
    OffsetZ,
    /// Displacement of the rack towards the left wheel.
    Rack,
}

/// A parameter of the body or of the case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyParameter {
    /// Mass that the study gives: of the whole car, or the sprung mass.
    Mass,
    /// Forward coordinate of the centre of gravity.
    CgX,
    /// Coordinate of the centre of gravity to the left.
    CgY,
    /// Upward coordinate of the centre of gravity.
    CgZ,
    /// Fraction of the braking force on the front axle.
    BrakeShareFront,
    /// Fraction of the drive force on the front axle.
    DriveShareFront,
    /// Acceleration forward, g.
    Ax,
    /// Acceleration to the left, g.
    Ay,
    /// Acceleration upward, g.
    Az,
    /// Speed, m/s.
    Speed,
    /// Warp: height of the ground under the front left and the rear right wheel. The ground under the other two wheels
    /// is lower by the same height. The warp is 0 in every load case.
    Warp,
}

const OF_AXLE: usize = 15;
const COUNT: usize = 2 * OF_AXLE + 11;

impl AxleParameter {
    /// All variants in declaration order.
    pub const ALL: [AxleParameter; OF_AXLE] = [
        AxleParameter::SpringRate,
        AxleParameter::SpringForce,
        AxleParameter::BarRate,
        AxleParameter::HeaveSpringRate,
        AxleParameter::HeaveSpringForce,
        AxleParameter::TBarRate,
        AxleParameter::HeaveBarRate,
        AxleParameter::HeaveBarTorque,
        AxleParameter::TyreRate,
        AxleParameter::Radius,
        AxleParameter::UnsprungMass,
        AxleParameter::OffsetX,
        AxleParameter::OffsetY,
        AxleParameter::OffsetZ,
        AxleParameter::Rack,
    ];

    /// Returns true if an axle has the parameter. The check covers racks, springs between rockers and the rate of a twist
    /// beam. It does not cover missing springs at the wheels, anti-roll bars or tyre springs.
    pub fn is_of(self, axle: &Axle) -> bool {
        let rockers = &axle.setup.rocker_springs;
        match self {
            AxleParameter::HeaveSpringRate | AxleParameter::HeaveSpringForce => {
                rockers.heave_spring.is_some()
            }
            // In the formulas, a twist beam is a bar, but a study has no key for the rate of this bar.
            AxleParameter::BarRate => axle.kind() != AxleKind::TwistBeam,
            AxleParameter::TBarRate => rockers.t_bar.is_some(),
            AxleParameter::HeaveBarRate | AxleParameter::HeaveBarTorque => {
                rockers.heave_bar.is_some()
            }
            AxleParameter::Rack => {
                let mechanism = &axle.left.mechanism;
                let mut points = mechanism.points.iter();
                mechanism.axle_steering().is_some() || points.any(|point| point.body == Body::Rack)
            }
            _ => true,
        }
    }

    /// Returns the unit of the parameter in the study, and the program units per unit of the study. Program units are
    /// newtons, kilograms and the study's length unit.
    pub fn unit(self, car: &Car) -> (String, f64) {
        let (length, force) = (car.length_unit.symbol(), car.length_unit.force_symbol());
        let newtons = car.length_unit.newtons();
        match self {
            AxleParameter::SpringRate
            | AxleParameter::HeaveSpringRate
            | AxleParameter::TyreRate => (format!("{force}_per_{length}"), newtons),
            AxleParameter::BarRate | AxleParameter::TBarRate | AxleParameter::HeaveBarRate => {
                (format!("{force}_{length}_per_rad"), newtons)
            }
            AxleParameter::SpringForce | AxleParameter::HeaveSpringForce => {
                (force.to_owned(), newtons)
            }
            AxleParameter::HeaveBarTorque => (format!("{force}_{length}"), newtons),
            AxleParameter::UnsprungMass => {
                (car.mass_unit.symbol().to_owned(), car.mass_unit.kilograms())
            }
            AxleParameter::Radius
            | AxleParameter::OffsetX
            | AxleParameter::OffsetY
            | AxleParameter::OffsetZ
            | AxleParameter::Rack => (length.to_owned(), 1.0),
        }
    }
}

/// A parameter of a car and a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Parameter of an axle; 0 is the front axle.
    Axle(usize, AxleParameter),
    /// Parameter of the body or the case.
    Body(BodyParameter),
}

impl Parameter {
    /// Number of all parameters of a car and a case.
    pub const COUNT: usize = COUNT;

    /// Index of the parameter among all parameters.
    pub fn place(self) -> usize {
        match self {
            Parameter::Axle(axle, own) => axle * OF_AXLE + own as usize,
            Parameter::Body(own) => 2 * OF_AXLE + own as usize,
        }
    }
}

/// Values of all parameters.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<T>(pub [T; COUNT]);

impl Parameters<f64> {
    /// Collects the values of a car in a case. Parameters that the car does not have are zero; a missing radius is NaN.
    pub fn of(car: &Car, case: &Case) -> Self {
        let mut values = [0.0; COUNT];
        let mut set = |parameter: Parameter, value: f64| values[parameter.place()] = value;
        for (number, axle) in car.axles.iter().enumerate() {
            let setup = &axle.setup;
            let tyre = car.tyres.map_or(0.0, |tyres| tyres[number].rate);
            let offset = match number {
                0 => Vector3::default(),
                _ => car.rear_offset,
            };
            let rockers = &setup.rocker_springs;
            let preloaded = |law: Option<Preloaded>| law.map_or([0.0; 2], |l| [l.rate, l.load]);
            let [heave_rate, heave_force] = preloaded(rockers.heave_spring);
            let [heave_bar_rate, heave_bar_torque] = preloaded(rockers.heave_bar);
            let own = [
                (AxleParameter::HeaveSpringRate, heave_rate),
                (AxleParameter::HeaveSpringForce, heave_force),
                (AxleParameter::TBarRate, rockers.t_bar.unwrap_or(0.0)),
                (AxleParameter::HeaveBarRate, heave_bar_rate),
                (AxleParameter::HeaveBarTorque, heave_bar_torque),
                (AxleParameter::Rack, case.racks[number]),
                (AxleParameter::BarRate, setup.bar_rate.unwrap_or(0.0)),
                (AxleParameter::TyreRate, tyre),
                (
                    AxleParameter::Radius,
                    setup.wheel_radius.unwrap_or(f64::NAN),
                ),
                (
                    AxleParameter::UnsprungMass,
                    setup.unsprung_mass.unwrap_or(0.0),
                ),
                (AxleParameter::OffsetX, offset.x),
                (AxleParameter::OffsetY, offset.y),
                (AxleParameter::OffsetZ, offset.z),
            ];
            for (parameter, value) in own {
                set(Parameter::Axle(number, parameter), value);
            }
        }
        let body = [
            (BodyParameter::Mass, car.mass),
            (BodyParameter::CgX, car.cg.x),
            (BodyParameter::CgY, car.cg.y),
            (BodyParameter::CgZ, car.cg.z),
            (
                BodyParameter::BrakeShareFront,
                car.brake_share_front.unwrap_or(0.0),
            ),
            (
                BodyParameter::DriveShareFront,
                car.drive_share_front.unwrap_or(0.0),
            ),
            (BodyParameter::Ax, case.ax),
            (BodyParameter::Ay, case.ay),
            (BodyParameter::Az, case.az),
            (BodyParameter::Speed, case.speed),
            (BodyParameter::Warp, 0.0),
        ];
        for (parameter, value) in body {
            set(Parameter::Body(parameter), value);
        }
        Parameters(values)
    }
}

impl<T: Copy> Parameters<T> {
    /// Value of an axle's parameter. Index 0 is the front axle.
    #[inline(always)]
    pub fn axle(&self, axle: usize, parameter: AxleParameter) -> T {
        self.0[Parameter::Axle(axle, parameter).place()]
    }

    /// Value of a parameter of the body or the case.
    #[inline(always)]
    pub fn body(&self, parameter: BodyParameter) -> T {
        self.0[Parameter::Body(parameter).place()]
    }

    /// Converts the values to another number type.
    pub fn map<U: Copy>(&self, f: impl FnMut(T) -> U) -> Parameters<U> {
        Parameters(self.0.each(f))
    }
}

impl<T: Real> Parameters<T> {
    /// Position of an axle's origin: its coordinates forward, to the left and upward.
    #[inline(always)]
    pub(super) fn offset(&self, axle: usize) -> Vector3<T> {
        use AxleParameter::{OffsetX, OffsetY, OffsetZ};
        Vector3::from([OffsetX, OffsetY, OffsetZ].each(|parameter| self.axle(axle, parameter)))
    }

    /// Returns the laws of the springs between the rockers of an axle.
    #[inline(always)]
    pub(super) fn rocker_springs(&self, car: &Car, axle: usize) -> RockerSprings<T> {
        use AxleParameter::{
            HeaveBarRate, HeaveBarTorque, HeaveSpringForce, HeaveSpringRate, TBarRate,
        };
        let own = &car.axles[axle].setup.rocker_springs;
        let preloaded = |load, rate| Preloaded {
            load: self.axle(axle, load),
            rate: self.axle(axle, rate),
        };
        RockerSprings {
            heave_spring: own
                .heave_spring
                .map(|_| preloaded(HeaveSpringForce, HeaveSpringRate)),
            t_bar: own.t_bar.map(|_| self.axle(axle, TBarRate)),
            heave_bar: own
                .heave_bar
                .map(|_| preloaded(HeaveBarTorque, HeaveBarRate)),
        }
    }

    /// Centre of gravity as given in the study: of the whole car, or of the sprung mass.
    #[inline(always)]
    pub(super) fn cg(&self) -> Vector3<T> {
        use BodyParameter::{CgX, CgY, CgZ};
        Vector3::from([CgX, CgY, CgZ].each(|parameter| self.body(parameter)))
    }
}
