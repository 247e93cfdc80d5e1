//! Coordinates of an axle's pose, and how a study writes them.

use super::state::Motion;
use super::{Axle, AxleMotion, Placement, WheelMotion};
use crate::model::{Axis, LengthUnit, Side};
use crate::sorting::{sort_by_key, sort_numbers};

/// Coordinate of an axle's motion.
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
    /// All coordinates, in the order of the variants.
    pub const ALL: [Coordinate; 6] = [
        Coordinate::Roll,
        Coordinate::Heave,
        Coordinate::TravelLeft,
        Coordinate::TravelRight,
        Coordinate::Rack,
        Coordinate::SteeringWheel,
    ];

    /// Key of the coordinate in the section `[motion]` of a study.
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

    /// Unit of the coordinate's values in a study.
    pub fn unit(self, length: LengthUnit) -> &'static str {
        match self {
            Coordinate::Roll | Coordinate::SteeringWheel => "deg",
            Coordinate::Heave
            | Coordinate::TravelLeft
            | Coordinate::TravelRight
            | Coordinate::Rack => length.symbol(),
        }
    }

    /// Returns true if the coordinate is a length in a study.
    pub fn is_length(self) -> bool {
        !matches!(self, Coordinate::Roll | Coordinate::SteeringWheel)
    }

    /// Motion along which only this coordinate changes.
    pub fn motion(self) -> Motion {
        match self {
            Coordinate::Roll => Motion::Roll,
            Coordinate::Heave => Motion::Heave,
            Coordinate::TravelLeft => Motion::TravelLeft,
            Coordinate::TravelRight => Motion::TravelRight,
            Coordinate::Rack | Coordinate::SteeringWheel => Motion::Rack,
        }
    }

    /// Name of the coordinate's column in results.
    pub fn column(self, length: LengthUnit) -> String {
        format!("{}_{}", self.key(), self.unit(length))
    }

    /// Converts a value of a study (degrees, lengths along the study's axes) to a value of an [`AxleMotion`]. If the
    /// coordinate is the angle of the steering wheel, the result is the displacement of the rack.
    pub fn in_kernel(self, written: f64, axle: &Axle) -> f64 {
        match self {
            Coordinate::Roll => written.to_radians(),
            Coordinate::Rack => written * axle.left.frame.sign(Axis::Y),
            Coordinate::SteeringWheel => axle.setup.c_factor.unwrap_or(f64::NAN) * written / 360.0,
            _ => written,
        }
    }

    /// Converts a value of a motion to the value that a study contains. The result is rounded to 13 significant digits,
    /// which removes rounding errors of the conversion.
    pub fn written(self, value: f64, axle: &Axle) -> f64 {
        let short = |value: f64| format!("{value:.12e}").parse().unwrap_or(value);
        match self {
            Coordinate::Roll => short(value.to_degrees()),
            _ => short(value / self.in_kernel(1.0, axle)),
        }
    }
}

impl Placement {
    /// Given travel of a wheel. `None` in roll, because the travels then depend on the design.
    pub fn travel(&self, side: Side) -> Option<f64> {
        match self {
            Placement::Travels { travels, .. } => Some(travels[side as usize]),
            Placement::Roll { .. } | Placement::AtLoad { .. } => None,
        }
    }

    /// Returns the value of a coordinate in the units of a motion. The result is 0 if the placement is not defined by
    /// this coordinate.
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
    /// Returns the coordinates that move independently, at least one. The first coordinate is the abscissa of curves.
    /// If the stations are rows of a table, the result contains only the coordinate with the largest number of
    /// different values.
    pub fn moving(&self) -> Vec<Coordinate> {
        let mut moving = self.all_moving();
        if self.has_rows() {
            let mut motion = self.clone();
            let mut different = |c: Coordinate| {
                let mut values = motion.along(c).cloned().unwrap_or_default();
                sort_numbers(&mut values);
                values.dedup();
                values.len()
            };
            // `max_by_key` returns the last of several equal maxima, so the order is reversed.
            let main = moving.iter().rev().max_by_key(|c| different(**c));
            moving = main.copied().into_iter().collect();
        }
        moving
    }

    /// Returns the coordinates with several values. If no coordinate has several values, the result contains only the
    /// first coordinate. The first coordinate of the result is the abscissa of curves.
    pub fn all_moving(&self) -> Vec<Coordinate> {
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
        let has_rows = self.has_rows();
        moving.retain(|c| {
            let values = motion.along(*c).map_or(&[][..], |values| values);
            if has_rows {
                // Several rows of the table may contain the same value.
                values.iter().any(|value| *value != values[0])
            } else {
                values.len() > 1
            }
        });
        if moving.is_empty() {
            moving.push(available[0]);
        }
        // Steering coordinates come directly after the abscissa of curves.
        let steers = |c: &Coordinate| matches!(c, Coordinate::Rack | Coordinate::SteeringWheel);
        sort_by_key(&mut moving[1..], |c| !steers(c));
        moving
    }

    /// Returns the values of a coordinate. `None` if this motion does not have the coordinate. For the rack and for the
    /// steering wheel, the values are displacements of the rack.
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
