//! A suspension with its dimensions, and data of the whole vehicle.

use super::{Frame, LengthUnit, Mechanism};
use crate::number::{Real, Vector3};

/// Data of the whole vehicle that some characteristics need. Lengths are in the study's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VehicleFigures {
    /// Distance between the axles.
    pub wheelbase: Option<f64>,
    /// Distance between the wheels of the axle.
    pub track: Option<f64>,
    /// Height of the centre of gravity above the ground.
    pub cg_height: Option<f64>,
    /// Share of the braking force at the front axle, 0 to 1.
    pub brake_share_front: Option<f64>,
    /// Share of the drive force at the front axle, 0 to 1.
    pub drive_share_front: Option<f64>,
    /// Position of the axle with this suspension.
    pub position: Option<AxlePosition>,
    /// Part that carries the reaction to the torque of the brakes.
    pub brakes: Option<TorquePath>,
    /// Part that carries the reaction to the torque of the drive.
    pub drive_torque: Option<TorquePath>,
}

/// Position of an axle in the car.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxlePosition {
    /// The front axle.
    Front,
    /// The rear axle.
    Rear,
}

/// Part that carries the reaction to the torque of brakes or drive about the wheel's spin axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TorquePath {
    /// The wheel carrier: outboard brakes, hub motors.
    Carrier,
    /// A shaft from the body: inboard brakes, drive shafts.
    Shafts,
}

/// A suspension: the mechanism with its dimensions.
///
/// All numbers are in the kernel's frame (see [`Frame`]) and in the study's length unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspension {
    /// Structure of the suspension: its points, bodies and constraints.
    pub mechanism: Mechanism,
    /// Design positions of all points, indexed by [`PointId`](super::PointId).
    pub design: Vec<Vector3<f64>>,
    /// Map from the study's axes to the kernel's.
    pub frame: Frame,
    /// The unit of every length.
    pub length_unit: LengthUnit,
    /// Loaded radius of the wheel.
    pub wheel_radius: Option<f64>,
    /// Width of the tyre.
    pub tyre_width: Option<f64>,
    /// Diameter of the rim edge at which toe is measured as a length.
    pub rim_diameter: Option<f64>,
    /// Data of the whole vehicle.
    pub vehicle: VehicleFigures,
}

impl Suspension {
    /// Size of the mechanism: the largest distance of a point from the knuckle's origin. Bounds on rounding and step lengths
    /// are relative to it.
    pub fn size(&self) -> f64 {
        self.mechanism.size(&self.design)
    }

    /// Length of the spring between its two end points, with the points at `design`. `None` without a spring.
    pub fn spring_length<T: Real>(&self, design: &[Vector3<T>]) -> Option<T> {
        let spring = self.mechanism.spring?;
        Some((design[spring.upper.0] - design[spring.lower.0]).norm())
    }
}
