//! Text of the study of an imported wheel; it runs.

use super::import::Imported;
use super::seats::Seat;
use crate::characteristics::Characteristic;
use crate::model::{AxlePosition, LengthUnit};
use crate::solved::Solved;
use crate::study::Study;
use std::fmt::Write;
use std::path::Path;

/// Characteristics of the study, as far as its points suffice.
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
        // Report a fault of the points once, not for each output.
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
        let bodies: Vec<_> = self.seats.iter().filter_map(Seat::unusual).collect();
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
        self.vehicle(&mut text);
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

    /// The car's figures, where the file has any.
    fn vehicle(&self, text: &mut String) {
        if self.wheelbase.or(self.track).is_none() {
            return;
        }
        *text += "\n[vehicle]\n";
        for (key, length) in [("wheelbase", self.wheelbase), ("track", self.track)] {
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
    }

    /// A round travel in the file's unit, of about this number of millimetres.
    fn travel(&self, millimetres: f64) -> f64 {
        match self.unit {
            LengthUnit::Millimetre => millimetres,
            LengthUnit::Metre => millimetres / 1000.0,
            LengthUnit::Inch => (millimetres / 25.4 * 10.0).floor() / 10.0,
        }
    }
}

/// A text for a comment.
fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
