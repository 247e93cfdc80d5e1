//! Makes a study's wheel from the points of a file: roles of the points, axle and wheel, axes, and unit. The notes report
//! every guess. If a guess would be uncertain, the import is refused. The message then names the flag with which the user
//! decides.

mod unused;
mod wheel;

use super::axes::Axes;
use super::bushings::{self, Bushing};
use super::complete;
use super::corner::{self, Corner, Named, Picked};
use super::figures::{self, Figures};
use super::names::{cut, side_of};
use super::notes::Notes;
use super::place::{self, Placed};
use super::refusal::Refusal;
use super::right_half;
use super::roles::{self, Letters, Role};
use super::seats::{self, Seat};
use super::slips::Checks;
use super::table::{AxleFigures, Marks, NamedPoint, PointTable};
use super::unit::FileUnit;
use super::{optimum, unit};
use crate::model::{AxlePosition, FrameConvention, LengthUnit, Side, Topology};
use std::collections::BTreeMap;
use unused::{Unused, meanings};
use wheel::{angles, contact_radius, radius};

/// Options of the user for a file.
#[derive(Clone, Copy)]
pub struct ImportOptions<'a> {
    /// Kind of suspension.
    pub topology: &'static Topology,
    /// Unit of length.
    pub unit: Option<FileUnit>,
    /// Axes as a convention.
    pub frame: Option<FrameConvention>,
    /// Directions of x, y and z.
    pub axes: Option<Axes>,
    /// Side of the wheel.
    pub side: Option<Side>,
    /// Axle to import.
    pub axle: Option<AxlePosition>,
    /// Distance of the wheel centre from the centre plane of the car, in the file's unit.
    pub half_track: Option<f64>,
    /// Loaded radius, in the file's unit.
    pub radius: Option<f64>,
    /// True if bushings of the file are imported.
    pub bushings: bool,
    /// Names in the file, by hardpoint. The importer uses them in addition to the table of usual names.
    pub names: &'a BTreeMap<String, String>,
    /// Bodies by hardpoint, for ends of springs and rods whose body is not in the file.
    pub bodies: &'a BTreeMap<String, String>,
}

/// A hardpoint with its position and origin in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Hardpoint {
    /// Name in studies.
    pub name: &'static str,
    /// Coordinates in the axes and unit of [`Imported`].
    pub position: [f64; 3],
    /// Name of the point in the file.
    pub called: String,
    /// Location of the point in the file, such as a line or a cell.
    pub place: String,
    /// Body that carries the point, according to a column of the file.
    pub body: Option<String>,
    /// Body that carries the point, according to its name.
    pub named_body: Option<&'static str>,
}

/// A wheel imported from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Topology of the suspension.
    pub topology: &'static Topology,
    /// Hardpoints in the topology's order.
    pub hardpoints: Vec<Hardpoint>,
    /// Hardpoints of the right half of a solid axle or a twist beam that are not mirror images, with their actual y.
    pub right_half: Vec<Hardpoint>,
    /// Side of the wheel.
    pub side: Side,
    /// Axes of the coordinates.
    pub frame: FrameConvention,
    /// Unit of lengths.
    pub unit: LengthUnit,
    /// Loaded radius of the wheel.
    pub wheel_radius: Option<f64>,
    /// Camber in the design position, in degrees.
    pub static_camber: Option<f64>,
    /// Toe in the design position, in degrees.
    pub static_toe: Option<f64>,
    /// Width of the tyre.
    pub tyre_width: Option<f64>,
    /// Diameter of the rim.
    pub rim_diameter: Option<f64>,
    /// Height of the centre of gravity above the ground.
    pub cg_height: Option<f64>,
    /// Distance between the axles.
    pub wheelbase: Option<f64>,
    /// Distance between the wheels of the axle.
    pub track: Option<f64>,
    /// Axle of the wheel.
    pub axle: Option<AxlePosition>,
    /// Masses and other values for the study of a car.
    pub(super) figures: AxleFigures,
    /// Bushings by hardpoint.
    pub(super) bushings: Vec<Bushing>,
    /// Bodies that carry the ends of springs and rods.
    pub(super) seats: Vec<Seat>,
    /// Notes about guesses and assumptions.
    pub notes: Notes,
    /// Unused parts of the file, each with its reason.
    pub left_out: Vec<String>,
}

/// Points of a file that have a role.
fn named_points<'t>(table: &'t PointTable, roles: &[Option<Role>]) -> Vec<Named<'t>> {
    let points = table.points.iter().zip(roles);
    let named = |(point, role): (&'t NamedPoint, &Option<Role>)| {
        let role = role.clone()?;
        Some(Named { point, role })
    };
    points.filter_map(named).collect()
}

/// Makes the wheel from a file's points, or the axle if it is a solid axle or a twist beam.
///
/// # Errors
/// Hardpoints are missing, statements of the file contradict each other, or a guess would be uncertain.
pub fn import(table: &PointTable, options: &ImportOptions<'_>) -> Result<Imported, Refusal> {
    let mut imported = for_axle(table, options)?;
    if let Some(spring) = imported.figures.spring
        && !options.topology.carries_both_wheels()
    {
        let unit = imported.unit.symbol();
        imported.left_out.push(format!(
            "Spring: rate {:?} N/{unit}, force {:.1} N in the position of the file; the study of one wheel does not use \
             them. For the study of an axle, write them under [spring] as rate and force",
            spring.rate, spring.force
        ));
    }
    Ok(imported)
}

/// Points and values of the wheel or axle that the study describes.
struct Selection {
    corner: Corner,
    picked: Vec<Picked>,
    unit: LengthUnit,
    figures: Figures,
    /// True if the wheel centre can be computed from half track and radius, as in OptimumKinematics.
    makes_wheel: bool,
}

/// Selects the points and the values of one wheel or axle. `roles` covers all points of the table; `named` has the points with a
/// role.
fn select(
    table: &PointTable,
    options: &ImportOptions<'_>,
    (roles, named): (&[Option<Role>], &[Named<'_>]),
    notes: &mut Notes,
) -> Result<Selection, Refusal> {
    let is_optimum = roles::is_optimum(&table.points);
    let mut corner = corner::choose(table, named, options, notes)?;
    if options.topology.carries_both_wheels() {
        corner.side = Some(Side::Left);
        if options.side == Some(Side::Right) {
            let reason =
                "--side right: this axle has both wheels, and its study describes the left half";
            return Err(Refusal::Wrong(reason.to_owned()));
        }
    }
    let mut picked = Vec::new();
    for known in options.topology.all_hardpoints() {
        picked.extend(corner::pick(known.name, named, corner)?);
    }
    if is_optimum {
        optimum::bar_axis(named, corner, &mut picked);
    }
    // Missing hardpoints are reported before the unit is determined, because the unit follows from the size of the
    // suspension.
    let wheel: &[&str] = if is_optimum { &["wheel_centre"] } else { &[] };
    refuse_missing(table, options, (roles, corner), &picked, wheel)?;
    let unit = unit::unit(table, options, &picked, notes)?;
    let figures = figures::read(table, corner, unit, options, is_optimum, notes)?;
    let makes_wheel = is_optimum && figures.half_track().is_some() && figures.radius().is_some();
    let made: &[&str] = if makes_wheel { &["wheel_centre"] } else { &[] };
    // The first check has found all other points, so only the wheel centre can be missing here.
    refuse_missing(table, options, (roles, corner), &picked, made).map_err(|reason| {
        if is_optimum {
            format!("{reason}\ngive --half-track and --radius, from which the wheel centre of this table is computed")
        } else {
            reason
        }
    })?;
    Ok(Selection {
        corner,
        picked,
        unit,
        figures,
        makes_wheel,
    })
}

/// Axes and side of the selected points, with the data of the file that later steps need.
struct Located {
    placed: Placed,
    /// Points with the coordinates of the file, before they were mirrored or moved to the half track.
    as_read: Vec<Picked>,
    /// Name of the contact point, and its distance from the wheel centre.
    contact: Option<(String, f64)>,
}

/// Finds the axes and the side of the selected points. Mirrors the points of a wheel to the wanted side if necessary, and moves
/// the points to the half track. In a table of OptimumKinematics, also assigns the points of the rocker and adds the wheel
/// centre.
fn locate(
    table: &PointTable,
    options: &ImportOptions<'_>,
    named: &[Named<'_>],
    selection: &mut Selection,
    notes: &mut Notes,
) -> Result<Located, Refusal> {
    let is_optimum = roles::is_optimum(&table.points);
    let corner = selection.corner;
    let wanted = corner.side;
    // OptimumKinematics measures the half track at the contact point, not at the wheel centre. Files that state the kind of
    // suspension define the wheel centre by the track, or give no track. So the half track is not compared with the points.
    let compare = !is_optimum && table.kinds.is_empty();
    let half_track = selection.figures.half_track();
    let checks = Checks {
        table,
        options,
        wanted,
        half_track,
        compare,
    };
    let picked = &mut selection.picked;
    let as_read = picked.clone();
    let explained = |refusal| checks.explain(&as_read, refusal);
    let placed = place::place(table, options, wanted, picked, notes);
    let mut placed = placed.map_err(explained)?;
    if options.topology.carries_both_wheels() {
        refuse_fifth_link(table, named, corner, placed, picked)?;
    }
    let contact = contact_radius(table, corner, placed, picked);
    if !options.topology.carries_both_wheels() {
        place::mirror(&mut placed, wanted, picked, notes);
    }
    if is_optimum {
        optimum::rod(options.topology, placed.axes, picked, notes);
    }
    let has_wheel = picked.iter().any(|p| p.hardpoint.name == "wheel_centre");
    if selection.makes_wheel && !has_wheel {
        picked.extend(optimum::wheel_centre(placed, &selection.figures, notes));
    }
    let flags = (options.half_track.is_some(), compare);
    place::to_half_track(placed, half_track, flags, picked, notes).map_err(explained)?;
    Ok(Located {
        placed,
        as_read,
        contact,
    })
}

/// Makes the wheel for the study of one wheel or of an axle, with the spring of the file in [`Imported::figures`].
pub(super) fn for_axle(
    table: &PointTable,
    options: &ImportOptions<'_>,
) -> Result<Imported, Refusal> {
    let converted = unit::converted(table, options)?;
    let (table, options) = match &converted {
        Some((table, options)) => (table, options),
        None => (table, options),
    };
    let mut notes = table.notes.clone();
    let mut left_out = table.left_out.clone();
    let roles = roles_of(table, options)?;
    let named = named_points(table, &roles);
    let is_optimum = roles::is_optimum(&table.points);
    let mut selection = select(table, options, (&roles, &named), &mut notes)?;
    let Located {
        placed,
        as_read,
        contact,
    } = locate(table, options, &named, &mut selection, &mut notes)?;
    let Selection {
        corner,
        picked,
        unit,
        mut figures,
        ..
    } = selection;

    let mut hardpoints = in_order(options.topology, picked);
    complete::drop_incomplete(options, &mut hardpoints, &mut left_out)?;
    let unused = Unused {
        table,
        options,
        roles: &roles,
        corner,
        numbers: &figures.unused,
    };
    unused.say(&hardpoints, &mut notes, &mut left_out);
    let mut right_half = if options.topology.carries_both_wheels() {
        let (topology, axes) = (options.topology, placed.axes);
        right_half::own(topology, &named, corner, axes, &hardpoints, &mut left_out)?
    } else {
        left_out.extend(right_half::differs(
            &named,
            corner,
            (placed.axes, unit),
            &as_read,
        ));
        Vec::new()
    };
    let frame = to_study_frame(placed, [&mut hardpoints, &mut right_half], &mut notes);
    radius(contact, is_optimum, &mut figures, &mut notes);
    let mut imported = Imported {
        topology: options.topology,
        hardpoints,
        right_half,
        side: placed.side,
        frame,
        unit,
        wheel_radius: figures.radius(),
        static_camber: None,
        static_toe: None,
        tyre_width: figures.tyre_width,
        rim_diameter: figures.rim_diameter,
        cg_height: figures.cg_height,
        wheelbase: figures.wheelbase,
        track: figures.track,
        axle: corner.axle,
        figures: table.figures_of(corner.axle),
        bushings: Vec::new(),
        seats: Vec::new(),
        notes,
        left_out,
    };
    angles(&figures, &mut imported);
    bushings::take(table, options, &mut imported);
    imported.seats = seats::of(&imported, options.bodies)?;
    imported.notes.extend(seats::notes(&imported.seats));
    Ok(imported)
}

/// Linkages that hold a solid axle sideways, and one hardpoint of each linkage. An axle with such a linkage has a single
/// upper link, which need not be in the centre plane.
const ACROSS: [(&str, &str); 2] = [
    ("panhard_axle", "a Panhard rod"),
    ("watt_axis", "a Watt linkage"),
];

/// True if a Panhard rod or a Watt linkage holds a solid axle with these hardpoints sideways.
pub(super) fn is_held_across(hardpoints: &[Hardpoint]) -> bool {
    let mut names = ACROSS.iter().map(|(name, _)| name);
    names.any(|name| hardpoints.iter().any(|h| h.name == *name))
}

/// Refuses a solid axle with a Panhard rod or a Watt linkage and two upper links. The upper links are a pair if the rows of the
/// right half have the opposite y, or if the rows apply to both halves.
fn refuse_fifth_link(
    table: &PointTable,
    named: &[Named<'_>],
    corner: Corner,
    placed: Placed,
    picked: &[Picked],
) -> Result<(), Refusal> {
    let found = |name: &str| picked.iter().find(|p| p.hardpoint.name == name);
    let Some((_, linkage)) = ACROSS.iter().find(|(name, _)| found(name).is_some()) else {
        return Ok(());
    };
    let (across, _) = placed.axes.across();
    let is_paired = |name: &&&'static str| {
        let Some(left) = found(name) else {
            return false;
        };
        let y = left.hardpoint.position[across];
        let right = corner::of_other_wheel(name, named, corner);
        let is_for_both = || {
            let mut own = named.iter().filter(|n| n.role.hardpoint == **name);
            table.kinds.is_empty()
                && y != 0.0
                && own.any(|n| n.point.mirrored && n.point.place == left.hardpoint.place)
        };
        right.is_some_and(|right| right[across] * y < 0.0) || is_for_both()
    };
    let ends = ["upper_link_chassis", "upper_link_axle"];
    let Some(end) = ends.iter().find(is_paired).and_then(|name| found(name)) else {
        return Ok(());
    };
    let (called, place) = (&end.hardpoint.called, &end.hardpoint.place);
    Err(Refusal::Wrong(format!(
        "{called:?} ({place}) is on both sides of the axle, so the file has two lower links, two upper links and {linkage}: one link \
         too many for rigid links. Remove the rows of the right upper link, or those of {linkage}. For four elastic links and a \
         Panhard rod, start with `hardpoint new solid_axle --with five_links` and enter the points there"
    )))
}

/// Role of each point in the file. A name of `--map` replaces the usual names of its hardpoint. Refuses a wrong `--map`.
fn roles_of(table: &PointTable, options: &ImportOptions<'_>) -> Result<Vec<Option<Role>>, String> {
    let same = |a: &str, b: &str| a.trim().to_lowercase() == b.trim().to_lowercase();
    let is_named =
        |point: &NamedPoint, name: &str| same(&point.name, name) || same(&point.read_as, name);
    for (hardpoint, name) in options.names {
        if options.topology.hardpoint(hardpoint).is_none() {
            return Err(format!(
                "--map: {} has no hardpoint {hardpoint:?}",
                options.topology.name
            ));
        }
        if !table.points.iter().any(|point| is_named(point, name)) {
            return Err(format!(
                "--map: the file has no point {name:?} for {hardpoint}"
            ));
        }
        let mut others = options.names.iter();
        let second = others.find(|(other, theirs)| *other != hardpoint && same(theirs, name));
        if let Some((second, _)) = second {
            return Err(format!(
                "--map: {hardpoint} and {second} are both assigned to {name:?}; a point can only \
                 be one hardpoint"
            ));
        }
    }
    let letters = Letters::of_points(&table.points);
    let role = |point: &NamedPoint| {
        let read = roles::read(&point.read_as, options.topology, letters);
        let mut names = options.names.iter();
        match names.find(|(_, name)| is_named(point, name)) {
            Some((hardpoint, _)) => Some(Role {
                hardpoint: options.topology.hardpoint(hardpoint)?.name,
                marks: read.as_ref().map_or(Marks::default(), |role| role.marks),
                body: roles::body_of(&point.read_as, options.topology),
            }),
            None => read.filter(|role| !options.names.contains_key(role.hardpoint)),
        }
    };
    Ok(table.points.iter().map(role).collect())
}

fn refuse_missing(
    table: &PointTable,
    options: &ImportOptions<'_>,
    (roles, corner): (&[Option<Role>], Corner),
    picked: &[Picked],
    made: &[&str],
) -> Result<(), String> {
    let hardpoints: Vec<Hardpoint> = picked.iter().map(|p| p.hardpoint.clone()).collect();
    let meanings = meanings(roles);
    let mut unused = complete::unused(table, &meanings, &hardpoints);
    // The message proposes the first unused point, so points of the other wheel come last.
    let is_of_other_wheel = |name: &String| {
        let words = cut(name);
        let mut ends = [words.first(), words.last()].into_iter().flatten();
        let side = ends.find_map(|word| side_of(word));
        let of_point = table.points.iter().find(|point| point.name == *name);
        let side = of_point.and_then(|point| point.marks.side).or(side);
        side.is_some() && corner.side.is_some() && side != corner.side
    };
    unused.sort_by_key(is_of_other_wheel);
    complete::missing(options.topology, &hardpoints, &unused, made)
}

/// Hardpoints in the topology's order.
fn in_order(topology: &Topology, picked: Vec<Picked>) -> Vec<Hardpoint> {
    let mut hardpoints: Vec<Hardpoint> = picked.into_iter().map(|p| p.hardpoint).collect();
    let place = |hardpoint: &Hardpoint| {
        let mut names = topology.all_hardpoints();
        names.position(|known| known.name == hardpoint.name)
    };
    hardpoints.sort_by_key(place);
    hardpoints
}

/// Converts the points to the frame of the study. If the file's frame is a frame of studies, the study uses it, so that the
/// coordinates stay equal to those of the file. Otherwise the study uses ISO 8855, and only the order and the signs of the
/// coordinates change.
fn to_study_frame(
    placed: Placed,
    hardpoints: [&mut Vec<Hardpoint>; 2],
    notes: &mut Notes,
) -> FrameConvention {
    if let Some(convention) = placed.axes.convention() {
        return convention;
    }
    for hardpoint in hardpoints.into_iter().flatten() {
        hardpoint.position = placed.axes.to_iso(hardpoint.position);
    }
    notes.push(format!(
        "axes: x, y and z of the file point {}; the study has them in iso8855 (x forward, y left, z up)",
        placed.axes
    ));
    FrameConvention::Iso8855
}
