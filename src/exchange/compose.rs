//! The study of an imported wheel: a text that runs as it is.

use super::import::{Hardpoint, Imported};
use crate::characteristics::Characteristic;
use crate::model::LengthUnit;
use crate::solved::Solved;
use crate::study::Study;
use std::fmt::Write;
use std::path::Path;

/// The characteristics that the study asks for, as far as the points suffice for them.
const OUTPUTS: [Characteristic; 8] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::KingpinInclination,
    Characteristic::Caster,
    Characteristic::ScrubRadius,
    Characteristic::CasterTrail,
    Characteristic::HalfTrackChange,
    Characteristic::MotionRatio,
];

/// Travels that are tried, in millimetres, the largest first.
const TRAVELS: [f64; 6] = [80.0, 60.0, 40.0, 30.0, 20.0, 10.0];

impl Imported {
    /// The text of a study of the wheel. `name` is what the study goes by in messages, `origin` the file
    /// the points are from.
    ///
    /// # Errors
    ///
    /// The faults of the suspension that the points make, in words.
    pub fn study(&self, name: &str, origin: &str) -> Result<String, String> {
        let read = |text: &str| Study::from_text(name, text, Path::new(""));
        let with = |travel: f64, outputs: &[Characteristic]| self.text(origin, travel, outputs);
        // Whatever is wrong with the points is said once, not for each output.
        read(&with(TRAVELS[0], &[])).map_err(|errors| errors.render(false))?;
        let available: Vec<Characteristic> = OUTPUTS
            .into_iter()
            .filter(|output| read(&with(TRAVELS[0], &[*output])).is_ok())
            .collect();
        let runs = |travel: f64| {
            let text = with(travel, &available);
            let study = read(&text).map_err(|errors| errors.render(false))?;
            Ok::<_, String>(Solved::of(&study)?.is_complete().then_some(text))
        };
        for travel in TRAVELS {
            if let Some(text) = runs(travel)? {
                return Ok(text);
            }
        }
        let least = TRAVELS[TRAVELS.len() - 1];
        Err(format!(
            "the suspension that these points make does not move {least} mm up and down from where it is \
             drawn: is it {}, and are the names right?",
            self.topology.name
        ))
    }

    fn text(&self, origin: &str, travel_mm: f64, outputs: &[Characteristic]) -> String {
        let unit = self.unit.symbol();
        let mut text = format!("# {}, from {}\n\n", self.topology.summary, one_line(origin));
        text += "[suspension]\n";
        for (key, value) in [
            ("topology", self.topology.name),
            ("side", self.side.name()),
            ("length_unit", unit),
            ("frame", self.frame.name()),
        ] {
            let _ = writeln!(text, "{key} = \"{value}\"");
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
        let bodies = self.bodies();
        if !bodies.is_empty() {
            text += "\n[suspension.bodies]\n";
            for (name, body) in bodies {
                let _ = writeln!(text, "{name} = \"{body}\"");
            }
        }
        text += "\n[wheel]\n";
        match self.wheel_radius {
            Some(radius) => writeln!(
                text,
                "radius = {radius:?}                   # loaded radius"
            ),
            None => writeln!(
                text,
                "# radius = ...                 # loaded radius, {unit}"
            ),
        }
        .expect("a text takes everything");
        for (key, angle) in [
            ("static_camber", self.static_camber),
            ("static_toe", self.static_toe),
        ] {
            if let Some(angle) = angle {
                let _ = writeln!(text, "{key} = {angle:?}");
            }
        }
        let travel = self.travel(travel_mm);
        let _ = writeln!(
            text,
            "\n[motion]\ntravel = {{ from = -{travel:?}, to = {travel:?}, steps = 41 }}   # wheel centre up = positive"
        );
        if !outputs.is_empty() {
            let names = outputs.iter().map(|c| format!("\"{}\"", c.info().name));
            let names = names.collect::<Vec<_>>().join(", ");
            let _ = writeln!(text, "\n[outputs]\ncharacteristics = [{names}]");
        }
        text
    }

    /// A round travel in the file's unit, of about this number of millimetres.
    fn travel(&self, millimetres: f64) -> f64 {
        match self.unit {
            LengthUnit::Millimetre => millimetres,
            LengthUnit::Metre => millimetres / 1000.0,
            LengthUnit::Inch => (millimetres / 25.4 * 10.0).floor() / 10.0,
        }
    }

    /// The bodies that ends of springs and rods are mounted on, as far as the file names others than the usual ones.
    fn bodies(&self) -> Vec<(&'static str, &'static str)> {
        let seats = self.seats().into_iter();
        let said = seats.filter_map(|seat| Some((seat.hardpoint, seat.usual, seat.said?)));
        said.filter(|(_, usual, said)| said != usual)
            .map(|(hardpoint, _, said)| (hardpoint, said))
            .collect()
    }

    /// In words, the bodies assumed for those ends of springs and rods of which the file does not say where they are
    /// mounted.
    pub(super) fn assumed_bodies(&self) -> Option<String> {
        let seats = self.seats().into_iter().filter(|seat| seat.said.is_none());
        let name =
            |seat: Seat| format!("{} on the {}", seat.hardpoint, seat.usual.replace('_', " "));
        let assumed: Vec<String> = seats.map(name).collect();
        (!assumed.is_empty()).then(|| {
            format!(
                "bodies: {} is assumed, since the file says none; [suspension.bodies] says others",
                assumed.join(", ")
            )
        })
    }

    /// The hardpoints that may stand on several bodies.
    fn seats(&self) -> Vec<Seat> {
        let names: Vec<&'static str> = self.hardpoints.iter().map(|h| h.name).collect();
        let mechanism = (self.topology.build)(self.topology, &names);
        let seat = |hardpoint: &Hardpoint| {
            let id = mechanism.point(hardpoint.name)?;
            let possible = mechanism.possible_bodies(id);
            let usual = possible
                .iter()
                .find(|(_, body)| *body == mechanism.body(id));
            let said = possible
                .iter()
                .find(|(name, _)| hardpoint.body.as_deref() == Some(name));
            let seat = Seat {
                hardpoint: hardpoint.name,
                usual: usual?.0,
                said: said.map(|(name, _)| *name),
            };
            (possible.len() > 1).then_some(seat)
        };
        self.hardpoints.iter().filter_map(seat).collect()
    }
}

/// A hardpoint that may stand on several bodies.
struct Seat {
    hardpoint: &'static str,
    /// The body it is mounted on unless another is named.
    usual: &'static str,
    /// The body that the file says it is mounted on.
    said: Option<&'static str>,
}

/// A text for a comment.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
