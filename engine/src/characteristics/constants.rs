//! Constants of a study that formulas read.

use crate::model::{AxlePosition, Suspension, TorquePath};

/// Constants of the study that formulas read. Missing constants are zero. The plan ensures that no formula runs without its
/// [needs](crate::ask::Need).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constants {
    /// Size of the mechanism in the design position.
    pub size: f64,
    /// Loaded radius of the wheel.
    pub wheel_radius: f64,
    /// Diameter of the rim edge at which toe is measured as a length.
    pub rim_diameter: f64,
    /// Distance between front and rear axle.
    pub wheelbase: f64,
    /// Height of the centre of gravity.
    pub cg_height: f64,
    /// True if the axle is the front axle.
    pub is_front: bool,
    /// This axle's share of the braking force.
    pub brake_share: f64,
    /// This axle's share of the drive force.
    pub drive_share: f64,
    /// 1 if the carrier carries the reaction to the brake torque, 0 if a shaft carries it.
    pub brake_torque_by_carrier: f64,
    /// 1 if the carrier carries the reaction to the drive torque, 0 if a shaft carries it.
    pub drive_torque_by_carrier: f64,
}

impl Constants {
    /// Reads the constants of a suspension that formulas of characteristics use, such as wheelbase and brake share.
    pub fn of(suspension: &Suspension) -> Self {
        let vehicle = suspension.vehicle;
        let is_front = vehicle.position == Some(AxlePosition::Front);
        let share = |of_front: Option<f64>| match (of_front, is_front) {
            (None, _) => 0.0,
            (Some(share), true) => share,
            (Some(share), false) => 1.0 - share,
        };
        let by_carrier = |path: Option<TorquePath>| match path {
            Some(TorquePath::Carrier) => 1.0,
            _ => 0.0,
        };
        Constants {
            size: suspension.size(),
            wheel_radius: suspension.wheel_radius.unwrap_or(0.0),
            rim_diameter: suspension.rim_diameter.unwrap_or(0.0),
            wheelbase: vehicle.wheelbase.unwrap_or(0.0),
            cg_height: vehicle.cg_height.unwrap_or(0.0),
            is_front,
            brake_share: share(vehicle.brake_share_front),
            drive_share: share(vehicle.drive_share_front),
            brake_torque_by_carrier: by_carrier(vehicle.brakes),
            drive_torque_by_carrier: by_carrier(vehicle.drive_torque),
        }
    }
}
