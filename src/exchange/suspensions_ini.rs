//! Writes `suspensions.ini` of Assetto Corsa for one axle, or for both axles of a car.
//!
//! Lengths are in metres. Pick-up points are relative to the wheel centre: x inboard, y up, z forward, equal for both wheels.
//! `TRACK` is twice the distance of the wheel centre from the middle of the car. `BASEY` is the height of the wheel centre above
//! the centre of gravity. `STATIC_CAMBER` is in degrees, positive with the top outward; it turns the wheel but not the pick-up
//! points. `TOE_OUT` is not an angle but a shift of the steering rod's body end in metres.
//!
//! A solid axle is `TYPE=AXLE`. Its links are in a section `[AXLE]`, relative to the middle of both wheel centres: x to the left,
//! y up, z forward. The game reads only one such section, for the rear axle.
//!
//! `SPRING_RATE` is the rate at the wheel in N/m in the design position ([`WheelQuantity::WheelRate`]). For a solid axle it is
//! the rate in heave per wheel ([`AxleQuantity::RideRateWithoutTyres`]). It excludes the anti-roll bar, because the game has a
//! separate value for the bar.

use super::assetto_in::POINTS;
use super::outgoing::Outgoing;
use super::subsystem::Written;
use crate::axle::{AxlePlan, AxleQuantity, Quantity, WheelQuantity, axle_curves};
use crate::car::Masses;
use crate::model::{AxlePosition, Constraint, LengthUnit, PointId, Side};
use crate::number::Vector3;
use crate::report::shortest;
use crate::study::CarStudy;
use std::fmt::Write;

/// Makes the file for a study of one axle.
///
/// # Errors
///
/// The format does not support the topology, or the wheels of the axle differ.
pub fn suspensions_ini(outgoing: &Outgoing<'_>) -> Result<Written, String> {
    let mut ini = Ini::new(outgoing);
    ini.basic();
    ini.axle(None)?;
    ini.notes.push(
        "the position of the axle in the car is omitted: points are relative to the wheel centre"
            .to_owned(),
    );
    Ok(Written {
        bytes: ini.file.into_bytes(),
        notes: ini.notes,
    })
}

/// Makes the file for a car: both axles, with wheelbase, weight distribution and masses of the wheels.
///
/// # Errors
///
/// The format does not support the topology of an axle, or its wheels differ.
pub fn suspensions_ini_of_car(study: &CarStudy) -> Result<Written, String> {
    let [front, rear] = study
        .axles
        .each_ref()
        .map(|axle| Outgoing::of(axle, None, None));
    let is_solid = |own: &Outgoing<'_>| own.study.wheel().mechanism.topology.name == "solid_axle";
    if is_solid(&front) && is_solid(&rear) {
        return Err(
            "car.front and car.rear are solid axles, but suspensions.ini has the links of one \
             solid axle only, in [AXLE]. Export the study of the rear axle"
                .to_owned(),
        );
    }
    let car = &study.car;
    let metres = |length: f64| LengthUnit::Metre.convert(length, car.length_unit);
    let [front_centre, rear_centre] = [&front, &rear].map(|axle| Ini::new(axle).centre());
    let rear_centre = rear_centre + car.rear_offset;
    let wheelbase = front_centre.x - rear_centre.x;
    let mut ini = Ini::new(&front);
    ini.line("WHEELBASE", &shortest(metres(wheelbase)));
    // The sprung mass and the whole car have different centres of gravity.
    let has_whole = car.masses == Masses::Whole;
    if has_whole {
        let share = (car.cg.x - rear_centre.x) / wheelbase;
        ini.line("CG_LOCATION", &shortest(share));
    } else {
        ini.blank(
            "CG_LOCATION",
            "share of the weight on the front axle; the study has the sprung mass",
        );
        ini.notes.push(
            "CG_LOCATION and BASEY must be filled in: the study has only the sprung mass"
                .to_owned(),
        );
    }
    let (mut file, mut notes) = (ini.file, ini.notes);
    for (outgoing, centre) in [(&front, front_centre), (&rear, rear_centre)] {
        let mut ini = Ini::new(outgoing);
        ini.file = file;
        let below = has_whole.then(|| metres(centre.z - car.cg.z));
        ini.axle(Some(below))?;
        file = ini.file;
        for note in ini.notes {
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
    }
    if has_whole {
        notes.push(format!("car.ini: TOTALMASS={}", shortest(car.mass)));
    }
    Ok(Written {
        bytes: file.into_bytes(),
        notes,
    })
}

const HEAD: &str = "; suspensions.ini by hardpoint: geometry and rates of springs; dampers, stops \
                    and masses must be added
; metres and degrees; points relative to the wheel \
                    centre: x inboard, y up, z forward
[HEADER]
VERSION=2

[BASIC]
";

/// Rate per wheel in the design position. For a solid axle it is the rate in heave, otherwise the rate of the left wheel alone.
/// Returns the reason if the study has no such rate.
fn wheel_rate(outgoing: &Outgoing<'_>) -> Result<f64, &'static str> {
    let needs = "its computation needs [axle], [spring] and [wheel] radius in the study";
    let both = outgoing.study.axle().ok_or(needs)?;
    let setup = &both.axle.setup;
    if setup.springs.is_none() || setup.wheel_radius.is_none() {
        return Err(needs);
    }
    if setup.rocker_springs.carry() {
        return Err(
            "with a heave spring, heave and roll have different rates, but the file has only one",
        );
    }
    // In the game, the springs of a solid axle act on the axle as a whole, so the rate in heave applies.
    let quantity = if both.axle.is_rigid() {
        Quantity::Axle(AxleQuantity::RideRateWithoutTyres)
    } else {
        Quantity::Wheel(Side::Left, WheelQuantity::WheelRate)
    };
    let plan = AxlePlan::of(both.plan.motion.clone(), vec![quantity]).at_design();
    let found = axle_curves(&both.axle, &plan).ok();
    let rate = found.and_then(|found| found.curves.stations.first()?.value(0));
    rate.filter(|rate| *rate > 0.0)
        .ok_or("the rate in the design position is not positive")
}

/// Value of `TYPE` for a solid axle.
const AXLE: &str = "AXLE";

/// Value of `TYPE` for a study. Returns the reason if the format does not support the topology.
fn kind(outgoing: &Outgoing<'_>) -> Result<&'static str, String> {
    let mechanism = &outgoing.study.wheel().mechanism;
    let kind = match mechanism.topology.name {
        "double_wishbone" => "DWB",
        "macpherson" => "STRUT",
        "solid_axle" => AXLE,
        other => {
            return Err(format!(
                "suspensions.ini has no type for a {other}; --to assetto is available for \
                 double_wishbone (DWB), macpherson (STRUT) and solid_axle (AXLE)"
            ));
        }
    };
    if mechanism.axle_steering().is_some() {
        return Err(
            "suspensions.ini has no steering for a solid axle, but a drag link steers this axle"
                .to_owned(),
        );
    }
    if mechanism.has_watt_linkage() {
        return Err(
            "suspensions.ini has only links for a solid axle, but a Watt linkage holds this axle"
                .to_owned(),
        );
    }
    if mechanism.strut_upper().is_some() {
        return Err(
            "strut_upper: the axis of a STRUT runs through STRUT_CAR and STRUT_TYRE; the file \
             cannot contain a strut whose axis does not end in strut_top"
                .to_owned(),
        );
    }
    if kind != AXLE && outgoing.different_wheels().len() > 1 {
        return Err(
            "axle.right: suspensions.ini has one wheel for both sides, but the sides of this axle \
             differ"
                .to_owned(),
        );
    }
    Ok(kind)
}

/// File to which lines are added.
struct Ini<'a> {
    outgoing: &'a Outgoing<'a>,
    side: Side,
    file: String,
    notes: Vec<String>,
}

impl<'a> Ini<'a> {
    fn new(outgoing: &'a Outgoing<'a>) -> Self {
        Ini {
            outgoing,
            side: outgoing.study.wheel().frame.meaning().1,
            file: HEAD.to_owned(),
            notes: Vec::new(),
        }
    }

    /// Writes the section of an axle. For an axle of a car, `below` has the height of the wheel centre above the car's centre
    /// of gravity in metres, or `Some(None)` if it is not known. `None` means that the axle's study gives the height.
    fn axle(&mut self, below: Option<Option<f64>>) -> Result<(), String> {
        let kind = kind(self.outgoing)?;
        self.section(kind, below);
        let mechanism = &self.outgoing.study.wheel().mechanism;
        let keys = POINTS
            .iter()
            .filter(|(_, name)| mechanism.topology.hardpoint(name).is_some());
        for (key, name) in keys.clone() {
            let id = mechanism.point(name).expect("the topology requires it");
            self.line(key, &self.relative(id));
        }
        self.angles();
        self.spring_rate();
        let links = match kind {
            AXLE => self.links(),
            _ => Vec::new(),
        };
        let known = |name: &str| {
            name == "wheel_centre"
                || keys.clone().any(|(_, own)| *own == name)
                || links.iter().any(|id| mechanism.name(*id) == name)
        };
        let ids = (0..mechanism.points.len()).map(PointId);
        let absent: Vec<&str> = ids
            .filter(|id| !mechanism.is_far(*id))
            .map(|id| mechanism.name(id))
            .filter(|name| !known(name))
            .collect();
        if !absent.is_empty() {
            let absent = absent.join(", ");
            self.notes.push(format!(
                "omitted, because the file cannot contain it: {absent}"
            ));
        }
        Ok(())
    }

    /// Writes the section `[AXLE]`. Returns the ends of its links.
    fn links(&mut self) -> Vec<PointId> {
        let mechanism = &self.outgoing.study.wheel().mechanism;
        let held = mechanism.constraints.iter().filter_map(|row| match row {
            Constraint::Link { inner, outer } => Some([*inner, *outer]),
            _ => None,
        });
        let extra = mechanism.rigid_axle.iter().flat_map(|own| &own.extra_links);
        let ends: Vec<[PointId; 2]> = held.chain(extra.copied()).collect();
        let place = |id: PointId| self.outgoing.place(self.side, id);
        let far = mechanism.rigid_axle.as_ref().map(|axle| axle.far_centre);
        let far = far.map_or(self.centre(), place);
        let middle = (self.centre() + far) * 0.5;
        let relative = |id: PointId| {
            let from = place(id) - middle;
            let metres = |length: f64| LengthUnit::Metre.convert(length, self.outgoing.unit) + 0.0;
            [from.y, from.z, from.x]
                .map(|length| shortest(metres(length)))
                .join(", ")
        };
        let mut text = format!("\n[AXLE]\nLINK_COUNT={}\n", ends.len());
        for (number, [car, axle]) in ends.iter().enumerate() {
            let _ = write!(
                text,
                "J{number}_CAR={}\nJ{number}_AXLE={}\n",
                relative(*car),
                relative(*axle)
            );
        }
        self.file += &text;
        self.notes.push(
            "[AXLE] has the links; TORQUE_REACTION, ATTACH_REL_POS and leaf springs must be added"
                .to_owned(),
        );
        ends.into_iter().flatten().collect()
    }

    fn line(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.file, "{key}={value}");
    }

    /// Writes a key without a value, for the user to complete. `why` is the comment that explains the missing value.
    fn blank(&mut self, key: &str, why: &str) {
        let _ = writeln!(self.file, "; {key}=   ; {why}");
    }

    /// Converts a length of the study to metres.
    fn metres(&self, length: f64) -> f64 {
        let own = self.outgoing.study.wheel().length_unit;
        LengthUnit::Metre.convert(length, own)
    }

    fn centre(&self) -> Vector3<f64> {
        let id = self.outgoing.study.wheel().mechanism.wheel_centre;
        self.outgoing.place(self.side, id)
    }

    /// Coordinates of a point relative to the wheel centre in metres: x inboard, y up, z forward.
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

    fn section(&mut self, kind: &str, below: Option<Option<f64>>) {
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
        match (below, suspension.wheel_radius, vehicle.cg_height) {
            (Some(Some(below)), ..) => self.line("BASEY", &shortest(below)),
            (Some(None), ..) => self.blank(
                "BASEY",
                "height of the wheel centre above the centre of gravity",
            ),
            (None, Some(radius), Some(cg)) => {
                // The contact point is radius x cos(camber) below the wheel centre.
                let cosine = (1.0 - self.outgoing.spin_axis(self.side).z.powi(2)).sqrt();
                self.line("BASEY", &shortest(self.metres(radius * cosine - cg)));
            }
            _ => {
                let needs = "needs [wheel] radius and [vehicle] cg_height";
                self.blank("BASEY", needs);
                self.notes
                    .push(format!("BASEY must be filled in: it {needs}"));
            }
        }
        if let Some(mass) = self.unsprung_mass().filter(|_| kind != AXLE) {
            self.line("HUB_MASS", &shortest(mass / 2.0));
        }
        self.line("RIM_OFFSET", "0");
    }

    /// Writes the rate at the wheel, for an axle with springs.
    fn spring_rate(&mut self) {
        match wheel_rate(self.outgoing) {
            Ok(rate) => {
                let per_metre = self.outgoing.study.wheel().length_unit.per_metre();
                self.line("SPRING_RATE", &shortest(rate * per_metre));
                let is_rigid = self
                    .outgoing
                    .study
                    .axle()
                    .is_some_and(|own| own.axle.is_rigid());
                let which = if is_rigid {
                    "of the axle in heave, per wheel,"
                } else {
                    "at the wheel"
                };
                self.notes.push(format!(
                    "SPRING_RATE is the rate {which} in the design position; ROD_LENGTH, which \
                     sets the ride height, must be filled in"
                ));
            }
            Err(why) => self.blank("SPRING_RATE", &format!("N/m at the wheel; {why}")),
        }
    }

    fn unsprung_mass(&self) -> Option<f64> {
        self.outgoing.study.axle()?.axle.setup.unsprung_mass
    }

    fn angles(&mut self) {
        let [camber, toe] = self.outgoing.static_angles(self.side);
        self.line("STATIC_CAMBER", &shortest(camber));
        let what = "0   ; shift of the body end of the steering rod, positive outward";
        self.line("TOE_OUT", what);
        if toe != 0.0 {
            self.notes.push(format!(
                "static toe of {} deg is omitted: TOE_OUT is a length, and the points in the file \
                 are for a wheel pointing straight ahead",
                shortest(toe)
            ));
        }
    }
}
