//! Parts of a car that design variables change.

use super::parameters::{AxleParameter, BodyParameter, Parameter};
use super::{Car, CarGradient};
use crate::axle::Law;
use crate::model::{Axis, PointId};

/// Part of the car that a design variable changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Moves {
    /// Coordinates of hardpoints, in the axes of the axle's study.
    Hardpoints(Vec<PointMove>),
    /// Rate of a part of an axle.
    Rate {
        /// Index of the axle.
        axle: usize,
        /// Parameter of the axle.
        parameter: AxleParameter,
    },
    /// Parameter of the body, in the axes of the front axle's study.
    Body(BodyParameter),
    /// Wheelbase of the car.
    Wheelbase,
}

/// Coordinate of a hardpoint. It changes on both wheels of an axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMove {
    /// Index of the axle; 0 is the front axle.
    pub axle: usize,
    /// Hardpoint that moves.
    pub point: PointId,
    /// Axis along which the hardpoint moves.
    pub axis: Axis,
    /// Displacement per unit of the variable.
    pub factor: f64,
}

impl PointMove {
    /// Returns the sign that converts the study's axis to the kernel's axis.
    fn sign(&self, car: &Car) -> f64 {
        car.axles[self.axle].left.frame.sign(self.axis)
    }
}

/// Design variable of a car. For hardpoints the variable is an offset, for other parts it is a value.
#[derive(Clone, Debug, PartialEq)]
pub struct CarVariable {
    /// Part of the car that the variable changes.
    pub moves: Moves,
    /// Lowest and highest value of the variable, in the study's unit.
    pub range: [f64; 2],
}

impl Moves {
    /// Returns the axis, if the parameter is a coordinate of the centre of gravity; `None` for other parameters.
    fn axis(parameter: BodyParameter) -> Option<Axis> {
        match parameter {
            BodyParameter::CgX => Some(Axis::X),
            BodyParameter::CgY => Some(Axis::Y),
            BodyParameter::CgZ => Some(Axis::Z),
            _ => None,
        }
    }

    /// Returns the sign that converts the study's axis to the kernel's axis, for a parameter of the body.
    pub(super) fn sign(parameter: BodyParameter, car: &Car) -> f64 {
        Moves::axis(parameter).map_or(1.0, |axis| car.axles[0].left.frame.sign(axis))
    }

    /// Coordinates of hardpoints that the variable moves; empty for other variables.
    pub fn points(&self) -> &[PointMove] {
        match self {
            Moves::Hardpoints(points) => points,
            _ => &[],
        }
    }

    /// Returns true if these moves of hardpoints change the distance along x between the wheel centres of the two
    /// axles.
    pub(crate) fn changes_wheelbase(&self, car: &Car) -> bool {
        let change = |at: &PointMove| {
            let is_centre = at.point == car.axles[at.axle].left.mechanism.wheel_centre;
            if is_centre && at.axis == Axis::X {
                [1.0, -1.0][at.axle] * at.sign(car) * at.factor
            } else {
                0.0
            }
        };
        self.points().iter().map(change).sum::<f64>() != 0.0
    }

    /// Returns the names of the hardpoints. Each name starts with its axle and `separator`. Also returns the axis, if
    /// all hardpoints move along the same axis.
    fn names(&self, car: &Car, separator: char) -> (String, Option<Axis>) {
        let points = self.points();
        let name = |at: &PointMove| {
            let name = car.axles[at.axle].left.mechanism.name(at.point);
            format!("{}{separator}{name}", crate::car::AXLE_NAMES[at.axle])
        };
        let mut names: Vec<String> = points.iter().map(name).collect();
        // A point that moves in several coordinates is listed once.
        names.dedup();
        let first = points.first().map(|at| at.axis);
        let axis = first.filter(|axis| points.iter().all(|at| at.axis == *axis));
        (names.join("+"), axis)
    }

    /// Returns the program units per unit of the study, for example newtons per pound-force or kilograms per pound.
    pub(super) fn written_unit(&self, car: &Car) -> f64 {
        match self {
            Moves::Rate { parameter, .. } => parameter.unit(car).1,
            Moves::Body(BodyParameter::Mass) => car.mass_unit.kilograms(),
            Moves::Hardpoints(_) | Moves::Body(_) | Moves::Wheelbase => 1.0,
        }
    }

    /// Returns the variable's value in a car, in the study's unit; 0 for an offset of hardpoints. `None` if the car has
    /// no such value.
    pub fn value(&self, car: &Car) -> Option<f64> {
        Some(self.internal(car)? / self.written_unit(car))
    }

    /// Returns the variable's value in a car, in program units: newtons, kilograms and the study's length unit.
    fn internal(&self, car: &Car) -> Option<f64> {
        match *self {
            Moves::Hardpoints(_) => Some(0.0),
            Moves::Rate { axle, parameter } => {
                let setup = &car.axles[axle].setup;
                match parameter {
                    AxleParameter::SpringRate => setup.springs.as_ref()?[0].rate(),
                    _ if !parameter.is_of(&car.axles[axle]) => None,
                    AxleParameter::BarRate => setup.bar_rate,
                    AxleParameter::HeaveSpringRate => Some(setup.rocker_springs.heave_spring?.rate),
                    AxleParameter::TBarRate => setup.rocker_springs.t_bar,
                    AxleParameter::HeaveBarRate => Some(setup.rocker_springs.heave_bar?.rate),
                    AxleParameter::TyreRate => Some(car.tyres?[axle].rate),
                    _ => None,
                }
            }
            Moves::Body(parameter) => {
                let sign = Moves::sign(parameter, car);
                match parameter {
                    BodyParameter::Mass => Some(car.mass),
                    BodyParameter::CgX => Some(sign * car.cg.x),
                    BodyParameter::CgY => Some(sign * car.cg.y),
                    BodyParameter::CgZ => Some(sign * car.cg.z),
                    BodyParameter::BrakeShareFront => car.brake_share_front,
                    BodyParameter::DriveShareFront => car.drive_share_front,
                    _ => None,
                }
            }
            Moves::Wheelbase => {
                let mid = |axle: usize| car.axles[axle].mean_wheel_centre().x;
                Some(mid(0) - mid(1) - car.rear_offset.x)
            }
        }
    }

    /// Sets the car's parameter to a value, or moves its hardpoints by that value.
    pub fn apply(&self, value: f64, car: &mut Car) {
        self.change(self.now(car), value, car);
    }

    /// Returns the variable's value in a car, in program units; 0 if the car has no such value.
    fn now(&self, car: &Car) -> f64 {
        self.internal(car).unwrap_or(0.0)
    }

    /// Sets the car's parameter from the value `now`, in program units, to a value. Moves hardpoints by that value.
    fn change(&self, now: f64, value: f64, car: &mut Car) {
        let value = value * self.written_unit(car);
        match *self {
            Moves::Hardpoints(ref points) => move_points(points, value, car),
            Moves::Rate { axle, parameter } => {
                let setup = &mut car.axles[axle].setup;
                match parameter {
                    AxleParameter::SpringRate => {
                        for law in setup.springs.iter_mut().flatten() {
                            if let Law::Linear { rate, .. } = &mut law.spring {
                                *rate += value - now;
                            }
                        }
                    }
                    AxleParameter::BarRate => setup.bar_rate = Some(value),
                    AxleParameter::TBarRate => setup.rocker_springs.t_bar = Some(value),
                    AxleParameter::HeaveSpringRate => {
                        if let Some(law) = &mut setup.rocker_springs.heave_spring {
                            law.rate = value;
                        }
                    }
                    AxleParameter::HeaveBarRate => {
                        if let Some(law) = &mut setup.rocker_springs.heave_bar {
                            law.rate = value;
                        }
                    }
                    _ => {
                        if let Some(tyres) = &mut car.tyres {
                            tyres[axle].rate = value;
                        }
                    }
                }
            }
            Moves::Body(parameter) => {
                let signed = Moves::sign(parameter, car) * value;
                match parameter {
                    BodyParameter::Mass => car.mass = value,
                    BodyParameter::CgX => car.cg.x = signed,
                    BodyParameter::CgY => car.cg.y = signed,
                    BodyParameter::CgZ => car.cg.z = signed,
                    BodyParameter::BrakeShareFront => car.brake_share_front = Some(value),
                    _ => car.drive_share_front = Some(value),
                }
            }
            Moves::Wheelbase => car.rear_offset.x -= value - now,
        }
    }

    /// Returns the name of the variable in columns, without the unit: `front_tie_rod_inner_dz`,
    /// `rear_anti_roll_bar_rate`, `car_cg_z`.
    pub fn stem(&self, car: &Car) -> String {
        if self.points().is_empty() {
            return self.label(car).replace('.', "_");
        }
        match self.names(car, '_') {
            (names, Some(axis)) => format!("{names}_d{}", axis.name()),
            (names, None) => format!("{names}_along"),
        }
    }

    /// Unit of the variable; empty for a fraction.
    pub fn unit(&self, car: &Car) -> String {
        let length = car.length_unit.symbol();
        match self {
            Moves::Hardpoints(_) | Moves::Wheelbase => length.to_owned(),
            Moves::Rate { parameter, .. } => parameter.unit(car).0,
            Moves::Body(BodyParameter::Mass) => car.mass_unit.symbol().to_owned(),
            Moves::Body(parameter) if Moves::axis(*parameter).is_some() => length.to_owned(),
            Moves::Body(_) => String::new(),
        }
    }

    /// Returns the parameter that the variable changes, and its change per unit of the study. `None` for hardpoints.
    pub(crate) fn direction(&self, car: &Car) -> Option<(Parameter, f64)> {
        let (parameter, rate) = match *self {
            Moves::Hardpoints(_) => return None,
            Moves::Rate { axle, parameter } => (Parameter::Axle(axle, parameter), 1.0),
            Moves::Body(parameter) => (Parameter::Body(parameter), Moves::sign(parameter, car)),
            Moves::Wheelbase => (Parameter::Axle(1, AxleParameter::OffsetX), -1.0),
        };
        Some((parameter, rate * self.written_unit(car)))
    }

    /// Derivative of a result with respect to the variable, per unit of the study.
    pub fn slope(&self, car: &Car, gradient: &CarGradient) -> f64 {
        match self.direction(car) {
            Some((parameter, rate)) => rate * gradient.parameters[parameter.place()],
            None => {
                let slope = |at: &PointMove| {
                    let along = gradient.hardpoints[at.axle][at.point.0][at.axis];
                    at.sign(car) * at.factor * along
                };
                self.points().iter().map(slope).sum()
            }
        }
    }

    /// Label of the variable for messages and tables.
    pub fn label(&self, car: &Car) -> String {
        let end = |axle: usize| crate::car::AXLE_NAMES[axle];
        match *self {
            Moves::Hardpoints(_) => match self.names(car, '.') {
                (names, Some(axis)) => format!("{names}.{}", axis.name()),
                (names, None) => names,
            },
            Moves::Rate { axle, parameter } => format!("{}.{}", end(axle), rate_key(parameter)),
            Moves::Body(parameter) => format!("car.{}", body_key(parameter)),
            Moves::Wheelbase => "car.wheelbase".to_owned(),
        }
    }
}

/// Moves hardpoints of the axles by `value` units of the variable.
fn move_points(points: &[PointMove], value: f64, car: &mut Car) {
    for end in [0, 1] {
        let own: Vec<&PointMove> = points.iter().filter(|at| at.axle == end).collect();
        if own.is_empty() {
            continue;
        }
        let mut left = car.axles[end].left.design.clone();
        for at in own {
            left[at.point.0][at.axis] += at.sign(car) * at.factor * value;
        }
        let axle = &mut car.axles[end];
        axle.complete(&mut left);
        let right = axle.right_design(&left).map(|points| points.collect());
        if let (Some(wheel), Some(design)) = (&mut axle.right, right) {
            wheel.design = design;
        }
        axle.left.design = left;
    }
}

/// Key of a parameter in an axle's study. The axle's origin and the rack have no key there; the function returns a name
/// for them.
pub fn rate_key(parameter: AxleParameter) -> &'static str {
    match parameter {
        AxleParameter::SpringRate => "spring.rate",
        AxleParameter::SpringForce => "spring.force",
        AxleParameter::BarRate => "anti_roll_bar.rate",
        AxleParameter::HeaveSpringRate => "heave_spring.rate",
        AxleParameter::HeaveSpringForce => "heave_spring.force",
        AxleParameter::TBarRate => "t_bar.rate",
        AxleParameter::HeaveBarRate => "heave_bar.rate",
        AxleParameter::HeaveBarTorque => "heave_bar.torque",
        AxleParameter::TyreRate => "tyre.rate",
        AxleParameter::Radius => "wheel.radius",
        AxleParameter::UnsprungMass => "vehicle.unsprung_mass",
        AxleParameter::OffsetX => "offset_x",
        AxleParameter::OffsetY => "offset_y",
        AxleParameter::OffsetZ => "offset_z",
        AxleParameter::Rack => "rack",
    }
}

/// Returns the name of a parameter of the body or the case.
pub fn body_key(parameter: BodyParameter) -> &'static str {
    match parameter {
        BodyParameter::Mass => "mass",
        BodyParameter::CgX => "cg_x",
        BodyParameter::CgY => "cg_y",
        BodyParameter::CgZ => "cg_z",
        BodyParameter::BrakeShareFront => "brake_share_front",
        BodyParameter::DriveShareFront => "drive_share_front",
        BodyParameter::Ax => "ax",
        BodyParameter::Ay => "ay",
        BodyParameter::Az => "az",
        BodyParameter::Speed => "speed",
        BodyParameter::Warp => "warp",
    }
}

/// Returns the car with its variables at the values `x`. The order of the variables does not matter: each one changes the given
/// car. So a variable for the wheelbase moves the rear axle without regard to wheel centres that other variables move.
pub fn moved(car: &Car, variables: &[CarVariable], x: &[f64]) -> Car {
    let mut moved = car.clone();
    for (variable, value) in variables.iter().zip(x) {
        let now = variable.moves.now(car);
        variable.moves.change(now, *value, &mut moved);
    }
    moved
}
