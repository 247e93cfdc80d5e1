//! `[tolerance]`: tolerances of parts, and the limits (bands) that built vehicles must satisfy.

mod band;
mod jig;
mod solid;

use super::elastic_targets::{RateKeys, rate_keys};
use super::error::Problems;
use super::file;
use super::members::{axis, member};
use super::names::choose;
use super::outputs::hardpoint;
use super::resolve::{Context, each, some};
use super::suspension::{ABOVE_ZERO, above_zero};
use super::value::{MemberName, Text};
use super::{AxleStudy, Contributor, Drive, Law, Source, Tolerance};
use crate::ask::{Accepted, six_digits};
use crate::assembly::BuildParameter;
use crate::model::{Axis, PointId, Side, Suspension};
use crate::number::Each;
use band::band;
use jig::jig;
use std::ops::Range as Span;
use toml::Spanned;

/// Number of standard deviations of a normal distribution. A study must accept every value within this distance from the
/// nominal value. Builds with values that a study does not accept are rejected.
const LEAST_SIGMAS: f64 = 4.0;
/// Largest number of builds (vehicles with random deviations): hours of work for the fastest machine.
const MOST_BUILDS: i64 = 10_000_000_000;

/// Reads the tolerances. `None` if they have an error.
pub(super) fn tolerance(
    section: &Spanned<file::Tolerance>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Tolerance> {
    let place = section.span();
    let section = section.get_ref();
    let builds = whole(&section.builds, 10_000, 2..=MOST_BUILDS, problems);
    let seed = whole(&section.seed, 1, 0..=i64::from(u32::MAX), problems);
    let aligned = section.aligned.as_ref().is_some_and(|a| *a.get_ref());
    if let (true, None, Some(written)) = (aligned, &context.file.setup, &section.aligned) {
        let message = "aligned = true needs [setup] with adjust, to set toe and camber";
        problems.add(written.span(), message);
    }
    let is_whole = context.axle.is_some_and(|both| both.axle.is_rigid());
    if let (true, true, Some(written)) = (aligned, is_whole, &section.aligned) {
        let message = "aligned = true sets each wheel separately, but one body carries both \
                       wheels of this axle; expected aligned = false";
        problems.add(written.span(), message);
    }
    let of_axle = context.elastic_axle().map(|own| &own.parts.wheels[..]);
    let mut wheels = context
        .elastic
        .map(|own| std::slice::from_ref(&own.parts))
        .or(of_axle)
        .unwrap_or_default()
        .iter();
    if let (true, Some(written)) = (aligned, &section.aligned)
        && wheels.any(|parts| !parts.rests_in_design())
    {
        let message = "aligned = true sets toe and camber in the design position, where these elastic parts are not in \
                       balance: expected relaxed = \"at_design_load\" and no preload, or aligned = false";
        problems.add(written.span(), message);
    }
    if let Some(motion) = context.motion
        && motion.drive != Drive::Travel
    {
        let message = "[tolerance] needs a motion with drive = \"travel\": at the same arm angle, each build has a \
             different pose";
        problems.add(place, message);
    }
    let written = some(&section.scatter, "scatter", problems)?;
    let scatter = each(written, |s| match context.axle {
        None => {
            if let Some(side) = &s.get_ref().side {
                let message = "side needs [axle]; this study describes one wheel";
                problems.add(side.span(), message);
            }
            contributors(s, context.suspension, Some(context), problems)
        }
        Some(axle) => contributors_of_axle(s, axle, context.suspension, Some(context), problems),
    });
    if let Some(scatter) = &scatter {
        distinct_rates(written, scatter, problems);
    }
    let bands = section.bands.iter().flatten();
    let bands = each(bands, |b| band(b, context, problems));
    Some(Tolerance {
        builds: u64::try_from(builds?).ok()?,
        seed: u32::try_from(seed?).ok()?,
        aligned,
        scatter: scatter?.into_iter().flatten().collect(),
        bands: bands?,
    })
}

/// Refuses two entries of `scatter` for the same rate, because a build has one value of each rate.
fn distinct_rates(
    written: &[Spanned<file::Scatter>],
    scatter: &[Vec<Contributor>],
    problems: &mut Problems,
) {
    let rates = |own: &[Contributor]| -> Vec<_> {
        let sources = own.iter().flat_map(|one| &one.sources);
        let rate = |source: &Source| Some((source.rate?.parameter, source.side));
        sources.filter_map(rate).collect()
    };
    let rates: Vec<_> = scatter.iter().map(|own| rates(own)).collect();
    for (k, own) in rates.iter().enumerate() {
        let same = |other: &Vec<_>| other.iter().any(|rate| own.contains(rate));
        if let Some(first) = rates[..k].iter().position(same) {
            let message = format!(
                "{} already scatters: give one entry for each rate",
                scatter[k][0].name
            );
            let error = problems.add(written[k].span(), message);
            error.related(written[first].span(), "here");
        }
    }
}

fn whole(
    written: &Option<Spanned<i64>>,
    default: i64,
    within: std::ops::RangeInclusive<i64>,
    problems: &mut Problems,
) -> Option<i64> {
    let Some(written) = written else {
        return Some(default);
    };
    let value = *written.get_ref();
    if within.contains(&value) {
        return Some(value);
    }
    let (low, high) = (within.start(), within.end());
    let message = format!("expected a whole number from {low} to {high}, found {value}");
    problems.refuse(written.span(), message)
}

/// Tolerance sources of both wheels, or of the wheel of `side`, from an element of `scatter`. The parts of each wheel scatter
/// independently. Parts of the right wheel scatter as mirror images of the left parts. A part and its counterpart at the other
/// wheel form one contributor. A part that exists only once, or that both wheels share, scatters once.
pub(super) fn contributors_of_axle(
    written: &Spanned<file::Scatter>,
    study: &AxleStudy,
    suspension: &Suspension,
    context: Option<&Context>,
    problems: &mut Problems,
) -> Option<Vec<Contributor>> {
    let sides = Side::ALL.each(|side| (side.name(), side));
    let only = match &written.get_ref().side {
        None => None,
        Some(text) => {
            let Some(side) = choose(text, "side", &sides, problems) else {
                // Reads the other keys of the element anyway, so that their errors are reported.
                contributors(written, suspension, context, problems);
                return None;
            };
            Some(side)
        }
    };
    let elastic = study.axle.elastic.as_ref();
    let is_shared = |source: &Source| {
        let (rate, elastic) = (source.rate.as_ref(), elastic);
        rate.zip(elastic)
            .is_some_and(|(rate, own)| own.parts.is_shared(rate.parameter))
    };
    let mut found: Vec<Contributor> = Vec::new();
    for side in Side::ALL {
        if only.is_some_and(|only| only != side) {
            continue;
        }
        // Uses the axes of the left wheel. A part of the right wheel is the mirror image of the left part, so it has the
        // same tolerances in these axes.
        let of_side = Suspension {
            frame: suspension.frame,
            ..study.axle.suspension(side).clone()
        };
        let mut own = contributors(written, &of_side, context, problems)?;
        // A part that both wheels share has one random number.
        if own.iter().flat_map(|one| &one.sources).any(is_shared) {
            if let Some(text) = &written.get_ref().side {
                let message = "both wheels share this part: remove the key \"side\"";
                return problems.refuse(text.span(), message);
            }
            return Some(own);
        }
        for contributor in &mut own {
            if solid::is_single(contributor, &of_side, written.span(), problems)? {
                if let Some(text) = &written.get_ref().side {
                    let name = &contributor.name;
                    let message = format!("the axle has only one {name}: remove the key \"side\"");
                    return problems.refuse(text.span(), message);
                }
                solid::scatter_once(contributor, side);
            } else {
                for source in &mut contributor.sources {
                    source.name = format!("{} {}", side.name(), source.name);
                    source.side = Some(side);
                }
                if only.is_some() {
                    contributor.name = format!("{} {}", side.name(), contributor.name);
                }
            }
            solid::note_other_view(contributor, &of_side);
        }
        if found.is_empty() {
            found = own
        } else {
            for (both, right) in found.iter_mut().zip(own) {
                both.sources.extend(right.sources);
            }
        }
    }
    Some(found)
}

/// Contributors from an entry of `scatter`: one for each named hardpoint, or one for a length, a jig or a rate.
fn contributors(
    written: &Spanned<file::Scatter>,
    suspension: &Suspension,
    context: Option<&Context>,
    problems: &mut Problems,
) -> Option<Vec<Contributor>> {
    let place = written.span();
    let written = written.get_ref();
    let named = rate_keys!(
        written,
        place.clone(),
        [hardpoint, hardpoints, length, jig, axis],
        [shift, turn]
    );
    if named.is_given(problems)? {
        let Some(context) = context else {
            return problems.refuse(place, "the axles of a car have no elastic parts");
        };
        return rate(written, &named, context, problems).map(|rate| vec![rate]);
    }
    let kinds = [
        written.hardpoint.is_some(),
        written.hardpoints.is_some(),
        written.length.is_some(),
        written.jig.is_some(),
    ];
    if kinds.iter().filter(|given| **given).count() != 1 {
        let message = "expected one of the keys \"hardpoint\", \"hardpoints\", \"length\", \"jig\", \"bushing\", \"link\" and \"rate\"";
        return problems.refuse(place, message);
    }
    if let Some(points) = &written.jig {
        return jig(points, written, place.clone(), suspension, problems).map(|jig| vec![jig]);
    }
    for (given, key) in [(&written.shift, "shift"), (&written.turn, "turn")] {
        if let Some(number) = given {
            problems.add(
                number.span.clone(),
                format!("the key {key} needs the key \"jig\""),
            );
        }
    }
    let law = law(written, place.clone(), problems);
    match &written.length {
        Some(of) => length(of, written, law, suspension, problems).map(|own| vec![own]),
        None => hardpoints(written, place, law, suspension, problems),
    }
}

/// Scatter of the length of a member.
fn length(
    of: &Spanned<MemberName>,
    written: &file::Scatter,
    law: Option<Law>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Contributor> {
    if let Some(axis) = &written.axis {
        problems.add(
            axis.span(),
            "a length has no axis: it changes along the member",
        );
    }
    let (name, member) = member(of, suspension, problems)?;
    if let (Some(limits), Some(Law::Uniform { low, .. })) = (&written.limits, law)
        && let Some((one, other)) = member.ends(&suspension.mechanism)
        && let drawn = (suspension.design[one.0] - suspension.design[other.0]).norm()
        && drawn + low <= 0.0
    {
        let unit = suspension.length_unit.symbol();
        let message = format!(
            "the lowest limit makes the length 0 or negative: {name} is {drawn:.1} {unit} long in \
             the design"
        );
        problems.add(limits.span(), message);
    }
    let name = format!("{name} length");
    Some(Contributor {
        sources: vec![Source::of_parts(
            name.clone(),
            vec![(BuildParameter::Length(member), 1.0)],
            law?,
        )],
        name,
    })
}

/// Scatter of hardpoints, one contributor for each hardpoint.
fn hardpoints(
    written: &file::Scatter,
    place: Span<usize>,
    law: Option<Law>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<Contributor>> {
    let names = written.hardpoints.iter().flat_map(|list| list.get_ref());
    let names: Vec<&Text> = written.hardpoint.iter().chain(names).collect();
    if names.is_empty() {
        return problems.refuse(
            place,
            "expected at least one hardpoint, found an empty list",
        );
    }
    let along = match &written.axis {
        None => Some(Axis::ALL.to_vec()),
        Some(text) => axis(text, problems).map(|axis| vec![axis]),
    };
    let points = each(&names, |name| hardpoint(name, suspension, problems));
    let (law, along) = (law?, along?);
    let contributor = |(name, id): (&Text, PointId)| {
        let source = |axis: &Axis| {
            let name = format!("{} {}", name.get_ref(), axis.name());
            let sign = suspension.frame.sign(*axis);
            let changes = vec![(BuildParameter::Coordinate(id, *axis), sign)];
            Source::of_parts(name, changes, law)
        };
        Contributor {
            name: match along.as_slice() {
                [only] => format!("{} {}", name.get_ref(), only.name()),
                _ => name.get_ref().clone(),
            },
            sources: along.iter().map(source).collect(),
        }
    };
    Some(names.into_iter().zip(points?).map(contributor).collect())
}

/// Scatter of the rate of an elastic part.
fn rate(
    written: &file::Scatter,
    named: &RateKeys<'_>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Contributor> {
    let (part, rate) = named.read(context, problems)?;
    let law = law(written, named.place.clone(), problems)?;
    let remedy = if rate.is_relative {
        "a smaller sigma"
    } else {
        "a smaller sigma, or relative = true"
    };
    let value = |deviation| rate.scattered(deviation)[0];
    if let Some(message) = unacceptable(law, value, ABOVE_ZERO, ["rate", remedy]) {
        return problems.refuse(named.place.clone(), &message);
    }
    let name = match rate.axis_name() {
        Some(axis) => format!("{part} stiffness {axis}"),
        None => format!("{part} {}", rate.kind()),
    };
    Some(Contributor {
        sources: vec![Source {
            rate: Some(rate),
            ..Source::of_parts(name.clone(), Vec::new(), law)
        }],
        name,
    })
}

/// Returns a message if a scattering value can leave the range that a study accepts. A normal distribution must stay in this
/// range up to [`LEAST_SIGMAS`] standard deviations. `value` returns the value at a deviation. `words` has a noun for the
/// value and the remedy for a normal distribution.
pub(super) fn unacceptable(
    law: Law,
    value: impl Fn(f64) -> f64,
    accepted: Accepted,
    [noun, remedy]: [&str; 2],
) -> Option<String> {
    let [low, high] = match law {
        Law::Normal { sigma } => [-LEAST_SIGMAS * sigma, LEAST_SIGMAS * sigma],
        Law::Uniform { low, high } => [low, high],
    };
    let ends = [(low, ["below", "lowest"]), (high, ["above", "highest"])];
    ends.into_iter().find_map(|(deviation, [way, end])| {
        let found = value(deviation);
        if accepted.contains(found) {
            return None;
        }
        let found = six_digits(found);
        Some(match law {
            Law::Normal { .. } => format!(
                "at {LEAST_SIGMAS} standard deviations {way} nominal the {noun} is {found}: expected {remedy}"
            ),
            Law::Uniform { .. } => {
                format!("the {end} limit makes the {noun} {found}: expected a {noun} {accepted}")
            }
        })
    })
}

/// Distribution of a scatter: normal with `sigma`, uniform with `limits`.
fn law(written: &file::Scatter, place: Span<usize>, problems: &mut Problems) -> Option<Law> {
    match (&written.sigma, &written.limits) {
        (Some(sigma), None) => Some(Law::Normal {
            sigma: above_zero(sigma, problems)?,
        }),
        (None, Some(limits)) => match limits.get_ref().as_slice() {
            [low, high] if low.value < high.value => Some(Law::Uniform {
                low: low.value,
                high: high.value,
            }),
            _ => {
                let message = "expected limits = [lowest, highest], the first below the second";
                problems.refuse(limits.span(), message)
            }
        },
        (Some(_), Some(limits)) => {
            let message = "expected sigma (normal scatter) or limits (uniform scatter), found both";
            problems.refuse(limits.span(), message)
        }
        (None, None) => {
            let message =
                "expected sigma = 0.2 (normal scatter) or limits = [-0.5, 0.5] (uniform scatter)";
            problems.refuse(place, message)
        }
    }
}
