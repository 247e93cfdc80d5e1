//! The numbers that give the position of an axle, and how a study writes them.

use super::state::Motion;
use super::{Axle, AxleMotion, Placement, WheelMotion};
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
    /// All variants, in their order.
    pub const ALL: [Coordinate; 6] = [
        Coordinate::Roll,
        Coordinate::Heave,
        Coordinate::TravelLeft,
        Coordinate::TravelRight,
        Coordinate::Rack,
        Coordinate::SteeringWheel,
    ];

    /// Key in `[motion]`.
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

    /// The unit of its values as the study writes them.
    pub fn unit(self, length: LengthUnit) -> &'static str {
        match self {
            Coordinate::Roll | Coordinate::SteeringWheel => "deg",
            Coordinate::Heave
            | Coordinate::TravelLeft
            | Coordinate::TravelRight
            | Coordinate::Rack => length.symbol(),
        }
    }

    /// Returns true if it is a length as the study writes it.
    pub fn is_length(self) -> bool {
        !matches!(self, Coordinate::Roll | Coordinate::SteeringWheel)
    }

    /// The motion along which this coordinate alone changes.
    pub fn motion(self) -> Motion {
        match self {
            Coordinate::Roll => Motion::Roll,
            Coordinate::Heave => Motion::Heave,
            Coordinate::TravelLeft => Motion::TravelLeft,
            Coordinate::TravelRight => Motion::TravelRight,
            Coordinate::Rack | Coordinate::SteeringWheel => Motion::Rack,
        }
    }

    /// Column in results.
    pub fn column(self, length: LengthUnit) -> String {
        format!("{}_{}", self.key(), self.unit(length))
    }

    /// Converts a value as the study writes it (degrees, lengths along the study's axes) to one of a [`AxleMotion`]. The
    /// angle of the steering wheel becomes the displacement of the rack that it makes.
    pub fn in_kernel(self, written: f64, axle: &Axle) -> f64 {
        match self {
            Coordinate::Roll => written.to_radians(),
            Coordinate::Rack => written * axle.left.frame.sign(Axis::Y),
            Coordinate::SteeringWheel => axle.setup.c_factor.unwrap_or(f64::NAN) * written / 360.0,
            _ => written,
        }
    }

    /// Converts a value of a motion to one as the study writes it; an angle becomes the shortest decimal that stands
    /// for it.
    pub fn written(self, value: f64, axle: &Axle) -> f64 {
        let short = |value: f64| format!("{value:.12e}").parse().unwrap_or(value);
        match self {
            Coordinate::Roll => short(value.to_degrees()),
            _ => short(value / self.in_kernel(1.0, axle)),
        }
    }
}

impl Placement {
    /// The value of a coordinate in the form of a motion; 0 for a coordinate that does not define this placement.
    pub fn along(&self, coordinate: Coordinate) -> f64 {
        match (coordinate, *self) {
            (Coordinate::Rack | Coordinate::SteeringWheel, placement) => placement.rack(),
            (Coordinate::Roll, Placement::Roll { roll, .. } | Placement::AtLoad { roll, .. }) => {
                roll
            }
            (
                Coordinate::Heave,
                Placement::Roll { heave, .. } | Placement::AtLoad { heave, .. },
            ) => heave,
            (Coordinate::Heave | Coordinate::TravelLeft, Placement::Travels { travels, .. }) => {
                travels[0]
            }
            (Coordinate::TravelRight, Placement::Travels { travels, .. }) => travels[1],
            _ => 0.0,
        }
    }
}

impl AxleMotion {
    /// The numbers that move, at least one. Curves are over the first.
    pub fn moving(&self) -> Vec<Coordinate> {
        let mut motion = self.clone();
        let by_wheel = motion.steering_wheel.is_some();
        let mut available: Vec<Coordinate> = Coordinate::ALL.to_vec();
        available.retain(|c| motion.along(*c).is_some());
        available.retain(|c| match c {
            Coordinate::Rack => !by_wheel && motion.shows_rack,
            Coordinate::SteeringWheel => by_wheel,
            _ => true,
        });
        let mut moving = available.clone();
        moving.retain(|c| motion.along(*c).is_some_and(|values| values.len() > 1));
        if moving.is_empty() {
            moving.push(available[0]);
        }
        // Steering before the rest of what curves are not over.
        let steers = |c: &Coordinate| matches!(c, Coordinate::Rack | Coordinate::SteeringWheel);
        moving[1..].sort_by_key(|c| !steers(c));
        moving
    }

    /// The values of a coordinate; `None` if this motion does not have it. Rack and steering wheel have the same
    /// values, displacements of the rack.
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
