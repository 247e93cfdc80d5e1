//! `suspensions.ini` of Assetto Corsa: one axle of it.
//!
//! Lengths are in metres. Pick-up points are relative to the wheel centre: x inboard, y up, z forward, the same for both
//! wheels. `TRACK` is twice the distance of the wheel centre from the middle of the car; `BASEY` is the height of the wheel
//! centre above the centre of gravity. `STATIC_CAMBER` is in degrees, positive with the top outward; it turns the wheel,
//! not the pick-up points. `TOE_OUT` is a shift of the steering rod's body end in metres, no angle.

use super::outgoing::Outgoing;
use super::subsystem::Written;
use crate::model::{AxlePosition, LengthUnit, PointId};
use crate::report::shortest;
use std::fmt::Write;

/// Keys of a double wishbone and their hardpoints.
const DOUBLE_WISHBONE: &[(&str, &str)] = &[
    ("WBCAR_TOP_FRONT", "upper_arm_front"),
    ("WBCAR_TOP_REAR", "upper_arm_rear"),
    ("WBCAR_BOTTOM_FRONT", "lower_arm_front"),
    ("WBCAR_BOTTOM_REAR", "lower_arm_rear"),
    ("WBTYRE_TOP", "upper_ball_joint"),
    ("WBTYRE_BOTTOM", "lower_ball_joint"),
    ("WBCAR_STEER", "tie_rod_inner"),
    ("WBTYRE_STEER", "tie_rod_outer"),
];

/// Keys of a strut and their hardpoints.
const STRUT: &[(&str, &str)] = &[
    ("STRUT_CAR", "strut_top"),
    ("STRUT_TYRE", "strut_lower"),
    ("WBCAR_BOTTOM_FRONT", "lower_arm_front"),
    ("WBCAR_BOTTOM_REAR", "lower_arm_rear"),
    ("WBTYRE_BOTTOM", "lower_ball_joint"),
    ("WBCAR_STEER", "tie_rod_inner"),
    ("WBTYRE_STEER", "tie_rod_outer"),
];

/// The file of a study.
///
/// # Errors
///
/// The topology has no place there, or the wheels of the axle differ.
pub fn suspensions_ini(outgoing: &Outgoing<'_>) -> Result<Written, String> {
    let suspension = &outgoing.study.suspension;
    let mechanism = &suspension.mechanism;
    let (kind, keys) = match mechanism.topology.name {
        "double_wishbone" => ("DWB", DOUBLE_WISHBONE),
        "macpherson" => ("STRUT", STRUT),
        other => {
            return Err(format!(
                "suspensions.ini has no type for a {other}; --to assetto takes double_wishbone (DWB) and macpherson (STRUT)"
            ));
        }
    };
    if mechanism.strut_upper().is_some() {
        return Err(
            "strut_upper: the axis of a STRUT runs through STRUT_CAR and STRUT_TYRE alone; leave the point out or \
             put it on that line"
                .to_owned(),
        );
    }
    if outgoing.different_wheels().len() > 1 {
        return Err(
            "axle.right: suspensions.ini has one wheel for both sides, and this axle's differ"
                .to_owned(),
        );
    }
    let metres = |length: f64| LengthUnit::Metre.convert(length, outgoing.unit);
    let side = suspension.frame.meaning().1;
    let centre = outgoing.place(side, mechanism.wheel_centre);
    let relative = |id: PointId| {
        let place = outgoing.place(side, id);
        let from = [centre.y - place.y, place.z - centre.z, place.x - centre.x];
        from.map(|length| shortest(metres(length) + 0.0)).join(", ")
    };
    let vehicle = &suspension.vehicle;
    let own_metres =
        |length: f64| shortest(LengthUnit::Metre.convert(length, suspension.length_unit));
    let [camber, toe] = outgoing.static_angles(side);

    let mut file = "; suspensions.ini by hardpoint: geometry alone; springs, dampers, stops and masses are to be \
                    added\n; metres and degrees; points relative to the wheel centre: x inboard, y up, z forward\n\
                    [HEADER]\nVERSION=2\n"
        .to_owned();
    let mut notes = Vec::new();
    file += "\n[BASIC]\n";
    match vehicle.wheelbase {
        Some(length) => writeln!(file, "WHEELBASE={}", own_metres(length)),
        None => writeln!(file, "; WHEELBASE=   ; not in the study"),
    }
    .expect("a text takes everything");
    file += "; CG_LOCATION=   ; share of the weight on the front axle; not in the study\n";
    let section = match vehicle.position {
        Some(AxlePosition::Rear) => "REAR",
        Some(AxlePosition::Front) => "FRONT",
        None => {
            notes.push("[vehicle] position is missing: written as the front axle".to_owned());
            "FRONT"
        }
    };
    let _ = write!(file, "\n[{section}]\nTYPE={kind}\n");
    let _ = writeln!(file, "TRACK={}", shortest(metres(2.0 * centre.y)));
    match (suspension.wheel_radius, vehicle.cg_height) {
        (Some(radius), Some(cg)) => {
            // The contact point lies radius x cos(camber) below the wheel centre.
            let cosine = (1.0 - outgoing.spin_axis(side).z.powi(2)).sqrt();
            let _ = writeln!(file, "BASEY={}", own_metres(radius * cosine - cg));
        }
        _ => {
            file += "; BASEY=   ; needs [wheel] radius and [vehicle] cg_height\n";
            notes.push(
                "BASEY is to be filled in: it needs [wheel] radius and [vehicle] cg_height"
                    .to_owned(),
            );
        }
    }
    file += "RIM_OFFSET=0\n";
    for (key, name) in keys {
        let id = mechanism.point(name).expect("the topology requires it");
        let _ = writeln!(file, "{key}={}", relative(id));
    }
    let _ = writeln!(file, "STATIC_CAMBER={}", shortest(camber));
    file += "TOE_OUT=0   ; shift of the steering rod's body end, positive outward\n";
    if toe != 0.0 {
        notes.push(format!(
            "static toe of {} deg is not held: TOE_OUT is a length, and the points of the file are those of a wheel \
             straight ahead",
            shortest(toe)
        ));
    }
    let known = |name: &str| name == "wheel_centre" || keys.iter().any(|(_, own)| *own == name);
    let points = mechanism.points.iter().filter(|point| !known(&point.name));
    let absent: Vec<&str> = points.map(|point| point.name.as_str()).collect();
    if !absent.is_empty() {
        notes.push(format!(
            "left out, without a place in the file: {}",
            absent.join(", ")
        ));
    }
    notes.push(
        "the place of the axle in the car is not held: points are relative to the wheel centre"
            .to_owned(),
    );
    Ok(Written {
        bytes: file.into_bytes(),
        notes,
    })
}
