//! Quantities and variables of a study with elastic parts: test results, characteristics in equilibrium, and rates.

use super::compliance::ComplianceStudy;
use super::error::Problems;
use super::names::choose;
use super::output_measures::measured;
use super::resolve::Context;
use super::suspension::ABOVE_ZERO;
use super::untested;
use super::value::Text;
use super::{
    ElasticFigure, NamedParts, RATE_AXES, Rate, TargetKind, TargetQuantity, Variable, file, moves,
};
use crate::characteristics::Characteristic;
use crate::compliance::{
    AxialStiffness, HeldQuantity, KcTest, KcValue, Parameter, Shape, not_of_equilibrium, quantities,
};
use crate::model::{LengthUnit, SteeringAxis, Suspension};
use std::ops::Range as Span;
use toml::Spanned;

/// Results of a study's compliance tests, with unique names. A name has a suffix for the trail (distance of the side force behind
/// the contact point). If two tests differ only in the held quantity, their names have a suffix for this quantity. If two tests
/// with different loads would have the same name, the load is a suffix, too.
pub(super) fn figures(elastic: &ComplianceStudy, suspension: &Suspension) -> Vec<ElasticFigure> {
    let mut found: Vec<(KcTest, ElasticFigure)> = Vec::new();
    for test in &elastic.tests {
        let mut suffix = test.trail_suffix();
        let other_hold = |other: &KcTest| {
            (other.load, other.trail) == (test.load, test.trail) && other.held != test.held
        };
        if elastic.tests.iter().any(other_hold) {
            suffix += match test.held {
                HeldQuantity::WheelHeight => "_wheel_height",
                HeldQuantity::WheelLoad => "_wheel_load",
            };
        }
        for (quantity, unit) in quantities(suspension, &elastic.parts, elastic.tyre_rate, test) {
            for is_secant in [false, true] {
                // A test that prescribes a motion has no range of loads (key `window`), so it has no secant.
                if is_secant && test.load.is_motion() {
                    continue;
                }
                let secant = if is_secant { "_secant" } else { "" };
                let figure = ElasticFigure {
                    name: format!("{quantity}{suffix}{secant}"),
                    value: KcValue::Figure {
                        test: *test,
                        quantity,
                        is_secant,
                    },
                    unit,
                };
                found.push((*test, figure));
            }
        }
    }
    let names: Vec<String> = found.iter().map(|(_, own)| own.name.clone()).collect();
    let is_shared = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
    let named = |(test, figure): (KcTest, ElasticFigure)| {
        if is_shared(&figure.name) {
            ElasticFigure {
                name: format!("{}_{}", figure.name, test.load.name()),
                ..figure
            }
        } else {
            figure
        }
    };
    found.into_iter().map(named).collect()
}

/// Quantity of a wheel with elastic parts.
#[derive(Clone, Debug)]
pub(super) enum ElasticQuantity {
    /// A characteristic of the wheel in equilibrium.
    Characteristic(Characteristic),
    /// A test result.
    Figure(ElasticFigure),
}

impl ElasticQuantity {
    /// Returns the value in equilibrium from which the quantity is computed.
    pub(super) fn value(&self) -> KcValue {
        match self {
            ElasticQuantity::Characteristic(of) => KcValue::Wheel(*of),
            ElasticQuantity::Figure(figure) => figure.value,
        }
    }

    /// The quantity as the subject of a target or a band.
    pub(super) fn subject(&self, length: LengthUnit) -> TargetQuantity {
        match self {
            ElasticQuantity::Characteristic(of) => TargetQuantity {
                kind: TargetKind::Elastic(self.value()),
                ..TargetQuantity::characteristic(*of, length)
            },
            ElasticQuantity::Figure(figure) => TargetQuantity {
                kind: TargetKind::Elastic(figure.value),
                column: figure.column(length),
                unit: figure.unit,
                length,
                sign: 1.0,
            },
        }
    }
}

/// Finds the quantity with this name: a test result, or a characteristic of the wheel in equilibrium.
pub(super) fn quantity(
    name: &Text,
    elastic: &ComplianceStudy,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<ElasticQuantity> {
    let figures = figures(elastic, suspension);
    let mut options: Vec<(&str, Option<usize>)> = Vec::new();
    options.extend(
        figures
            .iter()
            .enumerate()
            .map(|(k, figure)| (figure.name.as_str(), Some(k))),
    );
    let characteristics = Characteristic::ALL.iter();
    options.extend(characteristics.map(|c| (c.info().name, None)));
    let what = "characteristic or figure";
    let known = || options.iter().map(|(name, _)| *name);
    if untested::refuses(name, what, known, &elastic.tests, problems) {
        return None;
    }
    if let Some(number) = choose(name, what, &options, problems)? {
        return Some(ElasticQuantity::Figure(figures[number].clone()));
    }
    let known = super::outputs::characteristic(name, suspension, problems)?;
    in_equilibrium(name, known, suspension, problems).map(ElasticQuantity::Characteristic)
}

/// Returns the characteristic `known`. Refuses a characteristic that an equilibrium does not have.
pub(super) fn in_equilibrium(
    name: &Text,
    known: Characteristic,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Characteristic> {
    if let Some([reason, instead]) = not_of_equilibrium(known) {
        let message = format!("{} {reason}", name.get_ref());
        problems.add(name.span(), message).help(instead);
        return None;
    }
    let joints = matches!(
        suspension.mechanism.steering_axis,
        Some(SteeringAxis::Through { .. })
    );
    if known.info().reads_steering_axis() && !joints {
        let message = format!(
            "{} needs joints of a steering axis, which {} does not have; use \
             spin_by_lateral_force or spin_by_braking",
            name.get_ref(),
            suspension.mechanism.topology.name
        );
        return problems.refuse(name.span(), &message);
    }
    Some(known)
}

/// Quantity of a target or constraint in a study with elastic parts.
pub(super) fn named(
    figure: Option<&Text>,
    characteristic: Option<&Text>,
    others: &[Option<Span<usize>>],
    place: Span<usize>,
    context: &Context,
    elastic: &ComplianceStudy,
    problems: &mut Problems,
) -> Option<ElasticQuantity> {
    if let Some(other) = others.iter().flatten().next() {
        let message = "with [compliance] expected \"figure\" (a test result) or \"characteristic\"; this key \
                       applies to the rigid mechanism only";
        return problems.refuse(other.clone(), message);
    }
    let name = match (figure, characteristic) {
        (Some(name), None) | (None, Some(name)) => name,
        (Some(_), Some(name)) => {
            let message = "expected either \"figure\" or \"characteristic\", found both";
            return problems.refuse(name.span(), message);
        }
        (None, None) => return problems.refuse(place, "expected \"figure\" or \"characteristic\""),
    };
    quantity(name, elastic, context.suspension, problems)
}

/// Subject of a target in a study with elastic parts.
pub(super) fn subject(
    target: &Spanned<file::Target>,
    elastic: &ComplianceStudy,
    context: &Context,
    problems: &mut Problems,
) -> Option<TargetQuantity> {
    let written = target.get_ref();
    let others = [
        written.point.as_ref().map(Spanned::span),
        written.length.as_ref().map(Spanned::span),
        written.load.as_ref().map(Spanned::span),
    ];
    let found = named(
        written.figure.as_ref(),
        written.characteristic.as_ref(),
        &others,
        target.span(),
        context,
        elastic,
        problems,
    )?;
    Some(found.subject(context.suspension.length_unit))
}

/// Refuses outputs that are not available in equilibrium.
pub(super) fn refuse_in_outputs(section: &file::Outputs, problems: &mut Problems) -> Option<()> {
    let is_on =
        |said: &Option<Spanned<bool>>| said.as_ref().filter(|s| *s.get_ref()).map(Spanned::span);
    let order = section
        .order
        .as_ref()
        .filter(|o| o.get_ref() == "acceleration");
    let points = section.points.first().map(Text::span);
    let places = [
        (
            measured(section),
            "lengths, plunges, articulations and clearances apply to the rigid mechanism; with [compliance] they are not available",
        ),
        (
            points,
            "points apply to the rigid mechanism; with [compliance] levels.csv of `hardpoint kc` has wheel centre and contact point",
        ),
        (
            is_on(&section.knuckle),
            "knuckle applies to the rigid mechanism; with [compliance] it is not available",
        ),
        (
            is_on(&section.certify),
            "certify works for the rigid mechanism only; with [compliance] it is not available",
        ),
        (
            order.map(Text::span),
            "with [compliance] expected order = \"position\" or \"velocity\"",
        ),
    ];
    let mut found = places
        .into_iter()
        .filter_map(|(span, message)| Some((span?, message)));
    match found.next() {
        None => Some(()),
        Some((span, message)) => problems.refuse(span, message),
    }
}

/// Keys that name a rate of an elastic part, in a variable or in a scatter entry.
pub(super) struct RateKeys<'a> {
    /// Position of the variable or scatter entry in the file.
    pub place: Span<usize>,
    /// Name of a bushing. An entry gives exactly one of this key, `link` and `rate`.
    pub bushing: &'a Option<Text>,
    /// Name of a link.
    pub link: &'a Option<Text>,
    /// Name of a part that has only one rate.
    pub rate: &'a Option<Text>,
    /// Axis of a bushing's stiffness.
    pub stiffness: &'a Option<Text>,
    /// True if values are factors of the rate.
    pub relative: &'a Option<Spanned<bool>>,
    /// Positions in the file of keys that a rate does not accept.
    pub others: &'a [Option<Span<usize>>],
}

/// Collects the keys of a rate from an entry at `place`. The last two arguments list keys of the entry that a rate does not
/// accept: first the keys with other values, then the keys with numbers.
macro_rules! rate_keys {
    ($written:expr, $place:expr, [$($other:ident),*], [$($number:ident),*]) => {
        RateKeys {
            place: $place,
            bushing: &$written.bushing,
            link: &$written.link,
            rate: &$written.rate,
            stiffness: &$written.stiffness,
            relative: &$written.relative,
            others: &[
                $($written.$other.as_ref().map(Spanned::span),)*
                $($written.$number.as_ref().map(|number| number.span.clone()),)*
            ],
        }
    };
}
pub(super) use rate_keys;

impl RateKeys<'_> {
    /// Returns true if the entry names a rate. Refuses keys of a rate if the entry names no rate.
    pub(super) fn is_given(&self, problems: &mut Problems) -> Option<bool> {
        if self.bushing.is_some() || self.link.is_some() || self.rate.is_some() {
            return Some(true);
        }
        let keys = [
            ("stiffness", self.stiffness.as_ref().map(Spanned::span)),
            ("relative", self.relative.as_ref().map(Spanned::span)),
        ];
        for (key, span) in keys {
            if let Some(span) = span {
                let message = format!(
                    "{key} needs \"bushing\", \"link\" or \"rate\": the part whose rate varies"
                );
                return problems.refuse(span, &message);
            }
        }
        Some(false)
    }

    /// Reads the name of the part and its rate.
    pub(super) fn read(
        &self,
        context: &Context,
        problems: &mut Problems,
    ) -> Option<(String, Rate)> {
        let of_axle = context.elastic_axle();
        let parts = NamedParts::of(context.suspension, context.elastic, of_axle);
        let Some(parts) = parts else {
            // Errors in the elastic parts are already reported.
            if context.file.compliance.is_some() {
                return None;
            }
            let message = "a rate needs [compliance] with elastic parts";
            return problems.refuse(self.place.clone(), message);
        };
        if let Some(other) = self.others.iter().flatten().next() {
            return problems.refuse(other.clone(), "this key moves hardpoints, not a rate");
        }
        let is_relative = self.relative.as_ref().is_some_and(|said| *said.get_ref());
        if let (None, Some(axis)) = (self.bushing, self.stiffness) {
            let message = "the key \"stiffness\" selects an axis of a bushing, and this part is not a bushing: remove the key";
            return problems.refuse(axis.span(), message);
        }
        let (name, rate) = match (self.bushing, self.link, self.rate) {
            (Some(name), None, None) => {
                let axis = self.stiffness.as_ref();
                bushing_rate(name, axis, is_relative, &parts, problems)?
            }
            (None, Some(name), None) => link_rate(name, &parts, problems)?,
            (None, None, Some(name)) => part_rate(name, &parts, problems)?,
            _ => {
                let message = "expected one of the keys \"bushing\", \"link\" and \"rate\"";
                return problems.refuse(self.place.clone(), message);
            }
        };
        if of_axle.is_some_and(|own| own.parts.differs(rate.parameter)) {
            let message = format!(
                "{name} has different rates on both wheels: a variable needs the same rate on both"
            );
            return problems.refuse(self.place.clone(), &message);
        }
        Some((
            name,
            Rate {
                is_relative,
                ..rate
            },
        ))
    }
}

/// Reads a variable that is the rate of an elastic part.
pub(super) fn rate(
    variable: &Spanned<file::Variable>,
    named: &RateKeys<'_>,
    context: &Context,
    cost: Option<f64>,
    problems: &mut Problems,
) -> Option<Variable> {
    let written = variable.get_ref();
    let (part, rate) = named.read(context, problems)?;
    let (design, is_relative) = (rate.design, rate.is_relative);
    let name = match (&written.link, &written.rate) {
        (Some(_), _) => format!("link:{part}"),
        (None, Some(_)) => part,
        (None, None) => format!("bushing:{part}"),
    };
    let Some(range) = &written.range else {
        return problems.refuse(variable.span(), "the key \"range\" is missing");
    };
    let what = if is_relative { "factors" } else { "rates" };
    let [low, high] = moves::accepted_range(range, what, ABOVE_ZERO, problems)?;
    let own = if is_relative { 1.0 } else { design };
    if low > own || high < own {
        let message = format!("the range does not include the study's value {own}");
        return problems.refuse(range.span(), message);
    }
    let range = if is_relative {
        [low.ln(), high.ln()]
    } else {
        [low - design, high - design]
    };
    Some(Variable {
        name,
        moves: Vec::new(),
        turn: None,
        rate: Some(rate),
        range,
        cost: cost?,
    })
}

/// Name of a part, and its rate. The rate is not relative: a variable changes it by amounts, not by factors.
type Found = (String, Rate);

fn absolute(name: &str, parameter: Parameter, design: f64) -> Found {
    let rate = Rate {
        parameter,
        design,
        is_relative: false,
        is_per_strain: false,
    };
    (name.to_owned(), rate)
}

fn bushing_rate(
    name: &Text,
    axis: Option<&Text>,
    is_relative: bool,
    parts: &NamedParts<'_>,
    problems: &mut Problems,
) -> Option<Found> {
    let bushings = parts.bushings.iter().enumerate();
    let options: Vec<_> = bushings.map(|(number, own)| (own.name, number)).collect();
    let number = choose(name, "bushing", &options, problems)?;
    let Some(axis) = axis else {
        let message = "expected stiffness: \"x\", \"y\", \"z\", \"tx\", \"ty\" or \"tz\"";
        return problems.refuse(name.span(), message);
    };
    let axes: Vec<_> = RATE_AXES
        .into_iter()
        .enumerate()
        .map(|(k, a)| (a, k))
        .collect();
    let k = choose(axis, "axis of a bushing", &axes, problems)?;
    let design = match &parts.bushings[number].shapes[k] {
        Shape::Cubic { rate, .. } => *rate,
        Shape::Curve { .. } if !is_relative => {
            let message = "a force curve can only be scaled: expected relative = true";
            return problems.refuse(axis.span(), message);
        }
        Shape::Curve { scale, .. } => *scale,
    };
    if design == 0.0 {
        let message = "this rate is 0 in the study, so there is nothing to vary";
        return problems.refuse(axis.span(), message);
    }
    let parameter = Parameter::Stiffness(number, k);
    Some(absolute(name.get_ref(), parameter, design))
}

fn link_rate(name: &Text, parts: &NamedParts<'_>, problems: &mut Problems) -> Option<Found> {
    let links = parts.links.iter().enumerate();
    let options: Vec<_> = links.map(|(k, link)| (link.name, k)).collect();
    let number = choose(name, "link", &options, problems)?;
    let (design, is_per_strain) = match parts.links[number].stiffness {
        AxialStiffness::Rate(rate) => (rate, false),
        AxialStiffness::PerStrain(force) => (force, true),
    };
    let (name, rate) = absolute(name.get_ref(), Parameter::Link(number), design);
    let rate = Rate {
        is_per_strain,
        ..rate
    };
    Some((name, rate))
}

fn part_rate(name: &Text, parts: &NamedParts<'_>, problems: &mut Problems) -> Option<Found> {
    if parts.rates.is_empty() {
        let message = "the study has no spring with a rate, anti-roll bar, rack_stiffness or column_stiffness";
        return problems.refuse(name.span(), message);
    }
    let options: Vec<_> = parts.rates.iter().map(|own| (own.name, own)).collect();
    let own = choose(name, "rate", &options, problems)?;
    Some(absolute(own.name, own.parameter, own.value))
}
