//! Quantities that have a value in every pose.

use super::gains::angle_of_gain;
use super::reading::ReadSet;
use super::{Characteristic, Slot, Slots};
use crate::model::{Axis, Mechanism, PointId, RockerId};

/// A quantity that has a value in every pose, in the kernel's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A wheel characteristic.
    Characteristic(Characteristic),
    /// A coordinate of a point.
    Coordinate(PointId, Axis),
    /// A component of the knuckle's angular velocity with respect to the drive coordinate. Its first derivative is the
    /// angular acceleration.
    AngularVelocity(Axis),
}

impl Quantity {
    /// The characteristic. `None` for a coordinate or an angular velocity.
    pub fn characteristic(self) -> Option<Characteristic> {
        match self {
            Quantity::Characteristic(of) => Some(of),
            _ => None,
        }
    }

    /// Highest order of the derivatives with respect to the drive coordinate that the value contains: 1 for a quantity
    /// that contains velocities, else 0.
    #[inline]
    pub fn rate_order(self) -> usize {
        match self {
            Quantity::Characteristic(c) => c.info().reads_rates() as usize,
            Quantity::Coordinate(..) => 0,
            Quantity::AngularVelocity(_) => 1,
        }
    }

    /// Inputs (slots) that the formula reads. Empty for coordinates, which are read directly from the configuration.
    #[inline]
    pub fn reads(self) -> &'static [Slot] {
        match self {
            Quantity::Characteristic(c) => c.info().reads,
            Quantity::Coordinate(..) => &[],
            Quantity::AngularVelocity(_) => &[Slot::Turn],
        }
    }

    /// Rockers that directly influence the quantity. If one of them, or a rocker that moves it, is at a toggle, the quantity
    /// has no value. The rotation of a steered axle's knuckle does not count, only its points.
    pub fn rockers(self, mechanism: &Mechanism) -> Vec<RockerId> {
        let mut asked = ReadSet::by(mechanism, Slots::default().with(self.reads()));
        if let Quantity::Coordinate(point, _) = self {
            asked.points.push(point);
        }
        asked.rockers(mechanism).collect()
    }

    /// Returns true if the quantity is a derivative with respect to the drive coordinate, so that its value depends on
    /// the kind of drive. Characteristics that contain velocities are ratios of velocities, so they do not depend on
    /// the drive.
    pub fn is_rate(self) -> bool {
        matches!(self, Quantity::AngularVelocity(_))
    }

    /// Returns true if the quantity is the derivative of an angle with respect to travel.
    pub fn is_gain(self) -> bool {
        match self {
            Quantity::Characteristic(c) => angle_of_gain(c).is_some(),
            _ => false,
        }
    }
}
