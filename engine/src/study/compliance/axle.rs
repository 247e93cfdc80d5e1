//! Elastic parts of an axle, and their tests.

use super::super::error::Problems;
use super::super::file;
use super::super::file::File;
use super::super::resolve::Parts;
use super::super::right_wheel;
use super::super::suspension::above_zero;
use super::super::value::Text;
use super::{
    NamedParts, WheelParts, bushing, check_design_load, check_spring, link, section, solid,
    subframe, tests, tyre_rate, wheel_parts,
};
use crate::axle::{Axle, AxleMotion, TestFigure, WheelMotion};
use crate::compliance::{AxleCompliance, AxleKcRun, KcTest, SteeringColumn, TestLoad};
use crate::model::{Side, Suspension};
use std::f64::consts::TAU;
use std::ops::Range as Span;
use std::path::Path;
use toml::Spanned;

/// Elastic parts of an axle and their tests.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleComplianceStudy {
    /// Elastic parts of the axle.
    pub parts: AxleCompliance,
    /// Names of the links of a wheel, in the order of [`crate::compliance::Compliance::links`].
    pub link_names: Vec<String>,
    /// Tests of the elastic parts.
    pub tests: Vec<KcTest>,
    /// Results of the tests, with their names.
    pub figures: Vec<TestFigure>,
    /// Rate of the tyre, in N per length unit.
    pub tyre_rate: Option<f64>,
}

impl AxleComplianceStudy {
    /// Names of the bushings of a wheel, then of the mounts of the subframe.
    pub fn bushing_names(&self, suspension: &Suspension) -> Vec<String> {
        let parts = NamedParts::of(suspension, None, Some(self));
        let bushings = parts.into_iter().flat_map(|own| own.bushings);
        bushings.map(|own| own.name.to_owned()).collect()
    }
}

/// Elastic parts of an axle. `None` if these parts have an error, `Some(None)` if there are no such parts. `motions` are the
/// motions of the study, each with its position in the file.
pub(in super::super) fn axle_compliance<'m>(
    file: &File,
    axle: &Axle,
    motions: impl IntoIterator<Item = (Span<usize>, &'m AxleMotion)>,
    parts: Parts,
    directory: &Path,
    problems: &mut Problems,
) -> Option<Option<AxleComplianceStudy>> {
    let suspension = &axle.left;
    let Some(section) = section(file, suspension, parts, problems)? else {
        refuse_stiffness(file, problems)?;
        return Some(None);
    };
    for (place, motion) in motions {
        refuse_motion(place, motion, problems)?;
    }
    let setup = &axle.setup;
    refuse_springs_between_rockers(file, problems)?;
    let own = subframe::subframe(file, suspension, directory, problems);
    let mounts: Vec<&str> = file
        .subframe
        .iter()
        .flat_map(|section| section.get_ref().mounts.keys())
        .map(|name| name.get_ref().as_str())
        .collect();
    let found = wheel_parts(file, section, suspension, &mounts, directory, problems);
    let rates = (steering(file, axle, problems), tyre_rate(file, problems));
    let (own, found, (rack_rate, column), tyre_rate) = (own?, found?, rates.0?, rates.1?);
    let link_names = found.link_names();
    let right = right_parts(file, &found, suspension, directory, problems)?;
    let springs = setup.springs.clone();
    let wheel = found.with(springs.as_ref().map(|[left, _]| left.clone()));
    let right = right.with(springs.map(|[_, right]| right));
    check_design_load(section, wheel.relaxed, wheel.spring.is_some(), problems)?;
    for (side, wheel) in Side::ALL.into_iter().zip([&wheel, &right]) {
        check_spring(axle.suspension(side), section, problems)?;
        let has_bar = setup.bar_rate.is_some();
        subframe::check_reach(
            section,
            own.as_ref(),
            axle.suspension(side),
            wheel,
            has_bar,
            problems,
        )?;
    }
    link::check_members(file, suspension, &wheel, problems)?;
    let steers = suspension.mechanism.has_rack();
    let has_spring = wheel.spring.is_some();
    let tests = tests::tests_of_axle(section, suspension, has_spring, steers, problems)?;
    let parts = AxleCompliance {
        wheels: [wheel, right],
        subframe: own,
        rack_rate,
        column,
        bar_rate: setup.bar_rate,
    };
    match AxleKcRun::new(axle.on_rig(tyre_rate), &parts) {
        Ok(run) => Some(Some(AxleComplianceStudy {
            figures: figures(&run, &tests),
            parts,
            link_names,
            tests,
            tyre_rate,
        })),
        Err(fault) => {
            let message = fault.describe();
            problems.refuse(section.span(), &message)
        }
    }
}

/// Refuses springs between the rockers.
fn refuse_springs_between_rockers(file: &File, problems: &mut Problems) -> Option<()> {
    let between = [
        (
            "[heave_spring]",
            file.heave_spring.as_ref().map(Spanned::span),
        ),
        ("[t_bar]", file.t_bar.as_ref().map(Spanned::span)),
        ("[heave_bar]", file.heave_bar.as_ref().map(Spanned::span)),
    ];
    for (name, span) in between {
        if let Some(span) = span {
            let message = format!(
                "{name} with [compliance] is not available: springs between the rockers need an axle without elastic parts"
            );
            return problems.refuse(span, &message);
        }
    }
    Some(())
}

/// Parts of the right wheel. They equal the parts of the left wheel, except for rates that the study gives separately. Parts
/// that exist only once are left out.
fn right_parts(
    file: &File,
    left: &WheelParts,
    suspension: &Suspension,
    directory: &Path,
    problems: &mut Problems,
) -> Option<WheelParts> {
    let mut right = left.clone();
    right.remove_singles(&suspension.mechanism);
    let Some(own) = right_wheel::own(file) else {
        return Some(right);
    };
    if !solid::refuse_single_rates(own, &suspension.mechanism, problems) {
        return None;
    }
    let unknown = |name: &Text, section: &str, problems: &mut Problems| {
        let name = (name.get_ref(), name.span());
        let message = format!(
            "[axle.right.{section}] gives rates for the right wheel, but {:?} is not a part of one wheel in [{section}]",
            name.0
        );
        problems.add(name.1, message);
    };
    let mut sound = true;
    for (name, rates) in &own.bushings {
        let mut written = file.bushings.iter();
        let written = written.find(|(known, _)| known.get_ref() == name.get_ref());
        let id = suspension.mechanism.point(name.get_ref());
        let part = right
            .bushings
            .iter_mut()
            .find(|part| Some(part.point) == id);
        let (Some((_, written)), Some(part)) = (written, part) else {
            unknown(name, "bushings", problems);
            sound = false;
            continue;
        };
        let given = rates.get_ref();
        let merged = file::Bushing {
            stiffness: given
                .stiffness
                .clone()
                .or(written.get_ref().stiffness.clone()),
            scale: given.scale.clone().or(written.get_ref().scale.clone()),
            ..written.get_ref().clone()
        };
        let merged = Spanned::new(rates.span(), merged);
        match bushing::bushing(name, &merged, suspension, directory, problems) {
            Some(found) => *part = found,
            None => sound = false,
        }
    }
    for (name, written) in &own.links {
        let part = right
            .links
            .iter_mut()
            .find(|(known, _)| known == name.get_ref());
        let Some(part) = part else {
            unknown(name, "links", problems);
            sound = false;
            continue;
        };
        match link::link(name, written, suspension, problems) {
            Some(found) => *part = found,
            None => sound = false,
        }
    }
    sound.then_some(right)
}

/// Results of the tests. A test that prescribes a motion has no range of loads (key `window`), so it has no secant.
fn figures(run: &AxleKcRun<'_>, tests: &[KcTest]) -> Vec<TestFigure> {
    let of_test = |test: &KcTest| {
        let kinds = if test.load.is_motion() {
            &[false][..]
        } else {
            &[false, true]
        };
        let quantities = run.quantities(test).into_iter();
        let figure = |(quantity, unit, of)| {
            kinds.iter().map(move |is_secant| TestFigure {
                test: *test,
                quantity,
                unit,
                of,
                is_secant: *is_secant,
                names_load: false,
            })
        };
        quantities.flat_map(figure).collect::<Vec<_>>()
    };
    let found: Vec<TestFigure> = tests.iter().flat_map(of_test).collect();
    let names: Vec<(String, TestLoad)> = found.iter().map(|f| (f.name(), f.test.load)).collect();
    let named = found.iter().zip(&names).map(|(figure, (name, load))| {
        let is_other = |(other, by): &(String, TestLoad)| other == name && by != load;
        TestFigure {
            names_load: names.iter().any(is_other),
            ..*figure
        }
    });
    let mut figures: Vec<TestFigure> = Vec::new();
    for figure in named {
        // Two tests that differ only in their range of loads (key `window`) are refused before. So names do not repeat.
        if !figures.iter().any(|known| known.name() == figure.name()) {
            figures.push(figure);
        }
    }
    figures
}

/// Refuses the stiffness of rack and column in a rigid study.
fn refuse_stiffness(file: &File, problems: &mut Problems) -> Option<()> {
    let steering = file.steering.as_ref().map(Spanned::get_ref);
    let rates = steering.map(|own| [&own.rack_stiffness, &own.column_stiffness]);
    match rates.into_iter().flatten().flatten().next() {
        None => Some(()),
        Some(rate) => {
            let message = "the stiffness of rack and column needs [compliance]";
            problems.refuse(rate.span.clone(), message)
        }
    }
}

/// Stiffness of the rack and of the steering column. `None` for a rigid part.
fn steering(
    file: &File,
    axle: &Axle,
    problems: &mut Problems,
) -> Option<(Option<f64>, Option<SteeringColumn>)> {
    let Some(steering) = file.steering.as_ref().map(Spanned::get_ref) else {
        return Some((None, None));
    };
    let rates = [&steering.rack_stiffness, &steering.column_stiffness];
    if let Some(rate) = rates.into_iter().flatten().next()
        && !axle.left.mechanism.has_rack()
    {
        let message = "this axle has no rack; leave rack_stiffness and column_stiffness out";
        return problems.refuse(rate.span.clone(), message);
    }
    let rack = match &steering.rack_stiffness {
        Some(rate) => Some(above_zero(rate, problems)?),
        None => None,
    };
    let Some(rate) = &steering.column_stiffness else {
        return Some((rack, None));
    };
    let Some(per_turn) = axle.setup.c_factor else {
        let message =
            "column_stiffness needs c_factor: the rack's displacement per turn of the pinion";
        return problems.refuse(rate.span.clone(), message);
    };
    let column = SteeringColumn {
        rate: above_zero(rate, problems)?,
        rack_per_angle: per_turn / TAU,
    };
    Some((rack, Some(column)))
}

/// Refuses motions of elastic axles except travels on level pads and displacements of the rack.
fn refuse_motion(place: Span<usize>, motion: &AxleMotion, problems: &mut Problems) -> Option<()> {
    let on_plane = matches!(motion.wheels, WheelMotion::Travels { on_plane: true, .. });
    let message = if motion.time.is_some() {
        "the key \"time\" needs an axle without elastic parts; with [compliance] expected heave, travel_left and travel_right, and rack"
    } else if matches!(motion.wheels, WheelMotion::Roll { .. }) {
        "the key \"roll\" needs an axle without elastic parts; with [compliance] use the test load = \"roll\" of kc"
    } else if on_plane {
        "ground = \"plane\" needs an axle without elastic parts; with [compliance] both wheels stand on level pads"
    } else {
        return Some(());
    };
    problems.refuse(place, message)
}
