//! Columns for the coordinates that define the motion of an axle (such as roll or the rack), in tables with one row per position.

use crate::ask::degrees;
use crate::axle::{Axle, AxlePlan, Coordinate, Placement};
use crate::model::Axis;

/// Names and values of the coordinates that define an axle's motion in its study.
pub(super) struct GivenColumns<'a> {
    pub plan: &'a AxlePlan,
    pub axle: &'a Axle,
}

impl GivenColumns<'_> {
    /// Names of the coordinates that the motion gives.
    pub(super) fn names(&self) -> Vec<String> {
        let length = self.axle.left.length_unit;
        let given = self.coordinates().into_iter();
        given.map(|c| c.column(length)).collect()
    }

    /// Values of the given coordinates at a station of the motion. Angles are in degrees, the rack displacement is in the study's
    /// axes.
    pub(super) fn values(&self, number: usize, placement: &Placement) -> Vec<f64> {
        let value = |coordinate: Coordinate| match coordinate {
            Coordinate::Roll => degrees(placement.along(coordinate)),
            Coordinate::SteeringWheel => {
                let angle = self.plan.motion.steering_wheel_at(number);
                degrees(angle.unwrap_or(f64::NAN))
            }
            Coordinate::Rack => placement.rack() * self.axle.left.frame.sign(Axis::Y),
            _ => placement.along(coordinate),
        };
        self.coordinates().into_iter().map(value).collect()
    }

    /// Values of the given coordinates at a position that may be outside the motion, in the same units and axes.
    pub(super) fn values_anywhere(&self, placement: &Placement) -> Vec<f64> {
        let value = |coordinate: Coordinate| match coordinate {
            Coordinate::SteeringWheel | Coordinate::Roll => {
                coordinate.written(placement.along(coordinate), self.axle)
            }
            Coordinate::Rack => placement.rack() * self.axle.left.frame.sign(Axis::Y),
            _ => placement.along(coordinate),
        };
        let given = self.coordinates().into_iter();
        given.map(|coordinate| value(coordinate) + 0.0).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let mut motion = self.plan.motion.clone();
        let mut given = Coordinate::ALL.to_vec();
        given.retain(|c| match c {
            Coordinate::Rack => motion.shows_rack && motion.steering_wheel.is_none(),
            Coordinate::SteeringWheel => motion.steering_wheel.is_some(),
            _ => motion.along(*c).is_some(),
        });
        given
    }
}
