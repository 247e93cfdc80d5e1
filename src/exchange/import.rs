//! A study from a file of points: who is who, which wheel, which axes, which unit. What is guessed is
//! said; what is not certain is refused.

use super::names::{self, Figure, Words};
use super::orientation::Directions;
use super::points::{NamedPoint, PointTable};
use crate::model::{Frame, FrameConvention, LengthUnit, Side, Topology};
use std::collections::BTreeMap;

/// What the user has said about a file.
#[derive(Clone, Copy)]
pub struct ImportOptions<'a> {
    /// The kind of suspension.
    pub topology: &'static Topology,
    /// The unit of length.
    pub unit: Option<LengthUnit>,
    /// The axes.
    pub frame: Option<FrameConvention>,
    /// The wheel.
    pub side: Option<Side>,
    /// Names in the file by hardpoint, where the table of usual names is not enough.
    pub names: &'a BTreeMap<String, String>,
}

/// A hardpoint that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Hardpoint {
    /// Its name in studies.
    pub name: &'static str,
    /// Its coordinates, in the file's axes and unit.
    pub position: [f64; 3],
    /// Its name in the file.
    pub called: String,
    /// Its place in the file.
    pub place: String,
    /// The body it sits on, where the file says so.
    pub body: Option<String>,
}

/// The wheel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Its topology.
    pub topology: &'static Topology,
    /// Its hardpoints, in the topology's order.
    pub hardpoints: Vec<Hardpoint>,
    /// Which wheel it is.
    pub side: Side,
    /// Its axes.
    pub frame: FrameConvention,
    /// Its unit.
    pub unit: LengthUnit,
    /// Loaded radius of the wheel.
    pub wheel_radius: Option<f64>,
    /// Camber in the design position, degrees.
    pub static_camber: Option<f64>,
    /// Toe in the design position, degrees.
    pub static_toe: Option<f64>,
    /// Notes on guesses, and on parts of the file that were left over.
    pub notes: Vec<String>,
}

/// Finds the wheel in a file's points.
pub fn import(table: &PointTable, options: &ImportOptions<'_>) -> Result<Imported, String> {
    let mut notes = table.notes.clone();
    let meanings = meanings(table, options)?;
    let is_of = |side: Side| {
        let mut known = table
            .points
            .iter()
            .zip(&meanings)
            .filter(|(_, m)| m.is_some());
        known.any(|(point, _)| point.side == Some(side) || point.mirrored)
    };
    let marked = Side::ALL.into_iter().find(|side| is_of(*side));
    let wheel = options.side.or(marked);
    let mut hardpoints = Vec::new();
    for known in options.topology.all_hardpoints() {
        let candidates = table.points.iter().zip(&meanings);
        let candidates = candidates.filter(|(_, meaning)| **meaning == Some(known.name));
        let candidates: Vec<&NamedPoint> = candidates.map(|(point, _)| point).collect();
        if let Some(found) = of_wheel(known.name, &candidates, wheel, &mut notes)? {
            hardpoints.push(found);
        }
    }
    drop_incomplete(options.topology, &mut hardpoints, &mut notes);
    let left_over = left_over(table, &meanings, &hardpoints);
    missing(options.topology, &hardpoints, &left_over)?;
    say_guessed(&hardpoints, &mut notes);

    if let Some(other) = rather(options.topology, &left_over, table) {
        notes.push(format!(
            "doubtful: with what is left over the points make a {}; --topology {} would use them",
            other.name.replace('_', " "),
            other.name
        ));
    }

    let unit = unit(table, options, &hardpoints, &mut notes)?;
    let (frame, side) = orientation(table, options, wheel, &hardpoints, &mut notes)?;
    if !left_over.is_empty() {
        notes.push(format!("left over: {}", left_over.join(", ")));
    }
    let mut imported = Imported {
        topology: options.topology,
        hardpoints,
        side,
        frame,
        unit,
        wheel_radius: None,
        static_camber: None,
        static_toe: None,
        notes,
    };
    figures(table, wheel, &mut imported)?;
    imported.notes.extend(imported.assumed_bodies());
    Ok(imported)
}

/// The hardpoint each point of the file means.
fn meanings(
    table: &PointTable,
    options: &ImportOptions<'_>,
) -> Result<Vec<Option<&'static str>>, String> {
    let same = |a: &str, b: &str| a.trim().to_lowercase() == b.trim().to_lowercase();
    for (hardpoint, name) in options.names {
        if options.topology.hardpoint(hardpoint).is_none() {
            return Err(format!(
                "--map: {} has no hardpoint {hardpoint:?}",
                options.topology.name
            ));
        }
        if !table.points.iter().any(|point| same(&point.name, name)) {
            return Err(format!(
                "--map: the file has no point {name:?}, which {hardpoint} is to be"
            ));
        }
    }
    let meaning = |point: &NamedPoint| {
        let mapped = options
            .names
            .iter()
            .find(|(_, name)| same(name, &point.name));
        match mapped {
            Some((hardpoint, _)) => options.topology.hardpoint(hardpoint).map(|h| h.name),
            None => names::hardpoint(&point.name, options.topology)
                .filter(|hardpoint| !options.names.contains_key(*hardpoint)),
        }
    };
    Ok(table.points.iter().map(meaning).collect())
}

/// The point of the wanted wheel among those of one meaning.
fn of_wheel(
    name: &'static str,
    candidates: &[&NamedPoint],
    wheel: Option<Side>,
    notes: &mut Vec<String>,
) -> Result<Option<Hardpoint>, String> {
    // What is closest to the wheel first: its own rows, those for both, those without a side, and at last
    // the other wheel's.
    let rank = |point: &NamedPoint| match (point.side, point.mirrored) {
        (Some(side), _) if Some(side) == wheel => 0,
        (None, true) => 1,
        (None, false) => 2,
        _ => 3,
    };
    let Some(best) = candidates.iter().map(|point| rank(point)).min() else {
        return Ok(None);
    };
    let mut chosen = candidates.iter().filter(|point| rank(point) == best);
    let first = chosen.next().expect("one has the best rank");
    if let Some(second) = chosen.find(|other| other.position != first.position) {
        return Err(format!(
            "{:?} ({}) and {:?} ({}) both seem to be {name}, with different coordinates: say with --map which \
             it is, or remove one",
            first.name, first.place, second.name, second.place
        ));
    }
    let mut position = first
        .position
        .clone()
        .map_err(|reason| format!("{name}: {reason}"))?;
    let is_mirrored = best == 3 || (best == 1 && wheel == Some(Side::Right));
    if is_mirrored {
        position[1] = 0.0 - position[1];
    }
    if best == 3 {
        notes.push(format!(
            "{name}: mirrored from the other wheel's {:?}",
            first.name
        ));
    }
    Ok(Some(Hardpoint {
        name,
        position,
        called: first.name.clone(),
        place: first.place.clone(),
        body: first.body.clone(),
    }))
}

/// Leaves out springs, rockers and bars of which something is missing.
fn drop_incomplete(
    topology: &'static Topology,
    hardpoints: &mut Vec<Hardpoint>,
    notes: &mut Vec<String>,
) {
    for group in topology.groups {
        let given = |name: &&&str| hardpoints.iter().any(|h| h.name == **name);
        let complete = |list: &&&[&str]| list.iter().all(|name| given(&name));
        let lists = || group.complete.iter();
        let in_complete: Vec<&&str> = lists().filter(complete).copied().flatten().collect();
        let loose = lists().copied().flatten().filter(given);
        let loose: Vec<&str> = loose
            .filter(|n| !in_complete.contains(n))
            .copied()
            .collect();
        if loose.is_empty() {
            continue;
        }
        let nearest = lists().max_by_key(|list| list.iter().filter(given).count());
        let missing = nearest.copied().into_iter().flatten();
        let missing: Vec<&str> = missing.filter(|name| !given(name)).copied().collect();
        notes.push(format!(
            "{} is left out: {} is there, {} is missing",
            group.what,
            loose.join(", "),
            missing.join(", ")
        ));
        hardpoints.retain(|h| !loose.contains(&h.name));
    }
}

/// The names of the file that mean nothing here, each once.
fn left_over(
    table: &PointTable,
    meanings: &[Option<&'static str>],
    hardpoints: &[Hardpoint],
) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (point, meaning) in table.points.iter().zip(meanings) {
        let is_used = meaning.is_some_and(|name| hardpoints.iter().any(|h| h.name == name));
        let is_figure = Words::of(&point.name).figure().is_some();
        if !is_used && !is_figure && !names.contains(&point.name) {
            names.push(point.name.clone());
        }
    }
    names
}

/// Another topology that lacks nothing and uses points that are left over.
fn rather(
    topology: &Topology,
    left_over: &[String],
    table: &PointTable,
) -> Option<&'static Topology> {
    let mut others = Topology::ALL.iter().filter(|other| **other != topology);
    let found = others.find(|other| {
        let is_there = |name: &str| {
            let mut names = table.points.iter().map(|point| &point.name);
            names.any(|given| names::hardpoint(given, other) == Some(name))
        };
        let required = other.hardpoints.iter().filter(|h| h.required);
        let needs = |given: &String| {
            let meant = names::hardpoint(given, other).and_then(|name| other.hardpoint(name));
            meant.is_some_and(|hardpoint| hardpoint.required)
        };
        required.map(|h| h.name).all(is_there) && left_over.iter().any(needs)
    });
    found.copied()
}

fn missing(
    topology: &Topology,
    hardpoints: &[Hardpoint],
    left_over: &[String],
) -> Result<(), String> {
    let given = |name: &str| hardpoints.iter().any(|h| h.name == name);
    let required = topology.hardpoints.iter().filter(|h| h.required);
    let missing: Vec<String> = required
        .filter(|h| !given(h.name))
        .map(|h| format!("  {} ({})", h.name, h.about))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut message = format!("missing for {}:\n{}", topology.name, missing.join("\n"));
    let found: Vec<String> = hardpoints
        .iter()
        .map(|h| format!("{} from {:?}", h.name, h.called))
        .collect();
    if !found.is_empty() {
        message += &format!("\nfound: {}", found.join(", "));
    }
    if !left_over.is_empty() {
        message += &format!(
            "\nleft over: {}\nIf some of these are the missing ones, say so in a file for --map, as in\n  {} = {:?}",
            left_over.join(", "),
            missing[0].split_whitespace().next().unwrap_or(""),
            left_over[0]
        );
    }
    Err(message)
}

fn say_guessed(hardpoints: &[Hardpoint], notes: &mut Vec<String>) {
    let guessed: Vec<String> = hardpoints
        .iter()
        .filter(|h| h.name != h.called)
        .map(|h| format!("{:?} is {}", h.called, h.name))
        .collect();
    if !guessed.is_empty() {
        notes.insert(0, format!("names: {}", guessed.join(", ")));
    }
}

/// Sizes of a wheel's suspension, in metres, by which a unit is recognised.
const USUAL_SIZE: [f64; 2] = [0.15, 3.0];

fn unit(
    table: &PointTable,
    options: &ImportOptions<'_>,
    hardpoints: &[Hardpoint],
    notes: &mut Vec<String>,
) -> Result<LengthUnit, String> {
    let centre = hardpoints.iter().find(|h| h.name == "wheel_centre");
    let centre = centre.map_or([0.0; 3], |h| h.position);
    let distance = |h: &Hardpoint| {
        let squares = h
            .position
            .iter()
            .zip(centre)
            .map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    let size = hardpoints.iter().map(distance).fold(0.0, f64::max);
    let [least, most] = USUAL_SIZE;
    let fits = |unit: &LengthUnit| (least..=most).contains(&(size / unit.per_metre()));
    let fitting = LengthUnit::ALL.into_iter().find(fits);
    let said = match (options.unit, table.unit) {
        (Some(unit), written) => {
            if written.is_some_and(|written| written != unit) {
                notes.push(format!(
                    "the file's own unit is overruled by --unit {}",
                    unit.symbol()
                ));
            }
            Some(unit)
        }
        (None, written) => written,
    };
    match (said, fitting) {
        (Some(unit), _) if fits(&unit) => Ok(unit),
        (Some(unit), fitting) => {
            let better = fitting.map_or(String::new(), |unit| {
                format!("; in {} they would be", unit.symbol())
            });
            notes.push(format!(
                "doubtful: the points are {size:.4} {} apart, which is not the size of a car's suspension{better}",
                unit.symbol()
            ));
            Ok(unit)
        }
        (None, Some(unit)) => {
            notes.push(format!(
                "unit: {}, since the points are {size:.4} apart (--unit says another)",
                unit.symbol()
            ));
            Ok(unit)
        }
        (None, None) => Err(format!(
            "the points are {size:.4} apart, which is the size of no car's suspension in mm, m or in: say the \
             unit with --unit"
        )),
    }
}

fn orientation(
    table: &PointTable,
    options: &ImportOptions<'_>,
    wheel: Option<Side>,
    hardpoints: &[Hardpoint],
    notes: &mut Vec<String>,
) -> Result<(FrameConvention, Side), String> {
    let points: Vec<_> = hardpoints.iter().map(|h| (h.name, h.position)).collect();
    let directions = Directions::of(options.topology, &points);
    let shown = directions.describe();
    if let (Some(frame), Some(side)) = (options.frame, options.side) {
        let meant = Frame::new(frame, side);
        if !directions.allow_side(meant) {
            return Err(format!(
                "in these coordinates {shown}: that is not the {} wheel in {}{}",
                side.name(),
                frame.name(),
                suggestion(&directions)
            ));
        }
        if !directions.allow(meant) {
            notes.push(format!(
                "doubtful: {shown}, which does not fit {}",
                frame.name()
            ));
        }
        return Ok((frame, side));
    }
    let frame = options.frame.or(table.frame);
    let allowed = directions.allowed().into_iter();
    let fitting = |frame: Option<FrameConvention>| {
        let fits = move |(convention, side): &(FrameConvention, Side)| {
            frame.is_none_or(|frame| frame == *convention)
                && wheel.is_none_or(|wheel| wheel == *side)
        };
        allowed.clone().find(fits)
    };
    // What a file says of its axes gives way to what they show, what the user says does not.
    let found = fitting(frame).or_else(|| fitting(options.frame));
    let Some((convention, side)) = found else {
        let asked = [
            options.frame.map(FrameConvention::name),
            wheel.map(Side::name),
        ];
        let asked: Vec<&str> = asked.into_iter().flatten().collect();
        return Err(format!(
            "in these coordinates {shown}, which fits no{} frame of iso8855 (x forward, y left, z up), sae_j670 \
             (x forward, y right, z down) and x_rear (x rearward, y right, z up){}",
            if asked.is_empty() {
                String::new()
            } else {
                format!(" {}", asked.join(", "))
            },
            suggestion(&directions)
        ));
    };
    let said = options.frame == Some(convention) || table.frame == Some(convention);
    if !said || wheel != Some(side) {
        notes.push(format!(
            "axes: {}, {} wheel, since {shown} (--frame and --side say others)",
            convention.name(),
            side.name()
        ));
    }
    Ok((convention, side))
}

fn suggestion(directions: &Directions) -> String {
    let allowed = directions.allowed();
    let named: Vec<String> = allowed
        .iter()
        .map(|(frame, side)| format!("--frame {} --side {}", frame.name(), side.name()))
        .collect();
    match named.is_empty() {
        true => String::new(),
        false => format!("; they would be {}", named.join(" or ")),
    }
}

/// Camber, toe and radius, where the file has them.
fn figures(table: &PointTable, wheel: Option<Side>, imported: &mut Imported) -> Result<(), String> {
    let mut given: Vec<(Figure, f64)> = Vec::new();
    for (name, value, place) in &table.figures {
        let words = Words::of(name);
        let Some(figure) = words.figure() else {
            continue;
        };
        if words.side.is_some() && wheel.is_some() && words.side != wheel {
            continue;
        }
        if let Some((_, other)) = given.iter().find(|(known, _)| *known == figure)
            && other != value
        {
            return Err(format!("{place}: {name} is {value} here and {other} above"));
        }
        given.push((figure, *value));
    }
    let figure = |wanted: Figure| {
        let found = given.iter().find(|(figure, _)| *figure == wanted);
        found.map(|(_, value)| *value)
    };
    let is_given = |name: &str| imported.hardpoints.iter().any(|h| h.name == name);
    let has_spindle = is_given("spindle_inner");
    let (camber, toe) = (figure(Figure::StaticCamber), figure(Figure::StaticToe));
    if has_spindle {
        if camber.or(toe).is_some() {
            let note = "static camber and toe are left out: spindle_inner gives them";
            imported.notes.push(note.to_owned());
        }
    } else {
        if camber.is_none() || toe.is_none() {
            let lacking = match (camber, toe) {
                (None, None) => "static_camber and static_toe are",
                (None, _) => "static_camber is",
                _ => "static_toe is",
            };
            imported.notes.push(format!(
                "{lacking} taken as 0: the file has no point spindle_inner of the spin axis, and no such angle"
            ));
        }
        imported.static_camber = Some(camber.unwrap_or(0.0));
        imported.static_toe = Some(toe.unwrap_or(0.0));
    }
    imported.wheel_radius = figure(Figure::WheelRadius).or_else(|| {
        let (name, radius) = to_contact_point(table, wheel, imported)?;
        let note = format!("[wheel] radius: the distance of {name:?} from the wheel centre");
        imported.notes.push(note);
        Some(radius)
    });
    if imported.wheel_radius.is_none() {
        imported.notes.push(
            "[wheel] radius, the loaded radius, is not in the file; what needs it is not asked for"
                .to_owned(),
        );
    }
    Ok(())
}

/// The distance of the contact point from the wheel centre, where the file has the point.
fn to_contact_point(
    table: &PointTable,
    wheel: Option<Side>,
    imported: &Imported,
) -> Option<(String, f64)> {
    let centre = imported
        .hardpoints
        .iter()
        .find(|h| h.name == "wheel_centre")?;
    let of_wheel = |point: &&NamedPoint| point.side.is_none() || point.side == wheel;
    let is_contact = |point: &&NamedPoint| {
        Words::of(&point.name).figure() == Some(Figure::ContactPoint) && of_wheel(point)
    };
    let contact = table.points.iter().find(is_contact)?;
    let [x, y, z] = contact.position.clone().ok()?;
    let [cx, cy, cz] = centre.position;
    // A point for both wheels is the left one's.
    let y = if (y < 0.0) == (cy < 0.0) { y } else { -y };
    let radius = ((x - cx).powi(2) + (y - cy).powi(2) + (z - cz).powi(2)).sqrt();
    Some((contact.name.clone(), radius))
}
