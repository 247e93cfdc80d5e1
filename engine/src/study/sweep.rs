//! `[sweep]`: designs to be computed.

mod sampled;

use super::elastic_targets::{RateKeys, rate_keys};
use super::error::Problems;
use super::file::{self, File};
use super::motion::within;
use super::moves;
use super::names::{choose, choose_or};
use super::resolve::{Context, each, some};
use super::suspension::ABOVE_ZERO;
use super::value::{Text, Whole};
use super::{Designs, Drive, FileFormat, Formulation, Sampled, Sampling, Sweep, SweepVariable};
use crate::model::{Axis, PointId, Suspension};
use std::collections::HashMap;
use std::ops::Range as Span;
use toml::Spanned;

/// Largest number of designs in a sweep: years of work for the fastest machine.
pub const MOST_DESIGNS: u64 = 1_000_000_000_000;

/// Largest number of variables with Saltelli sampling. All designs of one pair of samples must fit into a block, the group
/// of designs that the sweep evaluates together.
pub(crate) const MOST_EXCHANGED: usize = crate::evaluate::BLOCK - 2;

/// Reads the sweep. `None` if it has an error.
pub(super) fn sweep(
    file: &File,
    section: &Spanned<file::Sweep>,
    formulation: Option<Formulation>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Sweep> {
    let written = section.get_ref();
    check_solver(file, section, formulation, context, problems);
    let designs = match (&written.designs, &written.variables) {
        (Some(path), None) => {
            refuse_sampling(written, path, problems);
            if path.get_ref().trim().is_empty() {
                problems.add(path.span(), "expected the name of a file, found none");
            }
            Some(Designs::File(context.directory.join(path.get_ref())))
        }
        (None, Some(variables)) => {
            sampled(section, variables, context, problems).map(Designs::Sampled)
        }
        (Some(path), Some(variables)) => {
            let message = "expected the key variables or the key designs (a file), found both";
            let error = problems.add(variables.span(), message);
            error.related(path.span(), "the file");
            None
        }
        (None, None) => {
            let message = "expected the key variables = [...], or designs = \"designs.csv\"";
            problems.refuse(section.span(), message)
        }
    };
    Some(Sweep {
        designs: designs?,
        curves: written.curves.unwrap_or(false),
        format: format(&written.format, problems)?,
        constraints: written.constraints.unwrap_or(true),
    })
}

/// Refuses keys for the sampling of variables, because the designs come from a file.
fn refuse_sampling(written: &file::Sweep, path: &Text, problems: &mut Problems) {
    let keys = [
        ("method", written.method.as_ref().map(Spanned::span)),
        ("samples", written.samples.as_ref().map(Spanned::span)),
        ("seed", written.seed.as_ref().map(Spanned::span)),
    ];
    for (key, place) in keys {
        if let Some(place) = place {
            let message =
                format!("the designs come from a file, so the key \"{key}\" is not available");
            let error = problems.add(place, message);
            error.related(path.span(), "the file");
        }
    }
}

/// Checks that the sweep uses the formulation [`Formulation::KnucklePose`], and a drive with the same meaning for every
/// design.
fn check_solver(
    file: &File,
    section: &Spanned<file::Sweep>,
    formulation: Option<Formulation>,
    context: &Context,
    problems: &mut Problems,
) {
    let by_theta = context.motion.map(|m| m.drive) == Some(Drive::PaperTheta);
    let (text, message, help) = if formulation == Some(Formulation::PointCoordinates) {
        (
            &file.solver.formulation,
            "[sweep] needs formulation = \"knuckle_pose\", which gives the same values faster",
            "remove [solver]: the program then uses \"knuckle_pose\"",
        )
    } else if by_theta {
        (
            &file.motion.get_ref().drive,
            "the meaning of the angle of drive = \"paper_theta\" depends on the hardpoints, which \
             [sweep] moves",
            "drive = \"arm_angle\" has the same meaning for every design",
        )
    } else {
        return;
    };
    let place = text.as_ref().map_or(section.span(), Text::span);
    problems.add(place, message).help(help);
}

/// File format of a sweep's results.
pub(super) fn format(written: &Option<Text>, problems: &mut Problems) -> Option<FileFormat> {
    let Some(text) = written else {
        return Some(FileFormat::Csv);
    };
    let formats = FileFormat::ALL.map(|format| (format.name(), format));
    let format = choose(text, "format", &formats, problems)?;
    if format == FileFormat::Parquet && !cfg!(feature = "parquet") {
        let message = "this program was built without Parquet";
        let error = problems.add(text.span(), message);
        error.help("cargo build --release --features parquet");
        return None;
    }
    Some(format)
}

fn sampled(
    section: &Spanned<file::Sweep>,
    variables: &Spanned<Vec<Spanned<file::SweepVariable>>>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Sampled> {
    let written = section.get_ref();
    let asked = SamplingKeys {
        section: section.span(),
        variables: variables.span(),
        method: &written.method,
        samples: &written.samples,
        seed: &written.seed,
        has_steps: variables
            .get_ref()
            .iter()
            .any(|v| v.get_ref().steps.is_some()),
    };
    let rules = asked.rules(problems);
    let listed = some(variables, "variable", problems)?;
    let resolved = each(listed, |v| variable(v, context, problems))?;
    distinct(listed, &resolved, context.suspension, problems);
    let places: Vec<_> = listed.iter().map(Spanned::span).collect();
    asked.sampled(rules, resolved, &places, problems)
}

/// Keys for the sampling of a sweep's variables.
pub(super) struct SamplingKeys<'a> {
    /// Position of the section in the file.
    pub section: Span<usize>,
    /// Position of the variables in the file.
    pub variables: Span<usize>,
    /// Name of the sampling method.
    pub method: &'a Option<Text>,
    /// Number of samples.
    pub samples: &'a Option<Whole>,
    /// Seed of the samples.
    pub seed: &'a Option<Whole>,
    /// True if a variable has `steps`.
    pub has_steps: bool,
}

/// Method and seed. A value with an error is `None`.
pub(super) type Rules = (Option<Sampling>, Option<i64>);

impl SamplingKeys<'_> {
    /// Reads method and seed before the variables, so that errors in all of them are reported. The default method is Sobol
    /// sampling if the study gives `samples` without `steps`, and otherwise a grid.
    pub(super) fn rules(&self, problems: &mut Problems) -> Rules {
        let default = if self.samples.is_some() && !self.has_steps {
            Sampling::Sobol
        } else {
            Sampling::Grid
        };
        let method = choose_or(self.method, default, "method", &Sampling::ALL, problems);
        let seed = match self.seed {
            None => Some(1),
            Some(seed) => within(seed, 0..=i64::from(u32::MAX), problems),
        };
        (method, seed)
    }

    /// Reads the samples of variables. `places` are their positions in the file.
    pub(super) fn sampled(
        &self,
        (method, seed): Rules,
        variables: Vec<SweepVariable>,
        places: &[Span<usize>],
        problems: &mut Problems,
    ) -> Option<Sampled> {
        let method = method?;
        if method == Sampling::Saltelli && variables.len() > MOST_EXCHANGED {
            let message = format!(
                "method = \"saltelli\" accepts at most {MOST_EXCHANGED} variables, found {}",
                variables.len()
            );
            return problems.refuse(self.variables.clone(), message);
        }
        if let (Sampling::Grid, Some(samples)) = (method, self.samples) {
            let message = "the key \"samples\" is not available for a grid: the steps of the variables give its designs";
            let error = problems.add(samples.span(), message);
            error.help("remove the key \"samples\", or choose another method, such as \"sobol\"");
            grid_points(&self.variables, places, &variables, problems);
            return None;
        }
        let samples = match method {
            Sampling::Grid => grid_points(&self.variables, places, &variables, problems)?,
            _ => {
                let Some(samples) = self.samples else {
                    let message = format!(
                        "method = \"{}\" needs the key \"samples\", a number",
                        method.name()
                    );
                    return problems.refuse(self.section.clone(), message);
                };
                // For Saltelli sampling, the product samples times (variables + 2) must also be within the limit. The other
                // methods have the same limit.
                let most = MOST_DESIGNS / (variables.len() as u64 + 2);
                within(samples, 1..=most as i64, problems)? as u64
            }
        };
        Some(Sampled {
            method,
            samples,
            seed: u32::try_from(seed?).ok()?,
            variables,
        })
    }
}

fn grid_points(
    list: &Span<usize>,
    places: &[Span<usize>],
    variables: &[SweepVariable],
    problems: &mut Problems,
) -> Option<u64> {
    for (place, variable) in places.iter().zip(variables) {
        if variable.steps.is_none() {
            let message = format!(
                "{} needs the key \"steps\": the number of its values in the grid",
                variable.name
            );
            let error = problems.add(place.clone(), message);
            error.help("or give the number of designs instead: samples = 1000 in [sweep]");
            return None;
        }
    }
    let steps: Vec<u64> = variables.iter().filter_map(|v| v.steps).collect();
    let mut factors = steps.iter();
    let points = factors.try_fold(1_u64, |product, steps| product.checked_mul(*steps));
    let points = points.filter(|points| *points <= MOST_DESIGNS);
    if points.is_none() {
        let factors: Vec<String> = steps.iter().map(u64::to_string).collect();
        let message = format!(
            "a grid of {} designs is too large: expected at most {:.0e}",
            factors.join(" x "),
            MOST_DESIGNS as f64
        );
        problems.add(list.clone(), message);
    }
    points
}

fn variable(
    place: &Spanned<file::SweepVariable>,
    context: &Context,
    problems: &mut Problems,
) -> Option<SweepVariable> {
    let (written, suspension) = (place.get_ref(), context.suspension);
    let named = rate_keys!(
        written,
        place.span(),
        [hardpoint, hardpoints, factors, axis, absolute],
        []
    );
    if named.is_given(problems)? {
        return rate(written, &named, context, problems);
    }
    let Some(axis) = &written.axis else {
        return problems.refuse(place.span(), "the key \"axis\" is missing");
    };
    let moved = moves::Written {
        place: place.span(),
        hardpoint: &written.hardpoint,
        hardpoints: &written.hardpoints,
        factors: &written.factors,
        axis: Some(axis),
        direction: None,
    };
    let moves = moves::moves(&moved, suspension, problems);
    let absolute = written.absolute.as_ref().filter(|a| *a.get_ref());
    if let (Some(absolute), Some(list)) = (absolute, &written.hardpoints) {
        let message = "hardpoints that move together have offsets, not coordinates: remove the key \"absolute\"";
        let error = problems.add(absolute.span(), message);
        error.related(list.span(), "these");
        return None;
    }
    let range = moves::range(&written.range, "numbers", problems);
    let steps = match &written.steps {
        None => Some(None),
        Some(steps) => self::steps(steps, range, problems).map(Some),
    };
    let moves = moves?;
    let name = match &written.name {
        Some(name) => plain(name, problems)?,
        None => {
            let names = moves::names(&moves, suspension);
            column_stem(&names, moves[0].axis, absolute.is_some())
        }
    };
    Some(SweepVariable {
        name,
        moves,
        rate: None,
        absolute: absolute.is_some(),
        range: range?,
        steps: steps?,
    })
}

/// Reads a variable that is the rate of an elastic part.
fn rate(
    written: &file::SweepVariable,
    named: &RateKeys<'_>,
    context: &Context,
    problems: &mut Problems,
) -> Option<SweepVariable> {
    let (part, rate) = named.read(context, problems)?;
    let what = if rate.is_relative { "factors" } else { "rates" };
    let range = moves::accepted_range(&written.range, what, ABOVE_ZERO, problems)?;
    let steps = match &written.steps {
        None => None,
        Some(steps) => Some(self::steps(steps, Some(range), problems)?),
    };
    let name = match (&written.name, rate.axis_name()) {
        (Some(name), _) => plain(name, problems)?,
        (None, Some(axis)) => format!("{part}_stiffness_{axis}"),
        (None, None) => format!("{part}_{}", rate.kind()),
    };
    Some(SweepVariable {
        name,
        moves: Vec::new(),
        rate: Some(rate),
        absolute: false,
        range,
        steps,
    })
}

/// Column name without unit: `tie_rod_inner_dz` for an offset, `tie_rod_inner_z` for a coordinate.
pub(super) fn column_stem(point: &str, axis: Axis, absolute: bool) -> String {
    let kind = if absolute { "" } else { "d" };
    format!("{point}_{kind}{}", axis.name())
}

/// Reads the number of values in a grid.
pub(super) fn steps(
    steps: &Whole,
    range: Option<[f64; 2]>,
    problems: &mut Problems,
) -> Option<u64> {
    let count = within(steps, 1..=MOST_DESIGNS as i64, problems)?;
    if let (1, Some([low, high])) = (count, range) {
        let message = format!("one step cannot reach from {low} to {high}");
        let error = problems.add(steps.span(), message);
        error.help("steps is the number of values, both ends included");
        return None;
    }
    Some(count as u64)
}

/// Reads a name that may be part of a column name.
pub(super) fn plain(name: &Text, problems: &mut Problems) -> Option<String> {
    let text = name.get_ref();
    let allowed = |c: char| c.is_ascii_alphanumeric() || "_+-".contains(c);
    if text.is_empty() || !text.chars().all(allowed) {
        let message = format!("expected a name of letters, digits and underscores, found {text:?}");
        return problems.refuse(name.span(), message);
    }
    Some(text.clone())
}

/// Refuses two variables with the same name, or of the same rate. Also refuses a coordinate that one variable sets and another
/// variable moves. Offsets of several variables are added.
fn distinct(
    written: &[Spanned<file::SweepVariable>],
    variables: &[SweepVariable],
    suspension: &Suspension,
    problems: &mut Problems,
) {
    let mut names: HashMap<&str, usize> = HashMap::new();
    let mut coordinates: HashMap<(PointId, Axis), usize> = HashMap::new();
    for (i, variable) in variables.iter().enumerate() {
        let mut refuse = |message: String, first: usize| {
            let error = problems.add(written[i].span(), message);
            error.related(written[first].span(), "here");
        };
        if let Some(first) = names.insert(&variable.name, i) {
            refuse(format!("{} is already a variable", variable.name), first);
            continue;
        }
        let of_rate = |own: &SweepVariable| own.rate.is_some() && own.changes_same(variable);
        if let Some(first) = variables[..i].iter().position(of_rate) {
            let message = format!(
                "{} already varies this rate: remove one of them",
                variables[first].name
            );
            refuse(message, first);
        }
        for m in &variable.moves {
            if let Some(first) = coordinates.insert((m.point, m.axis), i)
                && (variable.absolute || variables[first].absolute)
            {
                let message = format!(
                    "one variable sets {} of {}, and another variable moves it: remove one of them",
                    m.axis.name(),
                    suspension.mechanism.name(m.point)
                );
                refuse(message, first);
            }
        }
    }
}
