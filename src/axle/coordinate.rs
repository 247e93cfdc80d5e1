//! The numbers that say where an axle is, and as what a study writes them.

use super::{Axle, Course, WheelMotion};
use crate::model::{Axis, LengthUnit};

/// One of the numbers that a motion of an axle is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Roll angle of the body.
    Roll,
    /// Mean travel of the wheel centres.
    Heave,
    /// Travel of the left wheel.
    TravelLeft,
    /// Travel of the right wheel.
    TravelRight,
    /// Displacement of the rack.
    Rack,
    /// Angle of the steering wheel.
    SteeringWheel,
}

impl Coordinate {
    /// All of them.
    pub const ALL: [Coordinate; 6] = [
        Coordinate::Roll,
        Coordinate::Heave,
        Coordinate::TravelLeft,
        Coordinate::TravelRight,
        Coordinate::Rack,
        Coordinate::SteeringWheel,
    ];

    /// Its key in `[motion]`.
    pub fn key(self) -> &'static str {
        match self {
            Coordinate::Roll => "roll",
            Coordinate::Heave => "heave",
            Coordinate::TravelLeft => "travel_left",
            Coordinate::TravelRight => "travel_right",
            Coordinate::Rack => "rack",
            Coordinate::SteeringWheel => "steering_wheel_angle",
        }
    }

    /// Its column in results.
    pub fn column(self, length: LengthUnit) -> String {
        match self {
            Coordinate::Roll | Coordinate::SteeringWheel => format!("{}_deg", self.key()),
            _ => format!("{}_{}", self.key(), length.symbol()),
        }
    }

    /// What a value as the study writes it (degrees, lengths along the study's axes) is in a [`Course`]: the
    /// angle of the steering wheel becomes the displacement of the rack that it makes.
    pub fn in_course(self, written: f64, axle: &Axle) -> f64 {
        match self {
            Coordinate::Roll => written.to_radians(),
            Coordinate::Rack => written * axle.left.frame.sign(Axis::Y),
            Coordinate::SteeringWheel => axle.setup.c_factor.unwrap_or(f64::NAN) * written / 360.0,
            _ => written,
        }
    }
}

impl Course {
    /// The values of a coordinate; none of one that this course does not have. The rack and the steering wheel
    /// are the same.
    pub fn along(&mut self, coordinate: Coordinate) -> Option<&mut Vec<f64>> {
        let wheels = &mut self.wheels;
        match (coordinate, wheels) {
            (Coordinate::Rack | Coordinate::SteeringWheel, _) => Some(&mut self.racks),
            (Coordinate::Roll, WheelMotion::Roll { roll, .. }) => Some(roll),
            (Coordinate::Heave, WheelMotion::Roll { heave, .. } | WheelMotion::Heave(heave)) => {
                Some(heave)
            }
            (Coordinate::TravelLeft, WheelMotion::Travels { left, .. }) => Some(left),
            (Coordinate::TravelRight, WheelMotion::Travels { right, .. }) => Some(right),
            _ => None,
        }
    }
}
