//! Writes a study's points as hardpoints of an Adams/Car subsystem: in a new file, or in the rows of a copy of an existing file.

use super::adams::{self, SubsystemParameter, Symmetry};
use super::names;
use super::outgoing::Outgoing;
use crate::model::{FrameConvention, PointId, Side, SpinAxis, Suspension};
use crate::report::shortest;

/// A file written for another tool.
#[derive(Clone, Debug)]
pub struct Written {
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// Notes about parts of the study that the file cannot hold.
    pub notes: Vec<String>,
}

/// Names of the camber and toe parameters of a wheel in subsystem files.
pub(super) const ANGLES: [&str; 2] = ["camber_angle", "toe_angle"];

/// Axes of subsystem files: x rearward, y to the right, z up.
const AXES: FrameConvention = FrameConvention::XRear;

/// Makes a new subsystem with a study's hardpoints. Rows for both sides give the left wheel. A right wheel that is not a mirror
/// image has separate rows.
pub fn subsystem(outgoing: &Outgoing<'_>) -> Written {
    let outgoing = outgoing.in_convention(AXES);
    let wheels = outgoing.different_wheels();
    let mut points = Vec::new();
    let mut parameters = Vec::new();
    for side in &wheels {
        let (symmetry, of_side) = match (wheels.len(), side) {
            (2, Side::Left) => (Symmetry::Left, Side::Left),
            (2, Side::Right) => (Symmetry::Right, Side::Right),
            _ => (Symmetry::Both, Side::Left),
        };
        let mechanism = &outgoing.suspension(*side).mechanism;
        for (name, id, _) in outgoing.points(*side) {
            let hardpoint = mechanism.topology.hardpoint(name);
            let name = hardpoint.map_or(name, |hardpoint| names::in_adams(hardpoint.name));
            let position = outgoing.in_axes(of_side, outgoing.place(*side, id));
            points.push((name.to_owned(), symmetry, position));
        }
        if matches!(mechanism.spin_axis, SpinAxis::Along(_)) {
            let angles = ANGLES.into_iter().zip(outgoing.static_angles(*side));
            parameters.extend(angles.map(|(name, angle)| (name.to_owned(), symmetry, angle)));
        }
    }
    Written {
        bytes: adams::bytes_of(&adams::written(outgoing.unit, &points, &parameters)),
        notes: without_bodies(&outgoing, &outgoing.wheels()),
    }
}

/// Copy of a subsystem in which a study's hardpoints replace the coordinates in their rows. Everything else stays unchanged. For an
/// axle, it writes only the left wheel.
///
/// # Errors
///
/// The file is not a subsystem, or the hardpoint of a row is not certain.
pub fn into_subsystem(outgoing: &Outgoing<'_>, file: &[u8]) -> Result<Written, String> {
    let suspension = outgoing.study.wheel();
    let text = adams::text_of(file);
    if !adams::is_subsystem(&text) {
        return Err("it has no block [HARDPOINT]: it is not a subsystem of Adams/Car".to_owned());
    }
    let subsystem = adams::read(&text)?;
    let unit = subsystem.length.unwrap_or(outgoing.unit);
    let (_, side) = suspension.frame.meaning();
    let meanings = meanings(suspension, &subsystem)?;
    let is_for = |symmetry: Symmetry| match symmetry {
        Symmetry::Both | Symmetry::Single => true,
        Symmetry::Left => side == Side::Left,
        Symmetry::Right => side == Side::Right,
    };
    let outgoing = outgoing.in_convention(AXES);
    let rewritten = adams::rewritten(&text, |name, symmetry| {
        let (_, id) = meanings.iter().find(|(known, _)| *known == name)?;
        let of_side = match symmetry {
            Symmetry::Right => Side::Right,
            _ => Side::Left,
        };
        let position = outgoing.in_axes(of_side, outgoing.place(side, *id));
        is_for(symmetry).then(|| position.map(|number| unit.convert_decimal(number, outgoing.unit)))
    });
    let mut notes = vec![format!("{} rows of [HARDPOINT] written", rewritten.rows)];
    let mechanism = &suspension.mechanism;
    let is_written = |id: PointId| meanings.iter().any(|(_, known)| *known == id);
    let absent: Vec<&str> = (0..mechanism.points.len())
        .filter(|number| !is_written(PointId(*number)))
        .map(|number| mechanism.name(PointId(number)))
        .collect();
    if !absent.is_empty() {
        notes.push(format!("no row in the file for: {}", absent.join(", ")));
    }
    let mut unknown: Vec<&str> = Vec::new();
    for point in &subsystem.points {
        let name = point.name.as_str();
        let is_known = meanings.iter().any(|(known, _)| *known == name);
        if !is_known && !unknown.contains(&name) {
            unknown.push(name);
        }
    }
    if !unknown.is_empty() {
        notes.push(format!(
            "rows without a hardpoint in the study, unchanged: {}",
            unknown.join(", ")
        ));
    }
    let mut others = subsystem.points.iter();
    if others.any(|point| !is_for(point.symmetry)) {
        notes.push(format!(
            "rows of the other wheel are unchanged: the study describes the {} wheel",
            side.name()
        ));
    }
    if unit != outgoing.unit {
        notes.push(format!(
            "converted from {} to {}, the unit of the file",
            outgoing.unit.symbol(),
            unit.symbol()
        ));
    }
    let is_of_wheel = |parameter: &&SubsystemParameter| is_for(parameter.symmetry);
    let parameters = subsystem.parameters.iter().filter(is_of_wheel);
    let angles = outgoing.static_angles(side);
    notes.extend(parameters.filter_map(|p| other_angle(angles, p, subsystem.degrees)));
    notes.extend(without_bodies(&outgoing, &[side]));
    Ok(Written {
        bytes: adams::bytes_of(&rewritten.text),
        notes,
    })
}

/// Note about a static angle of a file that differs from the angle of the study. `angles` are camber and toe of the study in
/// degrees.
fn other_angle(
    angles: [f64; 2],
    parameter: &SubsystemParameter,
    in_degrees: bool,
) -> Option<String> {
    /// Largest difference of equal angles in degrees. If a point defines the spin axis, the study's angles are rounded.
    const SAME: f64 = 1e-6;
    let (line, name, found) = (parameter.line, &parameter.name, parameter.angle(in_degrees));
    let own = angles[ANGLES.iter().position(|known| known == name)?];
    ((own - found).abs() > SAME).then(|| {
        format!(
            "line {line}: the export does not change {name}: {found} deg in the file, {} deg in the study. Correct it in the new file",
            shortest(own)
        )
    })
}

/// Pairs of a name in the subsystem file and its hardpoint. Names with an unknown meaning are left out.
fn meanings<'f>(
    suspension: &Suspension,
    subsystem: &'f adams::Subsystem,
) -> Result<Vec<(&'f str, PointId)>, String> {
    let mechanism = &suspension.mechanism;
    let mut meanings: Vec<(&str, PointId)> = Vec::new();
    for point in &subsystem.points {
        let extra = mechanism.point(&point.name).map(|_| point.name.as_str());
        let name = names::hardpoint(&point.name, mechanism.topology).or(extra);
        let Some(id) = name.and_then(|name| mechanism.point(name)) else {
            continue;
        };
        let same = |(known, other): &&(&str, PointId)| *other == id && *known != point.name;
        if let Some((other, _)) = meanings.iter().find(same) {
            return Err(format!(
                "{:?} and {other:?} both seem to be {}: remove or rename one of them",
                point.name,
                mechanism.name(id)
            ));
        }
        meanings.push((&point.name, id));
    }
    Ok(meanings)
}

/// Notes about the bodies of points, which an Adams/Car subsystem keeps in its template.
fn without_bodies(outgoing: &Outgoing<'_>, sides: &[Side]) -> Vec<String> {
    let mut notes = Vec::new();
    let mut say = |wheel: &str, names: Vec<&str>| {
        if !names.is_empty() {
            notes.push(format!(
                "a subsystem cannot contain the bodies of {wheel}: {}",
                names.join(", ")
            ));
        }
    };
    let Some((first, others)) = sides.split_first() else {
        return notes;
    };
    let moved = |side: Side| outgoing.suspension(side).mechanism.points_on_other_bodies();
    let body = |side: Side, name: &str| {
        let id = outgoing.suspension(side).mechanism.point(name);
        id.and_then(|id| outgoing.body(side, id))
    };
    say("[suspension.bodies]", moved(*first));
    for side in others {
        let mut names = moved(*first);
        names.extend(moved(*side));
        names.sort_unstable();
        names.dedup();
        names.retain(|name| body(*first, name) != body(*side, name));
        say(
            &format!(
                "the {} wheel that differ from those of the other wheel",
                side.name()
            ),
            names,
        );
    }
    notes
}
