//! `suspensions.ini` of Assetto Corsa: both axles of a car, with points relative to the wheel centre.
//!
//! The sections `[FRONT]` and `[REAR]` give points as lateral, up and forward in metres; lateral is positive inboard. In files of
//! `VERSION` 2 and above, all points of a wheel are `RIM_OFFSET` further outboard than the file says. The wheel centre is half of
//! `TRACK` away from the centre plane. The axles are `WHEELBASE` apart. The importer uses the axes of ISO 8855.
//! The origin is midway between the front wheel centres. Heights are relative to the wheel centre of the point's axle. The
//! coordinates of a point are
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
//! | `AXLE` | `solid_axle`, see `assetto_axle` |
//! | `ML` | rejected with a message |
//!
//! `STATIC_CAMBER` is in degrees, negative with the top inward. `TOE_OUT` is not an angle but a length by which the steering rod
//! moves. `SPRING_RATE` is the rate at the wheel in N/m; the file has no points of springs. All other values are lengths in metres
//! and masses in kg.
//!
//! `BASEY` is the height of the wheel centre above the centre of gravity of the car. `CG_LOCATION` is the fraction of the weight
//! on the front axle. The file `car.ini` in the same folder has the mass.

use super::assetto_axle::{self, End, Link};
use super::decimals::LARGEST;
use super::notes::Notes;
use super::source::{bytes_of, decoded};
use super::table::{AxleFigures, CarFigures, Figure, Kind, Marks, Mass, NamedPoint, PointTable};
use crate::model::{AxlePosition, Topology};
use std::path::Path;

/// Keys of points with their hardpoints. An axle uses only the keys of its `TYPE`; the import lists the others as left out.
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

/// Keys that a study cannot represent, with the reason.
const LEFT_OUT: &[(&str, &str)] = &[
    (
        "ROD_LENGTH",
        "a length at the wheel that sets the ride height; no hardpoint corresponds to it",
    ),
    ("DAMP_BUMP", "a study has no dampers"),
    ("DAMP_REBOUND", "a study has no dampers"),
    (
        "BUMP_STOP_RATE",
        "a stop at the wheel; stops of a study act along the spring",
    ),
    (
        "TOE_OUT",
        "a displacement of the steering rod, not a toe angle",
    ),
];

/// Largest number of links of a live axle that are read: J0 to J15.
const MOST_LINKS: usize = 16;

/// True if a file is a `suspensions.ini`: its name ends with `.ini`, or it has a section `[FRONT]` or `[REAR]` and the word
/// `TRACK`.
pub(super) fn is_ini(path: &Path, text: &str) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let is_named = extension.is_some_and(|extension| extension.eq_ignore_ascii_case("ini"));
    is_named
        || text
            .lines()
            .any(|line| matches!(section(line), Some("FRONT" | "REAR")) && text.contains("TRACK"))
}

/// Name of the section that begins on a line.
fn section(line: &str) -> Option<&str> {
    let line = without_comment(line);
    line.strip_prefix('[')?.strip_suffix(']').map(str::trim)
}

/// Removes a comment, which begins with `;` or `//`.
fn without_comment(line: &str) -> &str {
    let end = line.find(';').unwrap_or(line.len());
    let line = &line[..end];
    let end = line.find("//").unwrap_or(line.len());
    line[..end].trim()
}

/// An assignment `KEY=value` with its line number.
struct Entry<'a> {
    section: &'a str,
    key: &'a str,
    value: &'a str,
    line: usize,
}

/// Splits a file into its assignments.
fn assignments(text: &str) -> File<'_> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut of_links = Vec::new();
    let mut within = "";
    for (line, number) in text.lines().zip(1..) {
        if let Some(name) = section(line) {
            within = name;
            if name == "AXLE" {
                of_links.push(number);
            }
        } else if let Some((key, value)) = without_comment(line).split_once('=') {
            entries.push(Entry {
                section: within,
                key: key.trim(),
                value: value.trim(),
                line: number,
            });
        }
    }
    File { entries, of_links }
}

/// Reads the points of the file, and the mass from `car.ini` in the same folder.
///
/// # Errors
/// The file has no axles, a value is not a number, or the links of a live axle are not clear.
pub(super) fn points_of(path: &Path, text: &str) -> Result<PointTable, String> {
    let file = assignments(text);
    file.check_links()?;
    let axles = [("FRONT", AxlePosition::Front), ("REAR", AxlePosition::Rear)];
    let mut table = PointTable::in_metres();
    for (name, axle) in axles {
        if file.entries.iter().any(|entry| entry.section == name) {
            file.axle(name, axle, &mut table)?;
        }
    }
    if table.kinds.is_empty() {
        return Err(
            "it is an .ini file without the sections [FRONT] and [REAR] of a suspensions.ini of \
             Assetto Corsa; other .ini files cannot be read"
                .to_owned(),
        );
    }
    table.notes.push(
        "a suspensions.ini of Assetto Corsa: metres, iso8855; x from the front axle, z from the wheel centre".to_owned(),
    );
    table.car = Some(file.car(path, &mut table.notes)?);
    Ok(table)
}

/// Assignments of a file.
struct File<'a> {
    entries: Vec<Entry<'a>>,
    /// Line numbers of the headings `[AXLE]`, counted from 1.
    of_links: Vec<usize>,
}

impl File<'_> {
    /// First assignment of a key in a section. Upper and lower case of the key are equal.
    fn entry(&self, section: &str, key: &str) -> Option<&Entry<'_>> {
        // The game uses the first assignment of a key.
        let mut all = self.entries.iter();
        all.find(|entry| entry.section == section && entry.key.eq_ignore_ascii_case(key))
    }

    /// `TYPE` of an axle in capitals. Empty if the file has none.
    fn kind_of(&self, name: &str) -> String {
        let entry = self.entry(name, "TYPE");
        entry.map_or(String::new(), |entry| entry.value.to_ascii_uppercase())
    }

    /// Number under a key. `None` if the file has no such key.
    fn number(&self, section: &str, key: &str) -> Result<Option<f64>, String> {
        let Some(entry) = self.entry(section, key) else {
            return Ok(None);
        };
        number(entry.value, entry.line).map(Some)
    }

    /// Refuses a file in which the links of `[AXLE]` could belong to either of two axles.
    fn check_links(&self) -> Result<(), String> {
        let is_live = ["FRONT", "REAR"].map(|name| self.kind_of(name) == "AXLE");
        if let ([true, _] | [_, true], [first, second, ..]) = (is_live, &self.of_links[..]) {
            return Err(format!(
                "line {second}: a second section [AXLE], after that of line {first}. The game reads only one, so it is not \
                 clear which links belong to the axle: keep one section"
            ));
        }
        if is_live == [true, true] {
            return Err(
                "[FRONT] and [REAR] have TYPE=AXLE, but [AXLE] has the links of one axle only: remove [FRONT] or [REAR]"
                    .to_owned(),
            );
        }
        Ok(())
    }

    /// Adds the ends of the links of `[AXLE]`, with their hardpoints if they can be identified. Returns the kind of the axle.
    fn live_axle(&self, axle: AxlePosition, table: &mut PointTable) -> Result<Kind, String> {
        let count = self.number("AXLE", "LINK_COUNT")?;
        let mut links = Vec::new();
        for number in 0..MOST_LINKS {
            let ends = ["CAR", "AXLE"].map(|end| self.entry("AXLE", &format!("J{number}_{end}")));
            let (car, axle) = match ends {
                [Some(car), Some(axle)] => (car, axle),
                [None, None] => continue,
                [Some(entry), None] | [None, Some(entry)] => {
                    return Err(format!(
                        "line {}: [AXLE] has {}, but not the other end of this link",
                        entry.line, entry.key
                    ));
                }
            };
            let end = |entry: &Entry| {
                triple(entry).map(|place| End {
                    place,
                    line: entry.line,
                })
            };
            links.push(Link {
                number,
                ends: [end(car)?, end(axle)?],
            });
        }
        if let Some(count) = count
            && count != links.len() as f64
        {
            return Err(format!(
                "[AXLE] LINK_COUNT is {count}, but the section has both ends of {} links",
                links.len()
            ));
        }
        let ahead = self.ahead(axle)?;
        let marks = Marks {
            side: None,
            axle: Some(axle),
        };
        let mut add = |link: &Link, part: Option<&str>| {
            for (end, (key, body)) in link.ends.iter().zip([("CAR", "chassis"), ("AXLE", "axle")]) {
                let [lateral, up, forward] = end.place;
                let name = format!("AXLE J{}_{key}", link.number);
                table.points.push(NamedPoint {
                    read_as: part.map_or(name.clone(), |part| format!("{part}_{body}")),
                    name,
                    marks,
                    mirrored: false,
                    position: Ok([ahead + forward, lateral, up]),
                    has_number: true,
                    body: None,
                    place: format!("line {}", end.line),
                });
            }
        };
        match assetto_axle::meanings(&links) {
            Ok((meanings, note)) => {
                for meaning in meanings {
                    add(&meaning.link, Some(meaning.part));
                }
                table.notes.extend(note);
                Ok(Kind::Topology("solid_axle"))
            }
            Err(reason) => {
                for link in &links {
                    add(link, None);
                }
                Ok(Kind::Unclear("solid_axle", reason))
            }
        }
    }

    /// Position of an axle along x, in metres: 0 for the front axle, -WHEELBASE for the rear axle. 0 if the file has no wheelbase.
    fn ahead(&self, axle: AxlePosition) -> Result<f64, String> {
        Ok(match axle {
            AxlePosition::Front => 0.0,
            AxlePosition::Rear => -self.number("BASIC", "WHEELBASE")?.unwrap_or(0.0),
        })
    }

    /// Masses, centre of gravity and position of the rear axle, as far as this file and `car.ini` have them.
    fn car(&self, path: &Path, notes: &mut Notes) -> Result<CarFigures, String> {
        let below = ["FRONT", "REAR"].map(|name| self.number(name, "BASEY"));
        let [front, rear] = below;
        let (front, rear) = (front?, rear?);
        let wheelbase = self.number("BASIC", "WHEELBASE")?;
        // The file gives the height of both wheel centres relative to the centre of gravity.
        let rear_offset = match (front, rear, wheelbase) {
            (Some(front), Some(rear), Some(_)) => Some([0.0, 0.0, rear - front]),
            _ => None,
        };
        let share = self.number("BASIC", "CG_LOCATION")?;
        let mass = total_mass(path, notes)?;
        let mass = match (mass, front, share, wheelbase) {
            (Some(mass), Some(front), Some(share), Some(wheelbase)) => Some(Mass {
                is_sprung: false,
                mass,
                cg: [(share - 1.0) * wheelbase, 0.0, -front],
            }),
            _ => None,
        };
        let mut axles = [AxleFigures::default(); 2];
        for (own, name) in axles.iter_mut().zip(["FRONT", "REAR"]) {
            // HUB_MASS of a live axle is not used.
            let is_live = self.kind_of(name) == "AXLE";
            let hub = self.number(name, "HUB_MASS")?.filter(|_| !is_live);
            own.unsprung_mass = hub.map(|hub| 2.0 * hub);
        }
        Ok(CarFigures {
            rear_offset,
            mass,
            axles,
        })
    }

    /// Adds a note that explains why the rate at the wheel is not enough for a spring, and how to get a spring.
    fn spring_rate(&self, name: &str, table: &mut PointTable) -> Result<(), String> {
        let Some(rate) = self.number(name, "SPRING_RATE")? else {
            return Ok(());
        };
        let ends = match self.kind_of(name).as_str() {
            "STRUT" => "the spring's force in the design position is not in the file",
            _ => "the spring's ends are not in the file: add spring_upper and spring_lower",
        };
        table.left_out.push(format!(
            "[{name}] SPRING_RATE: {rate} N/m at the wheel. The rate in [spring], along the spring, is {rate} / motion_ratio^2; {ends}"
        ));
        Ok(())
    }

    /// Topology of an axle, from its `TYPE`. Adds the links of a live axle to the table.
    fn kind(&self, name: &str, axle: AxlePosition, table: &mut PointTable) -> Result<Kind, String> {
        Ok(match self.kind_of(name).as_str() {
            "DWB" => Kind::Topology("double_wishbone"),
            "STRUT" => Kind::Topology("macpherson"),
            "AXLE" if self.entry(name, "TRACK").is_none() => Kind::Other(format!(
                "[{name}] has no TRACK, so the positions of the wheels of this axle are not known: add TRACK in metres"
            )),
            "AXLE" => self.live_axle(axle, table)?,
            "ML" => Kind::Other(format!(
                "[{name}] TYPE=ML is a multilink of five rods in any order, which cannot be read \
                 yet; give its points as a table of a five_link"
            )),
            other => Kind::Other(format!(
                "[{name}] TYPE is {other:?}; expected DWB, STRUT or AXLE"
            )),
        })
    }

    /// Adds the points and values of an axle: section `name`.
    fn axle(&self, name: &str, axle: AxlePosition, table: &mut PointTable) -> Result<(), String> {
        let kind = self.kind(name, axle, table)?;
        let topology = match &kind {
            Kind::Topology(topology) | Kind::Unclear(topology, _) => Topology::named(topology),
            Kind::Other(_) => None,
        };
        table.kinds.push((Some(axle), kind));
        let Some(topology) = topology else {
            return Ok(());
        };
        let version = self.number("HEADER", "VERSION")?.unwrap_or(1.0);
        let offset = self.number(name, "RIM_OFFSET")?.unwrap_or(0.0);
        let offset = if version >= 2.0 { offset } else { 0.0 };
        let track = self.number(name, "TRACK")?;
        let wheelbase = self.number("BASIC", "WHEELBASE")?;
        let ahead = self.ahead(axle)?;
        // Without a track, the wheel stays in the centre plane. The importer asks for the half track later.
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
            has_number: true,
            body: None,
            place: format!("line {line}"),
        };
        // A section may also contain points of another suspension type. The game ignores these points.
        let mut ignored = Vec::new();
        for (key, hardpoint) in POINTS {
            let Some(entry) = self.entry(name, key) else {
                continue;
            };
            if topology.hardpoints.iter().all(|own| own.name != *hardpoint) {
                ignored.push(*key);
                continue;
            }
            let [lateral, up, forward] = triple(entry)?;
            let position = [ahead + forward, half_track - lateral + offset, up];
            table
                .points
                .push(point(key, hardpoint, position, entry.line));
        }
        if !ignored.is_empty() {
            table.left_out.push(format!(
                "[{name}] {}: points of another TYPE",
                ignored.join(", ")
            ));
        }
        // Every axle of a known kind has a TYPE, so its line replaces a missing line of TRACK.
        let line = self.entry(name, "TRACK").or(self.entry(name, "TYPE"));
        let line = line.map_or(0, |entry| entry.line);
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
        self.spring_rate(name, table)?;
        for (key, why) in LEFT_OUT {
            if self.entry(name, key).is_some() {
                table.left_out.push(format!("[{name}] {key}: {why}"));
            }
        }
        Ok(())
    }
}

/// Mass of the whole car from `car.ini` in the same folder, in kg. `None` if that file does not exist, or has no mass above 0.
fn total_mass(path: &Path, notes: &mut Notes) -> Result<Option<f64>, String> {
    let beside = path.with_file_name("car.ini");
    if !beside.is_file() {
        return Ok(None);
    }
    let text = decoded(&bytes_of(&beside)?).map_err(|reason| format!("car.ini: {reason}"))?;
    let mass = assignments(&text)
        .number("BASIC", "TOTALMASS")
        .map_err(|reason| format!("car.ini: {reason}"))?;
    if mass.is_some() {
        notes.push("mass: TOTALMASS of car.ini in the same folder".to_owned());
    }
    Ok(mass.filter(|mass| *mass > 0.0))
}

/// Reads three numbers: lateral, up and forward.
fn triple(entry: &Entry<'_>) -> Result<[f64; 3], String> {
    let parts: Result<Vec<f64>, String> = entry
        .value
        .split(',')
        .map(|part| number(part.trim(), entry.line))
        .collect();
    parts?.try_into().map_err(|_| {
        format!(
            "line {}: {} is {:?}; expected lateral, up, forward",
            entry.line, entry.key, entry.value
        )
    })
}

/// Parses a number with a decimal point. `line` is the number of its line, for the error message.
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
