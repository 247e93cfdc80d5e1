//! `suspensions.ini` of Assetto Corsa: one axle of it.
//!
//! Lengths are in metres. Pick-up points are relative to the wheel centre: x inboard, y up, z forward, the same for both
//! wheels. `TRACK` is twice the distance of the wheel centre from the middle of the car; `BASEY` is the height of the wheel
//! centre above the centre of gravity. `STATIC_CAMBER` is in degrees, positive with the top outward; it turns the wheel,
//! not the pick-up points. `TOE_OUT` is a shift of the steering rod's body end in metres, no angle.

use super::assetto_in::POINTS;
use super::outgoing::Outgoing;
use super::subsystem::Written;
use crate::model::{AxlePosition, LengthUnit, PointId, Side};
use crate::number::Vector3;
use crate::report::shortest;
use std::fmt::Write;

/// The file of a study.
///
/// # Errors
///
/// The topology has no place there, or the wheels of the axle differ.
pub fn suspensions_ini(outgoing: &Outgoing<'_>) -> Result<Written, String> {
    let kind = kind(outgoing)?;
    let mechanism = &outgoing.study.wheel().mechanism;
    let keys = POINTS
        .iter()
        .filter(|(_, name)| mechanism.topology.hardpoint(name).is_some());
    let mut ini = Ini {
        outgoing,
        side: outgoing.study.wheel().frame.meaning().1,
        file: HEAD.to_owned(),
        notes: Vec::new(),
    };
    ini.basic();
    ini.section(kind);
    for (key, name) in keys.clone() {
        let id = mechanism.point(name).expect("the topology requires it");
        ini.line(key, &ini.relative(id));
    }
    ini.angles();
    let known = |name: &str| name == "wheel_centre" || keys.clone().any(|(_, own)| *own == name);
    let points = mechanism.points.iter().filter(|point| !known(&point.name));
    let absent: Vec<&str> = points.map(|point| point.name.as_str()).collect();
    if !absent.is_empty() {
        let absent = absent.join(", ");
        ini.notes.push(format!(
            "left out, because the file cannot hold it: {absent}"
        ));
    }
    ini.notes.push(
        "the place of the axle in the car is left out: points are relative to the wheel centre"
            .to_owned(),
    );
    Ok(Written {
        bytes: ini.file.into_bytes(),
        notes: ini.notes,
    })
}

const HEAD: &str = "; suspensions.ini by hardpoint: geometry alone; springs, dampers, stops and masses are to be added
; metres and degrees; points relative to the wheel centre: x inboard, y up, z forward
[HEADER]
VERSION=2

[BASIC]
";

/// The `TYPE` of a study.
fn kind(outgoing: &Outgoing<'_>) -> Result<&'static str, String> {
    let mechanism = &outgoing.study.wheel().mechanism;
    let kind = match mechanism.topology.name {
        "double_wishbone" => "DWB",
        "macpherson" => "STRUT",
        other => {
            return Err(format!(
                "suspensions.ini has no type for a {other}; --to assetto takes double_wishbone (DWB) and macpherson (STRUT)"
            ));
        }
    };
    if mechanism.strut_upper().is_some() {
        return Err(
            "strut_upper: the axis of a STRUT runs through STRUT_CAR and STRUT_TYRE; the file cannot hold a strut whose \
             axis does not end in strut_top"
                .to_owned(),
        );
    }
    if outgoing.different_wheels().len() > 1 {
        return Err(
            "axle.right: suspensions.ini has one wheel for both sides, and this axle's differ"
                .to_owned(),
        );
    }
    Ok(kind)
}

/// The file as it grows.
struct Ini<'a> {
    outgoing: &'a Outgoing<'a>,
    side: Side,
    file: String,
    notes: Vec<String>,
}

impl Ini<'_> {
    fn line(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.file, "{key}={value}");
    }

    /// A key without a value, for the user to fill in.
    fn blank(&mut self, key: &str, why: &str) {
        let _ = writeln!(self.file, "; {key}=   ; {why}");
    }

    /// A length of the study in metres.
    fn metres(&self, length: f64) -> f64 {
        let own = self.outgoing.study.wheel().length_unit;
        LengthUnit::Metre.convert(length, own)
    }

    fn centre(&self) -> Vector3<f64> {
        let id = self.outgoing.study.wheel().mechanism.wheel_centre;
        self.outgoing.place(self.side, id)
    }

    /// A point relative to the wheel centre.
    fn relative(&self, id: PointId) -> String {
        let from = self.outgoing.place(self.side, id) - self.centre();
        let metres = |length: f64| LengthUnit::Metre.convert(length, self.outgoing.unit) + 0.0;
        [-from.y, from.z, from.x]
            .map(|length| shortest(metres(length)))
            .join(", ")
    }

    fn basic(&mut self) {
        match self.outgoing.study.wheel().vehicle.wheelbase {
            Some(length) => self.line("WHEELBASE", &shortest(self.metres(length))),
            None => self.blank("WHEELBASE", "not in the study"),
        }
        let what = "share of the weight on the front axle; not in the study";
        self.blank("CG_LOCATION", what);
    }

    fn section(&mut self, kind: &str) {
        let suspension = self.outgoing.study.wheel();
        let vehicle = &suspension.vehicle;
        let name = match vehicle.position {
            Some(AxlePosition::Rear) => "REAR",
            Some(AxlePosition::Front) => "FRONT",
            None => {
                let note = "[vehicle] position is missing: written as the front axle";
                self.notes.push(note.to_owned());
                "FRONT"
            }
        };
        let _ = write!(self.file, "\n[{name}]\nTYPE={kind}\n");
        let half = LengthUnit::Metre.convert(self.centre().y, self.outgoing.unit);
        self.line("TRACK", &shortest(2.0 * half));
        match (suspension.wheel_radius, vehicle.cg_height) {
            (Some(radius), Some(cg)) => {
                // The contact point lies radius x cos(camber) below the wheel centre.
                let cosine = (1.0 - self.outgoing.spin_axis(self.side).z.powi(2)).sqrt();
                self.line("BASEY", &shortest(self.metres(radius * cosine - cg)));
            }
            _ => {
                let needs = "needs [wheel] radius and [vehicle] cg_height";
                self.blank("BASEY", needs);
                self.notes
                    .push(format!("BASEY is to be filled in: it {needs}"));
            }
        }
        self.line("RIM_OFFSET", "0");
    }

    fn angles(&mut self) {
        let [camber, toe] = self.outgoing.static_angles(self.side);
        self.line("STATIC_CAMBER", &shortest(camber));
        let what = "0   ; shift of the steering rod's body end, positive outward";
        self.line("TOE_OUT", what);
        if toe != 0.0 {
            self.notes.push(format!(
                "static toe of {} deg is left out: TOE_OUT is a length, and the points of the file belong to a wheel \
                 straight ahead",
                shortest(toe)
            ));
        }
    }
}
