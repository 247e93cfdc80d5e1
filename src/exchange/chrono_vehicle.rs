//! Vehicles of Project Chrono: `"Type": "Vehicle"` with two axles. Each axle names the file of its suspension and gives its
//! position in the vehicle.
//!
//! Paths in such a file start at the folder of all vehicles, which is some levels above the file. The importer looks for them in
//! the folders above the vehicle's file, the nearest first. It moves the points by `Suspension Location` into the axes of the
//! vehicle: x forward, y left, z up, metres.
//!
//! | value | source |
//! |---|---|
//! | sprung mass with its centre | the chassis: `Components`, or `Mass` and `COM` |
//! | unsprung mass of an axle | twice `Spindle`, `Upright` or `Knuckle`, and wheel without tyre; of a solid axle also `Axle Tube` |
//! | spring rate | `Spring Coefficient` |
//! | spring force | rate * (`Free Length` - length in the file) + `Preload` |

use super::chrono::{entry, location, points_of, text};
use super::map::{Node, of_json, position};
use super::source::{bytes_of, decoded};
use super::table::{AxleFigures, CarFigures, Kind, Mass, PointTable, SpringFigures};
use crate::model::AxlePosition;
use std::path::{Component, Path, PathBuf};

/// An axle of the vehicle.
struct Axle {
    table: PointTable,
    figures: AxleFigures,
    /// `Suspension Location` in the vehicle, m.
    place: [f64; 3],
}

/// Points of a vehicle of Project Chrono. `None` if the map is not such a vehicle.
///
/// # Errors
/// The vehicle does not have two axles, or a file that it names cannot be read.
pub(super) fn read(path: &Path, root: &Node) -> Result<Option<PointTable>, String> {
    if text(root, "Type") != Some("Vehicle") {
        return Ok(None);
    }
    let Some(Node::List(written)) = entry(root, "Axles") else {
        return Err(
            "it is a vehicle of Project Chrono without Axles; only wheeled vehicles with two \
             axles can be read"
                .to_owned(),
        );
    };
    if written.len() != 2 {
        return Err(format!(
            "the vehicle has {} axles, but a car has two; import the files of its suspensions \
             separately",
            written.len()
        ));
    }
    let mut axles = Vec::new();
    for (number, node) in written.iter().enumerate() {
        axles.push(axle(path, node, number + 1)?);
    }
    axles.sort_by(|a, b| b.place[0].total_cmp(&a.place[0]));
    let mut car = CarFigures {
        rear_offset: Some([0.0; 3]),
        mass: chassis(path, root)?,
        axles: [axles[0].figures, axles[1].figures],
    };
    if car.mass.is_some_and(|mass| mass.mass <= 0.0) {
        car.mass = None;
    }
    let mut table = PointTable {
        car: Some(car),
        ..PointTable::in_metres()
    };
    let ends = [AxlePosition::Front, AxlePosition::Rear];
    for (own, end) in axles.into_iter().zip(ends) {
        add(&mut table, own, end);
    }
    table.notes.push(
        "a vehicle of Project Chrono: metres, iso8855, the vehicle's origin; points are those of the suspensions plus \
         Suspension Location"
            .to_owned(),
    );
    table.notes.push(
        "masses: the sprung mass is the chassis; arms, links, steering and tyres are omitted"
            .to_owned(),
    );
    Ok(Some(table))
}

/// Adds the points of an axle, moved by the axle's position.
fn add(table: &mut PointTable, own: Axle, end: AxlePosition) {
    let Axle {
        table: mut axle,
        place,
        ..
    } = own;
    for point in &mut axle.points {
        point.marks.axle = Some(end);
        if let Ok(position) = &mut point.position {
            for (coordinate, offset) in position.iter_mut().zip(place) {
                *coordinate += offset;
            }
        }
    }
    for figure in &mut axle.figures {
        figure.marks.axle = Some(end);
    }
    table.points.append(&mut axle.points);
    table.figures.append(&mut axle.figures);
    let kinds = axle.kinds.into_iter();
    table.kinds.extend(kinds.map(|(_, kind)| (Some(end), kind)));
    let name = super::corner::name_of(end);
    let left_out = axle.left_out.into_iter();
    table
        .left_out
        .extend(left_out.map(|line| format!("{name} axle: {line}")));
}

/// Reads an axle and the files that it names. `number` counts the axles of the file from 1, for messages.
fn axle(path: &Path, node: &Node, number: usize) -> Result<Axle, String> {
    let of = |reason: String| format!("axle {number}: {reason}");
    let Some(file) = text(node, "Suspension Input File") else {
        return Err(of("it has no \"Suspension Input File\"".to_owned()));
    };
    let place = entry(node, "Suspension Location").and_then(position);
    let place =
        place.ok_or_else(|| of("it has no \"Suspension Location\" of three numbers".to_owned()))?;
    if place[1] != 0.0 {
        return Err(of(format!(
            "Suspension Location is {} m from the centre plane; expected 0",
            place[1]
        )));
    }
    let root = part(path, file).map_err(of)?;
    let table = match points_of(&root) {
        Ok(Some(table)) => table,
        Ok(None) => return Err(of(format!("{file} is not a suspension of Project Chrono"))),
        // A topology that is not supported is no error here, because the other axle can still be imported.
        Err(reason) => PointTable {
            kinds: vec![(None, Kind::Other(format!("{file}: {reason}")))],
            ..PointTable::default()
        },
    };
    let wheel = match text(node, "Left Wheel Input File") {
        Some(file) => number_of(&part(path, file).map_err(of)?, &["Mass"]),
        None => None,
    };
    Ok(Axle {
        figures: AxleFigures {
            spring: table.axle.spring,
            unsprung_mass: unsprung_mass(&root, wheel),
        },
        table,
        place,
    })
}

/// Reads a file that the vehicle names, from the nearest folder above the vehicle that contains it.
///
/// # Errors
/// The path leads out of these folders, or the file does not exist or is not JSON.
fn part(path: &Path, file: &str) -> Result<Node, String> {
    let relative = Path::new(file);
    let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
    if !relative.components().all(is_plain) {
        return Err(format!(
            "the path of the file {file:?} is outside the folder of the vehicle; expected a path \
             without \"..\" or a drive letter"
        ));
    }
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let places = path.ancestors().skip(1).map(|folder| folder.join(relative));
    let found: Option<PathBuf> = places.into_iter().find(|place| place.is_file());
    let found = found.ok_or_else(|| {
        format!(
            "the file {file:?} is not in a folder above the vehicle; keep the folders of Project \
             Chrono, or copy the file there"
        )
    })?;
    let shown = |reason: String| format!("{file}: {reason}");
    let bytes = bytes_of(&found).map_err(shown)?;
    of_json(&decoded(&bytes).map_err(shown)?).map_err(shown)
}

/// Number under these keys, from the outermost key to the innermost.
fn number_of(root: &Node, keys: &[&str]) -> Option<f64> {
    let mut node = root;
    for key in keys {
        node = entry(node, key)?;
    }
    match node {
        Node::Number(number) if number.is_finite() => Some(*number),
        _ => None,
    }
}

/// Rate in N/m and force in N of a linear spring. `None` for a spring with a curve or without a free length, because its force is
/// not known.
pub(super) fn spring(root: &Node) -> Option<SpringFigures> {
    let rate = number_of(root, &["Spring", "Spring Coefficient"])?;
    let free = number_of(root, &["Spring", "Free Length"])?;
    let preload = number_of(root, &["Spring", "Preload"]).unwrap_or(0.0);
    let upper = location(root, ("Spring", "Location Chassis"))?;
    let lower = ["Location Arm", "Location Upright", "Location Axle"];
    let lower = lower
        .into_iter()
        .find_map(|key| location(root, ("Spring", key)))?;
    let apart: [f64; 3] = std::array::from_fn(|k| upper[k] - lower[k]);
    let length = apart[0].hypot(apart[1]).hypot(apart[2]);
    Some(SpringFigures {
        rate,
        force: rate * (free - length) + preload,
    })
}

/// Mass of both wheel carriers and both wheels of an axle, in kg. `wheel` is the mass of one wheel. `None` if `wheel` or the mass
/// of the spindle is missing.
fn unsprung_mass(root: &Node, wheel: Option<f64>) -> Option<f64> {
    let spindle = number_of(root, &["Spindle", "Mass"])?;
    let carrier = ["Upright", "Knuckle"].into_iter();
    let carrier = carrier
        .filter_map(|part| number_of(root, &[part, "Mass"]))
        .sum::<f64>();
    let tube = number_of(root, &["Axle Tube", "Mass"]).unwrap_or(0.0);
    Some(2.0 * (spindle + carrier + wheel?) + tube)
}

/// Mass of the chassis with its centre of gravity. Components that are holes (`Void`) are subtracted. `None` if a mass or its
/// location is missing.
fn chassis(path: &Path, root: &Node) -> Result<Option<Mass>, String> {
    let Some(inline) = entry(root, "Chassis") else {
        return Ok(None);
    };
    let file = match text(inline, "Input File") {
        Some(file) => Some(part(path, file).map_err(|reason| format!("chassis: {reason}"))?),
        None => None,
    };
    let node = file.as_ref().unwrap_or(inline);
    if let Some(Node::List(components)) = entry(node, "Components") {
        let (mut mass, mut moment) = (0.0, [0.0; 3]);
        for component in components {
            let is_void = matches!(entry(component, "Void"), Some(Node::Truth(true)));
            let own = number_of(component, &["Mass"]);
            let place = location(component, ("Centroidal Frame", "Location"));
            let (Some(own), Some(place)) = (own, place) else {
                return Ok(None);
            };
            let own = if is_void { -own } else { own };
            mass += own;
            for (sum, coordinate) in moment.iter_mut().zip(place) {
                *sum += own * coordinate;
            }
        }
        let cg = match components.len() {
            // The centre of a single component is read directly, so its coordinates have no rounding errors.
            1 => location(&components[0], ("Centroidal Frame", "Location")),
            _ => Some(moment.map(|sum| sum / mass)),
        };
        return Ok(cg.map(|cg| Mass {
            is_sprung: true,
            mass,
            cg,
        }));
    }
    let mass = number_of(node, &["Mass"]);
    let cg = entry(node, "COM").and_then(position);
    Ok(mass.zip(cg).map(|(mass, cg)| Mass {
        is_sprung: true,
        mass,
        cg,
    }))
}
