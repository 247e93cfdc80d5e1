//! `[suspension]`, `[wheel]` and `[vehicle]`: the mechanism and its dimensions.

use super::error::Problems;
use super::file::{self, Coordinates, File};
use super::geometry;
use super::names::{choose, choose_or, nearest};
use super::solid_axle;
use super::value::{Number, Text};
use crate::ask::Accepted;
use crate::mechanism::HardpointFault;
use crate::model::{
    AxlePosition, Frame, FrameConvention, Group, LengthUnit, MassUnit, Mechanism, Point, Side,
    SpinAxis, Suspension, Topology, TorquePath, VehicleFigures,
};
use crate::number::{Each, Vector3};
use std::collections::BTreeMap;

/// Reads the suspension. `None` if it has an error.
pub(super) fn suspension(file: &File, problems: &mut Problems) -> Option<Suspension> {
    let section = &file.suspension;
    let topologies: Vec<_> = Topology::ALL.iter().map(|t| (t.name, *t)).collect();
    let topology = choose(&section.topology, "topology", &topologies, problems);
    let frame = frame(section, problems);
    let length_unit = choose_or(
        &section.length_unit,
        LengthUnit::Millimetre,
        "length unit",
        &LengthUnit::ALL.each(|u| (u.symbol(), u)),
        problems,
    );
    let length_unit = with_forces(file, length_unit, problems);
    let vehicle = vehicle(&file.vehicle, problems);
    let wheel_radius = positive(&file.wheel.radius, problems);
    let tyre_width = positive(&file.wheel.tyre_width, problems);
    let rim_diameter = positive(&file.wheel.rim_diameter, problems);
    refuse_keys_of_others(file, topology?, problems);
    let given = hardpoints(section, topology?, problems)?;
    let (frame, length_unit) = (frame?, length_unit?);

    let mut mechanism =
        (topology?.build)(topology?, &given.iter().map(|g| g.name).collect::<Vec<_>>());
    if solid_axle::has_five_links(section, &mechanism) {
        mechanism.pair_upper_links();
    }
    let mut design: Vec<_> = mechanism
        .points
        .iter()
        .filter_map(|point| given.iter().find(|g| g.name == point.name))
        .map(|g| frame.vector(g.position))
        .collect();
    solid_axle::steer(file, frame, &mut mechanism, problems)?;
    mechanism.add_far_half(&mut design);
    mechanism.assume_seats();
    bodies(&section.bodies, &mut mechanism, problems)?;
    mechanism.seat_drop_link(&design);
    spin_axis(file, &mut mechanism, &given, problems)?;
    let mut suspension = Suspension {
        mechanism,
        design: design.clone(),
        frame,
        length_unit,
        wheel_radius: wheel_radius?,
        tyre_width: tyre_width?,
        rim_diameter: rim_diameter?,
        vehicle: vehicle?,
    };
    geometry::check(section, &suspension, problems)?;
    extra_points(
        section,
        frame,
        &mut suspension.mechanism,
        &mut design,
        problems,
    )?;
    suspension.design = design;
    Some(suspension)
}

/// Refuses keys that are only for another topology.
fn refuse_keys_of_others(file: &File, topology: &Topology, problems: &mut Problems) {
    let is_beam = topology.is_twist_beam();
    if let (false, Some(section)) = (is_beam, &file.twist_beam) {
        let message = "[twist_beam] needs topology = \"twist_beam\"";
        problems.add(section.span(), message);
    }
    let is_solid = topology.carries_both_wheels() && !is_beam;
    if let (false, Some(single)) = (is_solid, &file.suspension.single) {
        let message = "the key \"single\" needs topology = \"solid_axle\": it names a link of a solid axle that exists once";
        problems.add(single.span(), message);
    }
}

/// Combines the unit of length with the unit of force.
fn with_forces(
    file: &File,
    length: Option<LengthUnit>,
    problems: &mut Problems,
) -> Option<LengthUnit> {
    let Some(text) = &file.suspension.force_unit else {
        return length;
    };
    let names = [("N", false), ("lbf", true)];
    let is_pounds = choose(text, "force unit", &names, problems)?;
    let is_elastic =
        file.compliance.is_some() || !file.bushings.is_empty() || !file.links.is_empty();
    match (is_pounds, length?) {
        (false, length) => Some(length),
        (true, _) if is_elastic => {
            let message = "studies with elastic parts have forces in newtons: rates in N/in, torques in N in; leave force_unit out";
            problems.refuse(text.span(), message)
        }
        (true, LengthUnit::Inch) => Some(LengthUnit::InchPound),
        (true, _) => {
            let message = "pounds-force need inches: expected length_unit = \"in\" together with force_unit = \"lbf\"";
            problems.refuse(text.span(), message)
        }
    }
}

/// Unit of mass.
pub(super) fn mass_unit(written: &Option<Text>, problems: &mut Problems) -> Option<MassUnit> {
    let names = MassUnit::ALL.each(|unit| (unit.symbol(), unit));
    choose_or(written, MassUnit::Kilogram, "mass unit", &names, problems)
}

/// Unit of mass in kg.
pub(super) fn kilograms(file: &File, problems: &mut Problems) -> Option<f64> {
    Some(mass_unit(&file.suspension.mass_unit, problems)?.kilograms())
}

/// Hardpoint as given in the file, in the study's axes.
struct Given<'a> {
    name: &'static str,
    text: &'a Text,
    position: Vector3<f64>,
}

fn frame(section: &file::Suspension, problems: &mut Problems) -> Option<Frame> {
    let sides = Side::ALL.each(|side| (side.name(), side));
    let conventions = FrameConvention::ALL.each(|convention| (convention.name(), convention));
    let side = choose_or(&section.side, Side::Left, "side", &sides, problems);
    let iso = FrameConvention::Iso8855;
    let convention = choose_or(&section.frame, iso, "frame", &conventions, problems);
    Some(Frame::new(convention?, side?))
}

fn hardpoints<'a>(
    section: &'a file::Suspension,
    topology: &'static Topology,
    problems: &mut Problems,
) -> Option<Vec<Given<'a>>> {
    let written = section.hardpoints.get_ref();
    let is_given = |name: &str| written.keys().any(|text| text.get_ref() == name);
    let mut given = Vec::new();
    let mut sound = true;
    let mut misspelt = Vec::new();
    for (text, coordinates) in written {
        let known = topology.hardpoint(text.get_ref());
        let position = position(coordinates, problems);
        match (known, position) {
            (Some(hardpoint), Some(position)) => given.push(Given {
                name: hardpoint.name,
                text,
                position,
            }),
            (Some(_), None) => sound = false,
            (None, _) => {
                sound = false;
                let name = text.get_ref();
                let fault = HardpointFault::Unknown {
                    topology: topology.name,
                    name: name.clone(),
                };
                let error = problems.add(text.span(), fault.to_string());
                let names = || topology.all_hardpoints().map(|h| h.name);
                if let Some(near) = nearest(name, names().filter(|name| !is_given(name))) {
                    misspelt.push(near);
                    error.help(format!("did you mean \"{near}\"?"));
                } else if let Some(near) = nearest(name, names()) {
                    error.help(format!("\"{near}\" is already given"));
                } else {
                    error.help("put other points to report into [suspension.extra_points]");
                }
            }
        }
    }
    let is_found = |name: &str| is_given(name) || misspelt.contains(&name);
    if let Some(fault) = HardpointFault::missing(topology, is_found) {
        return problems.refuse(section.hardpoints.span(), fault.to_string());
    }
    // After an error in a hardpoint, the groups are not checked, because this error may be the reason for an incomplete group.
    if sound {
        let names: Vec<&'static str> = given.iter().map(|g| g.name).collect();
        for group in topology.groups {
            if let Some(fault) = HardpointFault::of_group(topology, group, &names) {
                sound = false;
                add_group_fault(group, &fault, &given, problems);
            }
        }
    }
    sound.then_some(given)
}

/// Reports an error in a group of hardpoints. The error points to a hardpoint of the group in the file.
fn add_group_fault(
    group: &Group,
    fault: &HardpointFault,
    given: &[Given],
    problems: &mut Problems,
) {
    let written = |name: &str| given.iter().find(|g| g.name == name).map(|g| g.text.span());
    let parts = given.iter().filter(|g| {
        let belongs = |list: &&[&str]| list.contains(&g.name);
        group.complete.iter().any(belongs) || group.beside.contains(&g.name)
    });
    let first = parts.map(|g| g.text.span()).min_by_key(|span| span.start);
    let place = match fault {
        HardpointFault::Both { first, .. } => written(first),
        _ => first,
    };
    let error = problems.add(place.unwrap_or_default(), fault.to_string());
    if let HardpointFault::Incomplete { group, .. } = fault {
        error.help(format!("give all points of {group}, or none"));
    }
}

/// Sets the bodies that carry the ends of springs and rods, if the study names them.
pub(super) fn bodies(
    bodies: &BTreeMap<Text, Text>,
    mechanism: &mut Mechanism,
    problems: &mut Problems,
) -> Option<()> {
    let mut sound = true;
    for (text, body) in bodies {
        let name = text.get_ref();
        let point = mechanism.point(name);
        let possible = point.map_or(Vec::new(), |id| mechanism.possible_bodies(id));
        match point {
            Some(id) if !possible.is_empty() => match choose(body, "body", &possible, problems) {
                Some(body) => {
                    mechanism.points[id.0].body = body;
                    mechanism.unsaid_seats.retain(|unsaid| *unsaid != id);
                }
                None => sound = false,
            },
            Some(_) => {
                sound = false;
                let message = format!(
                    "{name} has a fixed body in every {}",
                    mechanism.topology.name
                );
                let error = problems.add(text.span(), message);
                error.help("you can choose the body of the lower end of a spring and of the outer ends of pushrod, pullrod and drop link");
            }
            None => {
                sound = false;
                let message = match mechanism.topology.hardpoint(name) {
                    Some(absent) => format!("this study does not give {name} ({})", absent.about),
                    None => format!("{} has no hardpoint {name:?}", mechanism.topology.name),
                };
                problems.add(text.span(), message);
            }
        }
    }
    sound.then_some(())
}

pub(super) fn position(coordinates: &Coordinates, problems: &mut Problems) -> Option<Vector3<f64>> {
    three(coordinates, "coordinates [x, y, z]", problems)
}

/// Three numbers of a list, in the study's axes. `what` names the numbers in messages.
pub(super) fn three(
    list: &Coordinates,
    what: &str,
    problems: &mut Problems,
) -> Option<Vector3<f64>> {
    match list.get_ref().as_slice() {
        [x, y, z] => Some(Vector3::new(x.value, y.value, z.value)),
        other => {
            let message = format!("expected three {what}, found {}", other.len());
            problems.refuse_count(list, 3, message)
        }
    }
}

/// Static camber and toe, if no hardpoint gives the spin axis.
fn spin_axis(
    file: &File,
    mechanism: &mut Mechanism,
    given: &[Given],
    problems: &mut Problems,
) -> Option<()> {
    let wheel = &file.wheel;
    let angles = [&wheel.static_camber, &wheel.static_toe];
    let first = angles.into_iter().flatten().next();
    match (mechanism.spin_axis, first) {
        (SpinAxis::From(inner), Some(angle)) => {
            let name = mechanism.name(inner);
            let message = format!("{name} already gives camber and toe of the design position");
            let error = problems.add(angle.span.clone(), message);
            if let Some(point) = given.iter().find(|g| g.name == name) {
                error.related(point.text.span(), "given here");
            }
            error.help(format!("leave out {name}, or static_camber and static_toe"));
            None
        }
        (SpinAxis::From(_), None) => Some(()),
        (SpinAxis::Along(_), None) => {
            let message = "the direction of the wheel is missing: expected the hardpoint spindle_inner, \
                           or static_camber, static_toe or both in [wheel]";
            problems.refuse(file.suspension.hardpoints.span(), message)
        }
        (SpinAxis::Along(_), Some(_)) => {
            let [camber, toe] = angles.each(|angle| below_right_angle(angle.as_ref(), problems));
            let (camber, toe) = (camber?.to_radians(), toe?.to_radians());
            mechanism.spin_axis = SpinAxis::standing(camber, toe);
            Some(())
        }
    }
}

pub(super) fn below_right_angle(angle: Option<&Number>, problems: &mut Problems) -> Option<f64> {
    let Some(angle) = angle else { return Some(0.0) };
    if angle.value.abs() < 90.0 {
        return Some(angle.value);
    }
    let message = format!("expected between -90 and 90 degrees, found {}", angle.value);
    problems.refuse(angle.span.clone(), message)
}

fn extra_points(
    section: &file::Suspension,
    frame: Frame,
    mechanism: &mut Mechanism,
    design: &mut Vec<Vector3<f64>>,
    problems: &mut Problems,
) -> Option<()> {
    let mut sound = true;
    let topology = mechanism.topology;
    for (text, extra) in &section.extra_points {
        let name = text.get_ref();
        let position = position(&extra.position, problems);
        let body = choose(&extra.body, "body", &mechanism.bodies, problems);
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if topology.hardpoint(name).is_some() {
            sound = false;
            let message = format!("{name:?} is the name of a hardpoint; expected another one");
            problems.add(text.span(), message);
        } else if name.is_empty() || !name.chars().all(plain) {
            sound = false;
            let message = format!(
                "{name:?} becomes part of column names; expected only letters, digits and _"
            );
            problems.add(text.span(), message);
        }
        match (position, body) {
            (Some(position), Some(body)) => {
                design.push(frame.vector(position));
                mechanism.points.push(Point {
                    name: name.clone(),
                    body,
                });
            }
            _ => sound = false,
        }
    }
    sound.then_some(())
}

fn vehicle(section: &file::Vehicle, problems: &mut Problems) -> Option<VehicleFigures> {
    let wheelbase = positive(&section.wheelbase, problems);
    let track = positive(&section.track, problems);
    let cg_height = positive(&section.cg_height, problems);
    let mut share = |share: &Option<Number>| match share {
        Some(share) if !(0.0..=1.0).contains(&share.value) => {
            let message = format!("expected a share from 0 to 1, found {}", share.value);
            problems.refuse(share.span.clone(), message)
        }
        share => Some(share.as_ref().map(|s| s.value)),
    };
    let brake_share = share(&section.brake_share_front);
    let drive_share = share(&section.drive_share_front);
    let positions = [
        ("front", Some(AxlePosition::Front)),
        ("rear", Some(AxlePosition::Rear)),
    ];
    let (carrier, shafts) = (Some(TorquePath::Carrier), Some(TorquePath::Shafts));
    let position = choose_or(&section.position, None, "position", &positions, problems);
    let brakes = choose_or(
        &section.brakes,
        None,
        "position of the brakes",
        &[("outboard", carrier), ("inboard", shafts)],
        problems,
    );
    let drive_torque = choose_or(
        &section.drive_torque,
        None,
        "path of the torque",
        &[("shafts", shafts), ("carrier", carrier)],
        problems,
    );
    Some(VehicleFigures {
        wheelbase: wheelbase?,
        track: track?,
        cg_height: cg_height?,
        brake_share_front: brake_share?,
        drive_share_front: drive_share?,
        position: position?,
        brakes: brakes?,
        drive_torque: drive_torque?,
    })
}

/// Reads an optional positive number. `None` if it is not positive, `Some(None)` if it is missing.
pub(super) fn positive(number: &Option<Number>, problems: &mut Problems) -> Option<Option<f64>> {
    match number {
        Some(number) => above_zero(number, problems).map(Some),
        None => Some(None),
    }
}

/// Checks that the number is positive.
pub(super) fn above_zero(number: &Number, problems: &mut Problems) -> Option<f64> {
    accepted(number, "number", ABOVE_ZERO, problems)
}

/// Numbers above 0, such as rates, masses and lengths.
pub(super) const ABOVE_ZERO: Accepted = Accepted::Above(0.0);

/// Checks that the number is one of the accepted values. `noun` names the number in the message.
pub(super) fn accepted(
    number: &Number,
    noun: &str,
    accepted: Accepted,
    problems: &mut Problems,
) -> Option<f64> {
    if accepted.contains(number.value) {
        return Some(number.value);
    }
    let message = format!("expected a {noun} {accepted}, found {}", number.value);
    problems.refuse(number.span.clone(), message)
}
