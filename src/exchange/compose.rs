//! Text of the study of an imported wheel or axle. The study runs without changes.

use super::bushings;
use super::import::{Hardpoint, Imported, is_held_across};
use super::notes::Notes;
use super::seats::Seat;
use super::slips::in_words;
use crate::model::{AxlePosition, LengthUnit};
use crate::report::{Slip, study_doubts};
use crate::solved::Solved;
use crate::study::Study;
use std::fmt::Write;
use std::path::Path;

/// Characteristics in the study of a wheel. Characteristics that its points do not define are left out.
const OUTPUTS: [&str; 8] = [
    "camber",
    "toe",
    "kingpin_inclination",
    "caster",
    "scrub_radius",
    "caster_trail",
    "half_track_change",
    "motion_ratio",
];

/// Characteristics in the study of an axle.
const AXLE_OUTPUTS: [&str; 7] = [
    "camber_to_road",
    "toe",
    "roll_centre_height",
    "force_roll_centre_height",
    "roll_camber",
    "roll_steer",
    "motion_ratio",
];

/// Characteristics in the study of a solid axle.
const SOLID_OUTPUTS: [&str; 6] = [
    "axle_steer",
    "axle_lateral",
    "pinion_angle",
    "roll_steer",
    "roll_centre_height",
    "force_roll_centre_height",
];

/// Part of the car that a study describes.
#[derive(Clone, Copy)]
enum Part<'a> {
    /// One wheel.
    Wheel,
    /// Both wheels: the left one, and the lines of `[axle.right]` if the right wheel is not its mirror image.
    Axle(&'a str),
    /// A solid axle.
    Solid,
}

/// Travels to be tried, in millimetres, the largest first.
const TRAVELS: [f64; 6] = [80.0, 60.0, 40.0, 30.0, 20.0, LEAST_TRAVEL];
/// Largest number of reasons for a shorter travel in a message: one for each end of the motion.
const MOST_REASONS: usize = 2;
/// Smallest travel of a suspension that runs, in millimetres.
const LEAST_TRAVEL: f64 = 10.0;

impl Imported {
    /// Text of a study of the wheel, or of the axle if it is a solid axle. `name` is the study's name in messages; `origin` is
    /// the file with the points.
    ///
    /// # Errors
    ///
    /// The faults of the suspension in words.
    pub fn study(&self, name: &str, origin: &str) -> Result<String, String> {
        self.study_and_notes(name, origin).map(|(text, _)| text)
    }

    /// Text of the study as in [`Imported::study`], and notes: warnings about its points, and the reason if its range of motion is
    /// shorter than usual.
    ///
    /// # Errors
    ///
    /// The faults of the suspension in words.
    pub fn study_and_notes(&self, name: &str, origin: &str) -> Result<(String, Notes), String> {
        let (text, notes) = if self.topology.carries_both_wheels() {
            self.running(name, origin, Part::Solid)
        } else {
            self.running(name, origin, Part::Wheel)
        }?;
        let text = text + &bushings::sections(&self.bushings, self.unit);
        let study = Study::elastic_from_text(name, &text, Path::new(""));
        study.map_err(|errors| errors.render(false))?;
        Ok((text, notes))
    }

    /// Text of a study of both wheels without elastic parts, and notes as in [`Imported::study_and_notes`]. `right` is the right
    /// wheel from the same file; without it, the right wheel is the mirror image.
    pub(super) fn axle_study(
        &self,
        right: Option<&Imported>,
        name: &str,
        origin: &str,
    ) -> Result<(String, Notes), String> {
        if self.topology.carries_both_wheels() {
            return self.running(name, origin, Part::Solid);
        }
        let differences = right.map_or(String::new(), |right| self.differences(right));
        self.running(name, origin, Part::Axle(&differences))
    }

    /// Sections `[axle.right]` for a right wheel that is not the mirror image of the left one. Empty if it is the mirror image.
    fn differences(&self, right: &Imported) -> String {
        let own = |name: &str| self.hardpoints.iter().find(|h| h.name == name);
        let moved = right.hardpoints.iter().filter(|other| {
            own(other.name).is_none_or(|own| {
                let [x, y, z] = own.position;
                other.position != [x, 0.0 - y, z]
            })
        });
        let mut text = right_hardpoints(moved);
        let angles = [
            ("static_camber", self.static_camber, right.static_camber),
            ("static_toe", self.static_toe, right.static_toe),
        ];
        if angles.iter().any(|(_, left, right)| left != right) {
            text += "\n[axle.right.wheel]\n";
            for (key, _, angle) in angles {
                let _ = writeln!(text, "{key} = {:?}", angle.unwrap_or(0.0));
            }
        }
        text
    }

    /// Returns the text of the study with the largest travel of [`TRAVELS`] in which the suspension runs. Also returns warnings
    /// about its points, and the reason if this travel is shorter than usual.
    ///
    /// # Errors
    ///
    /// The faults of the suspension in words, or that it cannot move even the smallest travel.
    fn running(&self, name: &str, origin: &str, part: Part<'_>) -> Result<(String, Notes), String> {
        let read = |text: &str| Study::from_text(name, text, Path::new(""));
        let with = |travel: f64, outputs: &[&str]| self.text(origin, part, travel, outputs);
        // The first read has no outputs, so it reports a fault of the points once. With outputs, each output would report it
        // again.
        let explained = |reason: String| match self.slip(name, origin, part) {
            None => reason,
            Some(slip) => format!("{reason}\n{slip}"),
        };
        read(&with(TRAVELS[0], &[])).map_err(|errors| explained(errors.render(false)))?;
        let wanted: &[&str] = match part {
            Part::Wheel => &OUTPUTS,
            Part::Axle(_) => &AXLE_OUTPUTS,
            Part::Solid => &SOLID_OUTPUTS,
        };
        let available: Vec<&str> = wanted
            .iter()
            .filter(|output| read(&with(TRAVELS[0], &[output])).is_ok())
            .copied()
            .collect();
        let runs = |travel: f64| {
            let text = with(travel, &available);
            let study = read(&text).map_err(|errors| errors.render(false))?;
            let solved = Solved::of(&study)?;
            let why = || {
                let failures = solved.failures().into_iter();
                let failures = failures.map(|failure| failure.to_string());
                let remarks = solved.remarks().into_iter();
                let remarks = remarks.map(|remark| remark.replacen("warning: ", "", 1));
                let reasons = failures.chain(remarks).take(MOST_REASONS);
                reasons.collect::<Vec<_>>()
            };
            if !solved.is_complete() {
                return Ok(Err(why()));
            }
            let doubts = study_doubts(&study).map_err(|(_, fault)| fault.to_string())?;
            Ok::<_, String>(Ok((text, doubts)))
        };
        let mut note: Option<Vec<String>> = None;
        for travel in TRAVELS {
            match runs(travel)? {
                Ok((text, doubts)) => {
                    let mut notes = Notes::default();
                    doubts.into_iter().for_each(|doubt| notes.doubt(doubt));
                    notes.extend(note.map(|why| self.shortened(travel, &why)));
                    return Ok((text, notes));
                }
                Err(failures) => note = Some(failures),
            }
        }
        Err(explained(format!(
            "a suspension with these points cannot move {LEAST_TRAVEL} mm up and down from the \
             given position: is it {}, and are the names correct?",
            self.topology.name
        )))
    }

    /// Note that the range of motion is shorter than usual. `reasons` explain why the next longer range fails.
    fn shortened(&self, travel_mm: f64, reasons: &[String]) -> String {
        let unit = self.unit.symbol();
        let [travel, usual] = [travel_mm, TRAVELS[0]].map(|travel| self.travel(travel));
        format!(
            "[motion]: travel of {travel} {unit} up and down instead of the usual {usual} {unit}, because the suspension cannot \
             reach more ({}). Is a point wrong?",
            reasons.join("; ")
        )
    }

    /// Describes a coordinate that has a wrong sign or decimal place and thus keeps the suspension from moving. `None` if
    /// there is no such coordinate.
    fn slip(&self, name: &str, origin: &str, part: Part<'_>) -> Option<String> {
        let moves = |points: &[[f64; 3]]| {
            let mut other = self.clone();
            for (hardpoint, position) in other.hardpoints.iter_mut().zip(points) {
                hardpoint.position = *position;
            }
            let text = other.text(origin, part, LEAST_TRAVEL, &[]);
            let study = Study::from_text(name, &text, Path::new("")).ok()?;
            Some(Solved::of(&study).ok()?.is_complete())
        };
        let points: Vec<[f64; 3]> = self.hardpoints.iter().map(|h| h.position).collect();
        let slip = Slip::of(&points, |points| moves(points) == Some(true))?;
        let point = &self.hardpoints[slip.point];
        Some(in_words(point, &slip, "the suspension moves"))
    }

    /// Text of the study without elastic parts. `travel_mm` is the travel up and down in millimetres.
    fn text(&self, origin: &str, part: Part<'_>, travel_mm: f64, outputs: &[&str]) -> String {
        let unit = self.unit.symbol();
        let mut text = format!("# {}, from {}\n\n", self.topology.summary, one_line(origin));
        text += "[suspension]\n";
        let side = match part {
            Part::Wheel => Some(("side", self.side.name())),
            Part::Axle(_) | Part::Solid => None,
        };
        let keys = [("topology", self.topology.name)].into_iter().chain(side);
        for (key, value) in keys.chain([("length_unit", unit), ("frame", self.frame.name())]) {
            let _ = writeln!(text, "{key} = \"{value}\"");
        }
        if is_held_across(&self.hardpoints) {
            text += "single = [\"upper_link\"]         # one upper link, with its actual y\n";
        }
        text += "\n[suspension.hardpoints]          # design position\n";
        let lengths = self.hardpoints.iter().map(|h| h.name.len());
        let longest = lengths.max().unwrap_or(0);
        for hardpoint in &self.hardpoints {
            let [x, y, z] = hardpoint.position;
            let name = hardpoint.name;
            let from = format!("{:?}, {}", hardpoint.called, hardpoint.place);
            let _ = writeln!(
                text,
                "{name:longest$} = [{x:?}, {y:?}, {z:?}]   # {}",
                one_line(&from)
            );
        }
        let bodies: Vec<_> = self.seats.iter().filter_map(Seat::unusual).collect();
        if !bodies.is_empty() {
            text += "\n[suspension.bodies]\n";
            for (name, body) in bodies {
                let _ = writeln!(text, "{name} = \"{body}\"");
            }
        }
        text += &match part {
            Part::Wheel => String::new(),
            Part::Axle("") => "\n[axle]\nright = \"mirrored\"\n".to_owned(),
            Part::Axle(differences) => differences.to_owned(),
            Part::Solid => right_hardpoints(self.right_half.iter()),
        };
        self.wheel(&mut text);
        if !matches!(part, Part::Wheel) {
            self.spring(&mut text);
        }
        self.vehicle(&mut text, part);
        self.motion(&mut text, part, travel_mm);
        if !outputs.is_empty() {
            let names = outputs.iter().map(|name| format!("\"{name}\""));
            let names = names.collect::<Vec<_>>().join(", ");
            let _ = writeln!(text, "\n[outputs]\ncharacteristics = [{names}]");
        }
        text
    }

    /// Writes `[wheel]`. A radius that is not known becomes a comment.
    fn wheel(&self, text: &mut String) {
        *text += "\n[wheel]\n";
        let _ = match self.wheel_radius {
            Some(radius) => writeln!(
                text,
                "radius = {radius:?}                   # loaded radius"
            ),
            None => writeln!(
                text,
                "# radius = ...                 # loaded radius, {}",
                self.unit.symbol()
            ),
        };
        for (key, value) in [
            ("static_camber", self.static_camber),
            ("static_toe", self.static_toe),
            ("tyre_width", self.tyre_width),
            ("rim_diameter", self.rim_diameter),
        ] {
            if let Some(value) = value {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
    }

    /// Writes rate and force of the spring, if the file has them.
    fn spring(&self, text: &mut String) {
        let has_spring = self
            .hardpoints
            .iter()
            .any(|h| ["spring_lower", "strut_lower"].contains(&h.name));
        if let Some(spring) = self.figures.spring.filter(|_| has_spring) {
            let unit = self.unit.symbol();
            let _ = writeln!(
                text,
                "\n[spring]\nrate = {:?}                  # N/{unit} along the spring\nforce = {:?}                 # N in \
                 the design position",
                spring.rate, spring.force
            );
        }
    }

    /// Writes `[vehicle]`: dimensions of the car, and for an axle its position and unsprung mass, as far as the file has them.
    fn vehicle(&self, text: &mut String, part: Part<'_>) {
        let unsprung = self.figures.unsprung_mass;
        let unsprung = unsprung.filter(|_| !matches!(part, Part::Wheel));
        let is_axle = !matches!(part, Part::Wheel) && self.axle.is_some();
        let lengths = self.wheelbase.or(self.track).or(self.cg_height);
        if lengths.or(unsprung).is_none() && !is_axle {
            return;
        }
        *text += "\n[vehicle]\n";
        // The points of an axle define its track, so only the study of one wheel needs `track`.
        let track = self.track.filter(|_| matches!(part, Part::Wheel));
        for (key, length) in [
            ("wheelbase", self.wheelbase),
            ("track", track),
            ("cg_height", self.cg_height),
        ] {
            if let Some(length) = length {
                let _ = writeln!(text, "{key} = {length:?}");
            }
        }
        let position = match self.axle {
            Some(AxlePosition::Front) => "position = \"front\"\n",
            Some(AxlePosition::Rear) => "position = \"rear\"\n",
            None => "",
        };
        *text += position;
        if let Some(mass) = unsprung {
            let _ = writeln!(text, "unsprung_mass = {mass:?}           # kg, both wheels");
        }
    }

    /// Writes `[motion]`: travel of one wheel; roll and heave of an axle, or heave alone if the wheel radius is not known.
    fn motion(&self, text: &mut String, part: Part<'_>, travel_mm: f64) {
        let travel = self.travel(travel_mm);
        let _ = match part {
            Part::Wheel => writeln!(
                text,
                "\n[motion]\ntravel = {{ from = -{travel:?}, to = {travel:?}, steps = 41 }}   # wheel centre up = positive"
            ),
            // Roll needs the ground plane, and the wheel radius gives its height.
            Part::Axle(_) | Part::Solid if self.wheel_radius.is_none() => writeln!(
                text,
                "\n[motion]                         # roll needs radius in [wheel]\n\
                 heave = {{ from = -{travel:?}, to = {travel:?}, steps = 41 }}   # travel of both wheels"
            ),
            Part::Axle(_) | Part::Solid => {
                // The roll range is one degree per 20 mm of travel. So each wheel moves less than the travel.
                let (roll, heave) = (travel_mm / 20.0, self.travel(travel_mm / 2.0));
                writeln!(
                    text,
                    "\n[motion]                         # every combination is solved, on a plane ground\n\
                     roll = {{ from = -{roll:?}, to = {roll:?}, steps = 9 }}   # degrees; positive: right wheel in jounce\n\
                     heave = [-{heave:?}, 0.0, {heave:?}]   # mean travel of both wheels"
                )
            }
        };
    }

    /// Converts a travel from millimetres to the study's unit. In inches it is rounded down to a tenth.
    fn travel(&self, millimetres: f64) -> f64 {
        match self.unit {
            LengthUnit::Millimetre => millimetres,
            LengthUnit::Metre => millimetres / 1000.0,
            LengthUnit::Inch | LengthUnit::InchPound => (millimetres / 25.4 * 10.0).floor() / 10.0,
        }
    }
}

/// Section `[axle.right.hardpoints]` with the points of a right wheel or a right half. Empty without points.
fn right_hardpoints<'p>(points: impl Iterator<Item = &'p Hardpoint>) -> String {
    let line = |point: &Hardpoint| {
        let [x, y, z] = point.position;
        let from = one_line(&format!("{:?}, {}", point.called, point.place));
        format!("{} = [{x:?}, {y:?}, {z:?}]   # {from}\n", point.name)
    };
    let lines: String = points.map(line).collect();
    if lines.is_empty() {
        return lines;
    }
    format!("\n[axle.right.hardpoints]         # with their actual y\n{lines}")
}

/// Replaces line breaks and other control characters by blanks, so that a text fits into a comment.
pub(super) fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
