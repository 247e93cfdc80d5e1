//! Targets and variables of a study with elastic parts: figures of tests, angles of the wheel in equilibrium, rates.

use super::compliance::ComplianceStudy;
use super::error::Problems;
use super::names::choose;
use super::resolve::Context;
use super::value::Text;
use super::{About, RATE_AXES, Rate, Subject, Variable, file, moves};
use crate::ask::{Unit, with_unit};
use crate::characteristics::Characteristic;
use crate::compliance::{
    AxialStiffness, HeldQuantity, KcTest, KcValue, Parameter, Shape, WheelAngle, quantities,
};
use crate::model::Suspension;
use toml::Spanned;

/// The figures that targets may name, with their units. A suffix tells tests of one load apart where a study has several.
fn figures(elastic: &ComplianceStudy, suspension: &Suspension) -> Vec<(String, KcValue, Unit)> {
    let mut found: Vec<(String, KcTest, KcValue, Unit)> = Vec::new();
    for test in &elastic.tests {
        let alike: Vec<&KcTest> = elastic
            .tests
            .iter()
            .filter(|other| other.load == test.load)
            .collect();
        let mut suffix = String::new();
        if test.trail != 0.0 {
            suffix += &format!("_trail_{}", test.trail);
        }
        let same_trail = |other: &&&KcTest| other.trail == test.trail && other.held != test.held;
        if alike.iter().any(|other| same_trail(&other)) {
            suffix += match test.held {
                HeldQuantity::WheelHeight => "_wheel_height",
                HeldQuantity::WheelLoad => "_wheel_load",
            };
        }
        for (quantity, unit) in quantities(suspension, &elastic.parts, elastic.tyre_rate, test) {
            for is_secant in [false, true] {
                // A motion has no window.
                if is_secant && test.load.is_motion() {
                    continue;
                }
                let secant = if is_secant { "_secant" } else { "" };
                let value = KcValue::Figure {
                    test: *test,
                    quantity,
                    is_secant,
                };
                let name = format!("{quantity}{suffix}{secant}");
                found.push((name, *test, value, unit));
            }
        }
    }
    let names: Vec<String> = found.iter().map(|(name, ..)| name.clone()).collect();
    let is_shared = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
    found
        .into_iter()
        .map(|(name, test, value, unit)| match is_shared(&name) {
            true => (format!("{name}_{}", test.load.name()), value, unit),
            false => (name, value, unit),
        })
        .collect()
}

/// What a target of a study with elastic parts is about: a figure, or an angle of the wheel in equilibrium.
pub(super) fn subject(
    target: &Spanned<file::Target>,
    elastic: &ComplianceStudy,
    context: &Context,
    problems: &mut Problems,
) -> Option<Subject> {
    let (written, place) = (target.get_ref(), target.span());
    let length = context.suspension.length_unit;
    let others = [
        written.point.as_ref().map(Spanned::span),
        written.length.as_ref().map(Spanned::span),
        written.load.as_ref().map(Spanned::span),
    ];
    if let Some(other) = others.into_iter().flatten().next() {
        let message = "with [compliance] a target is a figure of a test, or a characteristic";
        return problems.refuse(other, message);
    }
    match (&written.figure, &written.characteristic) {
        (Some(name), None) => {
            let all = figures(elastic, context.suspension);
            let options: Vec<_> = all
                .iter()
                .map(|(name, value, unit)| (name.as_str(), (*value, *unit)))
                .collect();
            let (value, unit) = choose(name, "figure", &options, problems)?;
            Some(Subject {
                about: About::Elastic(value),
                column: with_unit(name.get_ref().clone(), &unit.suffix(length)),
                unit,
                length,
                sign: 1.0,
            })
        }
        (None, Some(name)) => {
            let angles = [
                (Characteristic::Toe, WheelAngle::Toe),
                (Characteristic::Camber, WheelAngle::Camber),
                (Characteristic::Caster, WheelAngle::Caster),
                (
                    Characteristic::KingpinInclination,
                    WheelAngle::KingpinInclination,
                ),
            ];
            let known = super::outputs::characteristic(name, context.suspension, problems)?;
            let Some((_, angle)) = angles.into_iter().find(|(own, _)| *own == known) else {
                let error = problems.add(
                    name.span(),
                    format!("{} is of the rigid mechanism", name.get_ref()),
                );
                error.help(
                    "with [compliance] a target is about toe, camber, caster, kingpin_inclination, or a figure of a test",
                );
                return None;
            };
            Some(Subject {
                about: About::Elastic(KcValue::Angle(angle)),
                ..Subject::characteristic(known, length)
            })
        }
        (Some(_), Some(name)) => {
            let message = "expected one of figure and characteristic, found both";
            problems.refuse(name.span(), message)
        }
        (None, None) => problems.refuse(place, "expected figure or characteristic"),
    }
}

/// A variable that is the rate of a bushing or a link.
pub(super) fn rate(
    variable: &Spanned<file::Variable>,
    context: &Context,
    cost: Option<f64>,
    problems: &mut Problems,
) -> Option<Variable> {
    let written = variable.get_ref();
    let Some(elastic) = context.elastic else {
        // What is wrong with the elastic parts is said already.
        if context.file.compliance.is_some() {
            return None;
        }
        let message = "a rate as a variable needs [compliance] with elastic parts";
        return problems.refuse(variable.span(), message);
    };
    let others = [
        written.hardpoint.as_ref().map(Spanned::span),
        written.hardpoints.as_ref().map(Spanned::span),
        written.rigid.as_ref().map(Spanned::span),
        written.axis.as_ref().map(Spanned::span),
        written.direction.as_ref().map(Spanned::span),
        written.factors.as_ref().map(Spanned::span),
    ];
    if let Some(other) = others.into_iter().flatten().next() {
        return problems.refuse(other, "this is of hardpoints, not of a rate");
    }
    let is_relative = written
        .relative
        .as_ref()
        .is_some_and(|said| *said.get_ref());
    let (name, parameter, design) = match (&written.bushing, &written.link) {
        (Some(name), None) => bushing_rate(name, written, is_relative, elastic, context, problems)?,
        (None, Some(name)) => link_rate(name, elastic, problems)?,
        _ => {
            let message = "expected one of bushing and link";
            return problems.refuse(variable.span(), message);
        }
    };
    let Some(range) = &written.range else {
        return problems.refuse(variable.span(), "the key \"range\" is missing");
    };
    let what = if is_relative { "factors" } else { "rates" };
    let [low, high] = moves::range(range, what, problems)?;
    if low <= 0.0 {
        let message = format!("expected {what} above 0, found {low}");
        return problems.refuse(range.span(), message);
    }
    let own = if is_relative { 1.0 } else { design };
    if low > own || high < own {
        let message = format!("the range leaves out the study's own, which is {own}");
        return problems.refuse(range.span(), message);
    }
    let range = match is_relative {
        true => [low.ln(), high.ln()],
        false => [low - design, high - design],
    };
    Some(Variable {
        name,
        moves: Vec::new(),
        turn: None,
        rate: Some(Rate {
            parameter,
            design,
            is_relative,
        }),
        range,
        cost: cost?,
    })
}

type Found = (String, Parameter, f64);

fn bushing_rate(
    name: &Text,
    written: &file::Variable,
    is_relative: bool,
    elastic: &ComplianceStudy,
    context: &Context,
    problems: &mut Problems,
) -> Option<Found> {
    let mechanism = &context.suspension.mechanism;
    let parts = elastic.parts.bushings.iter().enumerate();
    let options: Vec<_> = parts
        .map(|(number, part)| (mechanism.name(part.point), number))
        .collect();
    let number = choose(name, "bushing", &options, problems)?;
    let Some(axis) = &written.stiffness else {
        let message = "expected stiffness: \"x\", \"y\", \"z\", \"tx\", \"ty\" or \"tz\"";
        return problems.refuse(name.span(), message);
    };
    let axes: Vec<_> = RATE_AXES
        .into_iter()
        .enumerate()
        .map(|(k, a)| (a, k))
        .collect();
    let k = choose(axis, "axis of a bushing", &axes, problems)?;
    let design = match &elastic.parts.bushings[number].shapes[k] {
        Shape::Cubic { rate, .. } => *rate,
        Shape::Curve { .. } if !is_relative => {
            let message = "a curve is scaled: expected relative = true";
            return problems.refuse(axis.span(), message);
        }
        Shape::Curve { scale, .. } => *scale,
    };
    if design == 0.0 {
        let message = "this rate is 0 in the study, so there is nothing to vary";
        return problems.refuse(axis.span(), message);
    }
    let name = format!("bushing:{}", name.get_ref());
    Some((name, Parameter::Stiffness(number, k), design))
}

fn link_rate(name: &Text, elastic: &ComplianceStudy, problems: &mut Problems) -> Option<Found> {
    let names = elastic.link_names.iter().enumerate();
    let options: Vec<_> = names.map(|(k, name)| (name.as_str(), k)).collect();
    let number = choose(name, "link", &options, problems)?;
    let design = match elastic.parts.links[number].stiffness {
        AxialStiffness::Rate(rate) => rate,
        AxialStiffness::PerStrain(force) => force,
    };
    let name = format!("link:{}", name.get_ref());
    Some((name, Parameter::Link(number), design))
}

/// Refuses what tuning does not know of elastic parts.
pub(super) fn refuse_in_optimise(section: &file::Optimise, problems: &mut Problems) -> Option<()> {
    let places = [
        (
            "constraints",
            section.constraints.first().map(Spanned::span),
        ),
        ("scatter", section.scatter.as_ref().map(|n| n.span())),
        ("front", section.front.as_ref().map(Spanned::span)),
    ];
    let mut found = places
        .into_iter()
        .filter_map(|(key, span)| Some((key, span?)));
    let Some((key, span)) = found.next() else {
        return Some(());
    };
    let message = format!("{key} is not available yet with [compliance]");
    problems.refuse(span, message)
}
