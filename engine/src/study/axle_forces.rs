//! Anti-features of an axle (such as anti-dive), and the keys of `[vehicle]` that they need: the data on braking and
//! drive.

use crate::ask::Need;
use crate::model::{AxlePosition, VehicleFigures};

/// Returns true if a required input concerns the drive, and false if it concerns braking. `None` for other inputs. Also
/// `None` if the input depends on the axle's position (front or rear) and the study does not give the position.
fn of_drive(need: &Need, vehicle: &VehicleFigures) -> Option<bool> {
    match need {
        Need::FrontBraking => Some(false),
        Need::RearDrive => Some(true),
        Need::RearBrakingOrFrontDrive => Some(vehicle.position? == AxlePosition::Front),
        _ => None,
    }
}

/// Keys of this required input that are missing in the study.
pub(super) fn missing(need: &Need, vehicle: &VehicleFigures) -> Vec<&'static str> {
    let mut keys = Vec::new();
    if vehicle.position.is_none() {
        keys.push("position in [vehicle], \"front\" or \"rear\"");
    }
    let (path, share) = match of_drive(need, vehicle) {
        None => return keys,
        Some(true) => (
            vehicle.drive_torque.is_none().then_some(
                "drive_torque in [vehicle], \"shafts\" or \"carrier\" (hub motors, live axles)",
            ),
            (vehicle.drive_share_front.is_none()).then_some("drive_share_front in [vehicle]"),
        ),
        Some(false) => (
            (vehicle.brakes.is_none())
                .then_some("brakes in [vehicle], \"outboard\" or \"inboard\""),
            (vehicle.brake_share_front.is_none()).then_some("brake_share_front in [vehicle]"),
        ),
    };
    keys.extend(path.into_iter().chain(share));
    keys
}

/// Reason why an anti-feature does not apply to an axle although all inputs are given. Also names the anti-feature that
/// applies instead.
pub(super) fn refusal(
    need: &Need,
    vehicle: &VehicleFigures,
) -> Option<(&'static str, Option<&'static str>)> {
    let front = vehicle.position == Some(AxlePosition::Front);
    let none_in_front = |share: Option<f64>| share == Some(0.0);
    let none_at_rear = |share: Option<f64>| share == Some(1.0);
    match need {
        Need::FrontBraking if !front => Some((
            "applies to a front axle in braking, but position is \"rear\"",
            Some("for a rear axle in braking use anti_lift"),
        )),
        Need::RearDrive if front && none_in_front(vehicle.drive_share_front) => Some((
            "applies to a driven rear axle, and this is an undriven front axle (drive_share_front = 0)",
            None,
        )),
        Need::RearDrive if front => Some((
            "applies to a rear axle under drive, but position is \"front\"",
            Some("for a driven front axle use anti_lift"),
        )),
        _ => match (of_drive(need, vehicle)?, front) {
            (true, true) if none_in_front(vehicle.drive_share_front) => Some((
                "of a front axle applies to drive, but this axle is not driven: drive_share_front \
                 is 0",
                Some("for a front axle in braking use anti_dive"),
            )),
            (true, false) if none_at_rear(vehicle.drive_share_front) => Some((
                "applies to a driven rear axle, and this rear axle is not driven: drive_share_front is 1",
                None,
            )),
            (false, true) if none_in_front(vehicle.brake_share_front) => Some((
                "applies to a braked front axle, and this front axle has no brakes: brake_share_front is 0",
                None,
            )),
            (false, false) if none_at_rear(vehicle.brake_share_front) => Some((
                "applies to a braked rear axle, and this rear axle has no brakes: brake_share_front is 1",
                None,
            )),
            _ => None,
        },
    }
}
