//! `suspensions.ini` of Assetto Corsa: both axles of a car, points relative to the wheel centre.
//!
//! The sections `[FRONT]` and `[REAR]` give points as lateral, up, forward in metres, lateral positive inboard. In
//! files of `VERSION` 2 and above all points of a wheel are `RIM_OFFSET` further outboard than they are written. The wheel
//! centre is half of `TRACK` off the centre plane; the axles are `WHEELBASE` apart. In ISO 8855, with the origin
//! below the front axle at the height of the axle's wheel centre, a point is
//!
//! ```text
//! x = forward (front), forward - WHEELBASE (rear)
//! y = TRACK / 2 - lateral + RIM_OFFSET
//! z = up
//! ```
//!
//! | `TYPE` | topology |
//! |---|---|
//! | `DWB` | `double_wishbone` |
//! | `STRUT` | `macpherson` |
//! | `AXLE`, `ML` | refused by name |
//!
//! `STATIC_CAMBER` is in degrees, negative with the top inward. `TOE_OUT` is a length by which the steering rod
//! moves, no angle. Springs have rates at the wheel and no points.

use super::axes::{Axes, Declared};
use super::decimals::LARGEST;
use super::table::{Figure, Kind, Marks, NamedPoint, PointTable};
use crate::model::{AxlePosition, FrameConvention, LengthUnit};
use std::path::Path;

/// Keys of points and their hardpoints. Those of a topology are the keys of its `TYPE`.
pub(super) const POINTS: &[(&str, &str)] = &[
    ("STRUT_CAR", "strut_top"),
    ("STRUT_TYRE", "strut_lower"),
    ("WBCAR_TOP_FRONT", "upper_arm_front"),
    ("WBCAR_TOP_REAR", "upper_arm_rear"),
    ("WBCAR_BOTTOM_FRONT", "lower_arm_front"),
    ("WBCAR_BOTTOM_REAR", "lower_arm_rear"),
    ("WBTYRE_TOP", "upper_ball_joint"),
    ("WBTYRE_BOTTOM", "lower_ball_joint"),
    ("WBCAR_STEER", "tie_rod_inner"),
    ("WBTYRE_STEER", "tie_rod_outer"),
];

/// Keys that another simulation needs and a study of kinematics does not.
const RATES: &[&str] = &["SPRING_RATE", "DAMP_BUMP", "ROD_LENGTH", "TOE_OUT"];

/// Whether a file is of this kind: by its name, or by sections that JSON has not.
pub(super) fn is_ini(path: &Path, text: &str) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let is_named = extension.is_some_and(|extension| extension.eq_ignore_ascii_case("ini"));
    is_named
        || text
            .lines()
            .any(|line| matches!(section(line), Some("FRONT" | "REAR")) && text.contains("TRACK"))
}

fn section(line: &str) -> Option<&str> {
    let line = without_comment(line);
    line.strip_prefix('[')?.strip_suffix(']').map(str::trim)
}

fn without_comment(line: &str) -> &str {
    let end = line.find(';').unwrap_or(line.len());
    let line = &line[..end];
    let end = line.find("//").unwrap_or(line.len());
    line[..end].trim()
}

/// An assignment with its line.
struct Entry<'a> {
    section: &'a str,
    key: &'a str,
    value: &'a str,
    line: usize,
}

/// Reads the file.
///
/// # Errors
/// It has no axles, or a number is none.
pub(super) fn points_of(text: &str) -> Result<PointTable, String> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut within = "";
    for (line, number) in text.lines().zip(1..) {
        if let Some(name) = section(line) {
            within = name;
        } else if let Some((key, value)) = without_comment(line).split_once('=') {
            entries.push(Entry {
                section: within,
                key: key.trim(),
                value: value.trim(),
                line: number,
            });
        }
    }
    let file = File(entries);
    let axles = [("FRONT", AxlePosition::Front), ("REAR", AxlePosition::Rear)];
    let mut table = PointTable {
        unit: Some(LengthUnit::Metre),
        declared: Declared::whole(Axes::of(FrameConvention::Iso8855)),
        ..PointTable::default()
    };
    for (name, axle) in axles {
        if file.0.iter().any(|entry| entry.section == name) {
            file.axle(name, axle, &mut table)?;
        }
    }
    if table.kinds.is_empty() {
        return Err(
            "it is an .ini without the sections [FRONT] and [REAR] of a suspensions.ini of Assetto Corsa, the only \
             .ini that is read"
                .to_owned(),
        );
    }
    table.notes.push(
        "a suspensions.ini of Assetto Corsa: metres, iso8855; x from the front axle, z from the wheel centre".to_owned(),
    );
    Ok(table)
}

struct File<'a>(Vec<Entry<'a>>);

impl File<'_> {
    fn entry(&self, section: &str, key: &str) -> Option<&Entry<'_>> {
        // The game takes the first.
        let mut all = self.0.iter();
        all.find(|entry| entry.section == section && entry.key.eq_ignore_ascii_case(key))
    }

    fn number(&self, section: &str, key: &str) -> Result<Option<f64>, String> {
        let Some(entry) = self.entry(section, key) else {
            return Ok(None);
        };
        number(entry.value, entry.line).map(Some)
    }

    fn axle(&self, name: &str, axle: AxlePosition, table: &mut PointTable) -> Result<(), String> {
        let kind = self.entry(name, "TYPE").map_or("", |entry| entry.value);
        let kind = match kind.to_ascii_uppercase().as_str() {
            "DWB" => Kind::Topology("double_wishbone"),
            "STRUT" => Kind::Topology("macpherson"),
            "AXLE" => Kind::Other(format!(
                "[{name}] TYPE=AXLE is a live axle that joins both wheels; a study has wheels that move on their own"
            )),
            "ML" => Kind::Other(format!(
                "[{name}] TYPE=ML is a multilink of five rods in any order, which is not read yet; give its points as a \
                 table of a five_link"
            )),
            other => Kind::Other(format!("[{name}] TYPE is {other:?}; expected DWB or STRUT")),
        };
        let is_ours = matches!(kind, Kind::Topology(_));
        table.kinds.push((Some(axle), kind));
        if !is_ours {
            return Ok(());
        }
        let version = self.number("HEADER", "VERSION")?.unwrap_or(1.0);
        let offset = self.number(name, "RIM_OFFSET")?.unwrap_or(0.0);
        let offset = if version >= 2.0 { offset } else { 0.0 };
        let track = self.number(name, "TRACK")?;
        let wheelbase = self.number("BASIC", "WHEELBASE")?;
        let ahead = match axle {
            AxlePosition::Front => 0.0,
            AxlePosition::Rear => -wheelbase.unwrap_or(0.0),
        };
        // Without a track the wheel stays in the centre plane, which is asked about later.
        let half_track = track.unwrap_or(0.0) / 2.0;
        let marks = Marks {
            side: None,
            axle: Some(axle),
        };
        let point = |key: &str, hardpoint: &str, position, line: usize| NamedPoint {
            name: format!("{name} {key}"),
            read_as: hardpoint.to_owned(),
            marks,
            mirrored: true,
            position: Ok(position),
            body: None,
            place: format!("line {line}"),
        };
        for (key, hardpoint) in POINTS {
            let Some(entry) = self.entry(name, key) else {
                continue;
            };
            let parts: Result<Vec<f64>, String> = entry
                .value
                .split(',')
                .map(|part| number(part.trim(), entry.line))
                .collect();
            let [lateral, up, forward] = parts?[..] else {
                return Err(format!(
                    "line {}: {key} is {:?}; expected lateral, up, forward",
                    entry.line, entry.value
                ));
            };
            let position = [ahead + forward, half_track - lateral + offset, up];
            table
                .points
                .push(point(key, hardpoint, position, entry.line));
        }
        let line = self.entry(name, "TRACK").map_or(0, |entry| entry.line);
        let centre = [ahead, half_track, 0.0];
        table
            .points
            .push(point("TRACK", "wheel_centre", centre, line));
        let mut figure = |key: &str, read_as: &str, value: Option<f64>| {
            if let Some(value) = value {
                table.figures.push(Figure {
                    name: format!("{name} {key}"),
                    read_as: read_as.to_owned(),
                    value,
                    marks,
                    remark: String::new(),
                    place: format!("key {key} of [{name}]"),
                });
            }
        };
        figure(
            "STATIC_CAMBER",
            "static_camber",
            self.number(name, "STATIC_CAMBER")?,
        );
        figure("TRACK", "track", track);
        figure("WHEELBASE", "wheelbase", wheelbase);
        for key in RATES {
            if self.entry(name, key).is_some() {
                let why = match *key {
                    "TOE_OUT" => "a displacement of the steering rod, not a toe angle",
                    _ => "a rate or a length at the wheel, for which there is no hardpoint",
                };
                table.left_out.push(format!("[{name}] {key}: {why}"));
            }
        }
        Ok(())
    }
}

fn number(text: &str, line: usize) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    let number = number.filter(|n| n.abs() <= LARGEST);
    number.ok_or_else(|| format!("line {line}: expected a number, found {text:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_at_a_million_million() {
        assert_eq!(number("-1e12", 1), Ok(-1e12));
        for text in ["1.0001e12", "-1.0001e12", "inf", "nan", "x"] {
            let refused = number(text, 7).unwrap_err();
            assert!(refused.starts_with("line 7: ") && refused.contains(text));
        }
    }
}
