//! `loads` of `[outputs]`: forces and moments on the wheel.

use super::error::Problems;
use super::file::{self, Coordinates};
use super::names::{choose, choose_or};
use super::resolve::each;
use super::suspension::three;
use super::{Load, LoadPoint};
use crate::compliance::HeldQuantity;
use crate::model::{Axis, Suspension};
use crate::number::{Each, Vector3};

const PLACES: [(&str, LoadPoint); 2] = [
    ("contact_point", LoadPoint::ContactPoint),
    ("wheel_centre", LoadPoint::WheelCentre),
];

/// Quantities that an equilibrium under a load may hold constant.
const HELD: [(&str, HeldQuantity); 2] = [
    ("wheel_load", HeldQuantity::WheelLoad),
    ("wheel_height", HeldQuantity::WheelHeight),
];

/// Kinds of studies, by the parts that hold the wheel under a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holding {
    /// Rigid mechanism: its support (the spring, or a vertical force at the wheel centre) holds the wheel at the station.
    Rigid,
    /// Elastic parts without a spring hold the wheel.
    Elastic,
    /// Elastic parts with a spring hold the wheel.
    Sprung,
}

impl Holding {
    /// Returns the kind of a study. `has_spring` is true if the elastic parts include a spring, and `None` without elastic
    /// parts.
    pub(super) fn of(has_spring: Option<bool>) -> Holding {
        match has_spring {
            None => Holding::Rigid,
            Some(false) => Holding::Elastic,
            Some(true) => Holding::Sprung,
        }
    }

    /// Reads the quantity that stays constant under a load.
    fn held(self, load: &file::Load, problems: &mut Problems) -> Option<Option<HeldQuantity>> {
        let Some(written) = &load.hold else {
            return Some(match self {
                Holding::Rigid => None,
                Holding::Elastic => Some(HeldQuantity::WheelHeight),
                Holding::Sprung => Some(HeldQuantity::WheelLoad),
            });
        };
        let held = choose(written, "quantity to hold", &HELD, problems)?;
        let message = match (self, held) {
            (Holding::Rigid, _) => {
                "the key \"hold\" needs [compliance] with elastic parts; in a rigid mechanism the support holds the wheel"
            }
            (Holding::Elastic, HeldQuantity::WheelLoad) => {
                "hold = \"wheel_load\" needs [spring]: without a spring nothing carries the wheel load"
            }
            _ => return Some(Some(held)),
        };
        problems.refuse(written.span(), message)
    }
}

/// Refuses a vertical force at the contact point if the height stays constant.
fn check_vertical(
    written: &file::Load,
    load: &Load,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let holds_height = load.held == Some(HeldQuantity::WheelHeight);
    let is_absorbed = load.at == LoadPoint::ContactPoint && load.force.z != 0.0;
    if !holds_height || !is_absorbed {
        return Some(());
    }
    let message = format!(
        "the height of the wheel is held, so a vertical force at the contact point has no effect: \
         leave z of force out; {}_vertical_force_{} is the force that holds the height",
        load.name,
        suspension.length_unit.force_symbol()
    );
    let place = written
        .force
        .as_ref()
        .map_or(written.name.span(), |f| f.span());
    problems.refuse(place, &message)
}

/// Loads on one wheel. `None` if one of them has an error.
pub(super) fn loads(
    section: &file::Outputs,
    suspension: &Suspension,
    holding: Holding,
    problems: &mut Problems,
) -> Option<Vec<Load>> {
    let written = section.loads.iter().flat_map(|l| l.get_ref());
    for side in written.filter_map(|load| load.side.as_ref()) {
        let message = "side needs [axle]; this study describes one wheel";
        problems.add(side.span(), message);
    }
    all(section, suspension, holding, problems)
}

/// Loads on the left and right wheel of an axle. The loads of each wheel are in the axes of a left wheel, so the axes of
/// the right wheel are mirrored. `None` if one of the loads has an error.
pub(super) fn loads_of_axle(
    section: &file::Outputs,
    left: &Suspension,
    holding: Holding,
    problems: &mut Problems,
) -> Option<[Vec<Load>; 2]> {
    let loads = all(section, left, holding, problems);
    let written = section.loads.iter().flat_map(|l| l.get_ref());
    let names = [("left", [true, false]), ("right", [false, true])];
    let sides = each(written, |load| {
        choose_or(&load.side, [true; 2], "side", &names, problems)
    });
    let mut on = [Vec::new(), Vec::new()];
    for (load, [left, right]) in loads?.into_iter().zip(sides?) {
        on[1].extend(right.then(|| load.clone().on_other_side()));
        on[0].extend(left.then_some(load));
    }
    Some(on)
}

fn all(
    section: &file::Outputs,
    suspension: &Suspension,
    holding: Holding,
    problems: &mut Problems,
) -> Option<Vec<Load>> {
    let written = section.loads.as_ref().map_or(&[][..], |l| l.get_ref());
    let loads: Vec<Option<Load>> = written
        .iter()
        .map(|load| resolved(load, suspension, holding, problems))
        .collect();
    for (i, load) in written.iter().enumerate() {
        // A load on the left wheel and a load on the right wheel may share a name.
        let apart = |other: &file::Load| match (&other.side, &load.side) {
            (Some(one), Some(other)) => one != other,
            _ => false,
        };
        let same = |other: &&file::Load| other.name == load.name && !apart(other);
        if let Some(first) = written[..i].iter().find(same) {
            let message = format!("{:?} is the name of another load", load.name.get_ref());
            let error = problems.add(load.name.span(), message);
            error.related(first.name.span(), "first here");
        }
        // Two loads with the same name, one on each wheel, act in one equilibrium. So both loads must keep the same
        // quantity constant.
        let differs = |k: &usize| {
            let held = [&loads[*k], &loads[i]].each(|own| own.as_ref().map(|own| own.held));
            let has_both = written[*k].name == load.name && apart(&written[*k]);
            has_both && matches!(held, [Some(one), Some(other)] if one != other)
        };
        if let Some(first) = (0..i).find(differs).map(|k| &written[k]) {
            let message = format!(
                "the loads {:?} on both wheels act together: expected the same hold for both",
                load.name.get_ref()
            );
            let error = problems.add(load.name.span(), message);
            error.related(first.name.span(), "first here");
            return None;
        }
    }
    loads.into_iter().collect()
}

fn resolved(
    written: &file::Load,
    suspension: &Suspension,
    holding: Holding,
    problems: &mut Problems,
) -> Option<Load> {
    let name = name(written, problems);
    let held = holding.held(written, problems);
    let at = choose(&written.at, "place", &PLACES, problems);
    if at == Some(LoadPoint::ContactPoint) && suspension.wheel_radius.is_none() {
        let message = "the contact point needs radius in [wheel], which this study does not give";
        return problems.refuse(written.at.span(), message);
    }
    if written.force.is_none() && written.moment.is_none() {
        let message = "expected a force, a moment or both, found neither";
        return problems.refuse(written.name.span(), message);
    }
    let unit = suspension.length_unit;
    let newtons = |of: Vector3<f64>| of * unit.newtons();
    let (symbol, length) = (unit.force_symbol(), unit.symbol());
    let force = components(&written.force, symbol, problems).map(newtons);
    let moment = components(&written.moment, &format!("{symbol} {length}"), problems);
    let (frame, moment) = (suspension.frame, newtons(moment?));
    let turn = |axis: Axis| frame.turn_sign(axis) * moment[axis];
    let load = Load {
        name: name?,
        at: at?,
        held: held?,
        force: frame.vector(force?),
        moment: Vector3::from(Axis::ALL.each(turn)),
    };
    check_vertical(written, &load, suspension, problems)?;
    Some(load)
}

/// Reads a name that can be a prefix of column names.
fn name(written: &file::Load, problems: &mut Problems) -> Option<String> {
    let name = written.name.get_ref();
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if name.is_empty() || !name.chars().all(plain) {
        let message = format!(
            "column names begin with the name of the load: expected only letters, digits and _, found {name:?}"
        );
        return problems.refuse(written.name.span(), message);
    }
    Some(name.clone())
}

/// Three components in the study's axes. Missing components are zero.
fn components(
    written: &Option<Coordinates>,
    unit: &str,
    problems: &mut Problems,
) -> Option<Vector3<f64>> {
    let what = format!("components [x, y, z] in {unit}");
    match written {
        None => Some(Vector3::default()),
        Some(written) => three(written, &what, problems),
    }
}
