//! `[outputs]`: requested results.

use super::axle_forces;
use super::elastic_targets::{self, ElasticQuantity};
use super::error::Problems;
use super::file::{self, File};
use super::loads::{Holding, loads};
use super::names::{choose, choose_or, nearest};
use super::output_measures::measures;
use super::resolve::each;
use super::subject::point;
use super::value::{Selection, Text};
use super::{ComplianceStudy, Order, Outputs};
use crate::ask::Need;
use crate::axle::Quantity;
use crate::characteristics::Characteristic;
use crate::model::{PointId, SteeringAxis, Suspension};

/// Default outputs of a study without `[outputs]`: the angles of the wheel and of the steering axis, if there is one.
const DEFAULT: [Characteristic; 4] = [
    Characteristic::Camber,
    Characteristic::Toe,
    Characteristic::KingpinInclination,
    Characteristic::Caster,
];

/// Reads the outputs. `None` if they have an error.
pub(super) fn outputs(
    file: &File,
    suspension: &Suspension,
    elastic: Option<&ComplianceStudy>,
    problems: &mut Problems,
) -> Option<Outputs> {
    let Some(section) = &file.outputs else {
        let steered = match elastic {
            // In equilibrium, the steering axis must run through joints.
            Some(_) => matches!(
                suspension.mechanism.steering_axis,
                Some(SteeringAxis::Through { .. })
            ),
            None => suspension.mechanism.steering_axis.is_some(),
        };
        let possible = DEFAULT
            .into_iter()
            .filter(|c| steered || !c.info().reads_steering_axis());
        return Some(Outputs::of(possible.collect()));
    };
    if elastic.is_some() {
        elastic_targets::refuse_in_outputs(section, problems)?;
    }
    let named = distinct(
        &section.characteristics,
        problems,
        |text, problems| match elastic {
            Some(elastic) => elastic_targets::quantity(text, elastic, suspension, problems),
            None => {
                let found = characteristic(text, suspension, problems);
                found.map(ElasticQuantity::Characteristic)
            }
        },
    );
    let points = points(section, suspension, problems);
    let measures = measures(section, file, suspension, problems);
    let order = order(section, problems);
    let sensitivities = sensitivities(section, suspension, problems);
    let has_spring = elastic.map(|elastic| elastic.parts.spring.is_some());
    let loads = loads(section, suspension, Holding::of(has_spring), problems);
    let order = order?;
    let (mut characteristics, mut figures) = (Vec::new(), Vec::new());
    for (named, text) in named?.into_iter().zip(&section.characteristics) {
        match named {
            ElasticQuantity::Characteristic(own) => {
                if elastic.is_some() && order > Order::Position && own.info().reads_rates() {
                    let message = format!(
                        "{} is a derivative with respect to travel: with [compliance] expected order = \"position\"",
                        text.get_ref()
                    );
                    return problems.refuse(text.span(), &message);
                }
                characteristics.push(own);
            }
            ElasticQuantity::Figure(figure) => figures.push(figure),
        }
    }
    Some(Outputs {
        characteristics,
        points: points?,
        measures: measures?,
        knuckle: knuckle(section, order, problems),
        order,
        sensitivities: sensitivities?,
        certify: certify(section),
        loads: loads?,
        figures,
    })
}

/// Points whose coordinates are in the results.
pub(super) fn points(
    section: &file::Outputs,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<PointId>> {
    distinct(&section.points, problems, |text, problems| {
        point(text, suspension, problems)
    })
}

/// Hardpoints for whose coordinates the study requests derivatives.
pub(super) fn sensitivities(
    section: &file::Outputs,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<PointId>> {
    match &section.sensitivities {
        None | Some(Selection::All(false)) => Some(Vec::new()),
        Some(Selection::All(true)) => Some(hardpoints(suspension).map(|(_, id)| id).collect()),
        Some(Selection::Named(names)) => distinct(names, problems, |text, problems| {
            hardpoint(text, suspension, problems)
        }),
    }
}

/// Returns true if the study requests the angular rates of the knuckle. These rates need an order above position.
pub(super) fn knuckle(section: &file::Outputs, order: Order, problems: &mut Problems) -> bool {
    let knuckle = section.knuckle.as_ref();
    if let Some(knuckle) = knuckle.filter(|k| *k.get_ref() && order == Order::Position) {
        let message = "knuckle = true needs angular velocity, but order is \"position\"";
        let error = problems.add(knuckle.span(), message);
        error.help("use order = \"velocity\" or \"acceleration\"");
    }
    knuckle.is_some_and(|k| *k.get_ref())
}

/// Returns true if each pose must be certified.
pub(super) fn certify(section: &file::Outputs) -> bool {
    section.certify.as_ref().is_some_and(|c| *c.get_ref())
}

pub(super) fn order(section: &file::Outputs, problems: &mut Problems) -> Option<Order> {
    let orders = [
        ("position", Order::Position),
        ("velocity", Order::Velocity),
        ("acceleration", Order::Acceleration),
    ];
    choose_or(&section.order, Order::Position, "order", &orders, problems)
}

/// Resolves each name, and refuses repeated names.
pub(super) fn distinct<T>(
    names: &[Text],
    problems: &mut Problems,
    mut resolve: impl FnMut(&Text, &mut Problems) -> Option<T>,
) -> Option<Vec<T>> {
    let resolved = each(names, |text| resolve(text, problems));
    for (i, text) in names.iter().enumerate() {
        if let Some(first) = names[..i].iter().find(|other| *other == text) {
            let message = format!("{:?} is listed twice", text.get_ref());
            let error = problems.add(text.span(), message);
            error.related(first.span(), "first here");
        }
    }
    resolved
}

/// Hardpoints of the study, without extra points.
pub(super) fn hardpoints(suspension: &Suspension) -> impl Iterator<Item = (&str, PointId)> {
    let mechanism = &suspension.mechanism;
    let points = mechanism.points.iter().enumerate();
    points
        .filter(|(_, p)| mechanism.topology.hardpoint(&p.name).is_some())
        .map(|(i, p)| (p.name.as_str(), PointId(i)))
}

/// Finds the hardpoint with this name. The study must give it.
pub(super) fn hardpoint(
    text: &Text,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<PointId> {
    let name = text.get_ref();
    let mechanism = &suspension.mechanism;
    if let Some(absent) = mechanism.topology.hardpoint(name)
        && mechanism.point(name).is_none()
    {
        let message = format!("this study does not give {name} ({})", absent.about);
        return problems.refuse(text.span(), message);
    }
    if mechanism.point(name).is_some() && !hardpoints(suspension).any(|(known, _)| known == name) {
        let message = format!("{name} is an extra point; expected a hardpoint");
        return problems.refuse(text.span(), message);
    }
    let hardpoints: Vec<_> = hardpoints(suspension).collect();
    choose(text, "hardpoint", &hardpoints, problems)
}

/// Refuses a quantity that only axles have, also if its name is misspelt. Returns true if it refused the name.
fn refuses_axle_quantity(
    text: &Text,
    of_a_wheel: &[(&'static str, Characteristic)],
    problems: &mut Problems,
) -> bool {
    let name = text.get_ref();
    let is_of_a_wheel = |name: &str| of_a_wheel.iter().any(|(known, _)| *known == name);
    if is_of_a_wheel(name) {
        return false;
    }
    // If a misspelt name is closest to a quantity of one wheel, the message suggests that quantity.
    let all = of_a_wheel.iter().map(|(known, _)| *known);
    let meant = nearest(name, all.chain(Quantity::names()));
    let Some(meant) = meant.filter(|meant| !is_of_a_wheel(meant)) else {
        return false;
    };
    let message = if meant == name {
        format!("{name} is a quantity of an axle, not of one wheel")
    } else {
        format!("unknown characteristic {name:?}; did you mean {meant:?}?")
    };
    let error = problems.add(text.span(), message);
    error.help(format!(
        "{meant} needs [axle] in the study: see docs/axle.md, or `hardpoint new TOPOLOGY --with axle`"
    ));
    true
}

/// Finds the characteristic with this name. The study must give its inputs.
pub(super) fn characteristic(
    text: &Text,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Characteristic> {
    let all: Vec<_> = Characteristic::ALL
        .iter()
        .map(|c| (c.info().name, *c))
        .collect();
    if refuses_axle_quantity(text, &all, problems) {
        return None;
    }
    let characteristic = choose(text, "characteristic", &all, problems)?;
    let mechanism = &suspension.mechanism;
    let needs_axis = characteristic.info().needs.contains(&Need::SteeringAxis);
    if needs_axis && mechanism.steering_axis.is_none() {
        let message = format!(
            "{} needs a steering axis, which {} does not have",
            text.get_ref(),
            mechanism.topology.name
        );
        return problems.refuse(text.span(), message);
    }
    let vehicle = &suspension.vehicle;
    let needs = characteristic.info().needs;
    let forces = needs.iter().find(|need| {
        use Need::{FrontBraking, RearBrakingOrFrontDrive, RearDrive};
        matches!(need, FrontBraking | RearDrive | RearBrakingOrFrontDrive)
    });
    let missing = needs.iter().filter(|need| !need.met_by(suspension));
    let missing: Vec<&str> = missing
        .filter_map(|need| need.key())
        .chain(
            forces
                .into_iter()
                .flat_map(|need| axle_forces::missing(need, vehicle)),
        )
        .collect();
    if missing.is_empty() {
        let refusal = forces.and_then(|need| axle_forces::refusal(need, vehicle));
        let Some((reason, instead)) = refusal else {
            return Some(characteristic);
        };
        let error = problems.add(text.span(), format!("{} {reason}", text.get_ref()));
        if let Some(instead) = instead {
            error.help(instead);
        }
        return None;
    }
    let needs = missing.join(", ");
    let message = format!(
        "{} needs {needs}, which this study does not give",
        text.get_ref()
    );
    problems.refuse(text.span(), message)
}
