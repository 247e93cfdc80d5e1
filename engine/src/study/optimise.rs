//! `[optimise]`: design variables and their moves, settings, builds of a robust tuning, and goals of a trade-off.

use super::constraints::constraints;
use super::elastic_targets::{self, RateKeys, rate_keys};
use super::error::Problems;
use super::file;
use super::motion::within;
use super::moves;
use super::names::choose;
use super::outputs::hardpoint;
use super::resolve::{Context, each, some};
use super::suspension::above_zero;
use super::targets::{FromFile, targets};
use super::value::{Text, Whole};
use super::{
    Drive, FrontGoal, Motion, Move, Optimise, RobustAim, Scatter, Setup, Target, Tolerance, Turn,
    Variable,
};
use crate::model::{Axis, PointId, Suspension};
use toml::Spanned;

/// Reads the optimisation. `None` if it has an error. Also returns targets that come from files, each with the index of the
/// target as written.
pub(super) fn optimise(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<(Optimise, Vec<(usize, FromFile)>)> {
    if let Some(method) = &section.method {
        choose(method, "method", &[("levenberg_marquardt", ())], problems);
    }
    let mut whole = |number: &Option<Whole>, default, bounds| match number {
        None => Some(default),
        Some(number) => within(number, bounds, problems),
    };
    let starts = whole(&section.starts, 1, 1..=1_000_000);
    let seed = whole(&section.seed, 1, 0..=i64::from(u32::MAX));
    let max_iterations = whole(
        &section.max_iterations,
        i64::from(MAX_ITERATIONS),
        1..=i64::MAX,
    );
    let variables = variables(section, context, problems);
    let good_enough = match &section.good_enough {
        None => Some(None),
        Some(number) if number.value >= 0.0 => Some(Some(number.value)),
        Some(number) => {
            let message = format!("expected a misfit of 0 or more, found {}", number.value);
            problems.refuse(number.span.clone(), message)
        }
    };
    let fit = section.fit.as_ref().is_some_and(|fit| *fit.get_ref());
    if let (true, Some(number)) = (fit, &section.good_enough)
        && number.value != 0.0
    {
        let message =
            "fit = true minimises the misfit: expected good_enough = 0, or no good_enough";
        problems.add(number.span.clone(), message);
    }
    let constraints = constraints(section, context, problems);
    let targets = targets(section, context, problems);
    let (targets, files) = targets?;
    let front = front(section, &targets, context, problems);
    let optimise = Optimise {
        starts: usize::try_from(starts?).ok()?,
        seed: u32::try_from(seed?).ok()?,
        max_iterations: u64::try_from(max_iterations?).ok()?,
        variables: variables?,
        targets,
        constraints: constraints?,
        good_enough: good_enough?.unwrap_or(if fit { 0.0 } else { GOOD_ENOUGH }),
        fit,
        front: front?,
        // The builds of a robust tuning are added later, when the section with the tolerances has been read ([`scatter`]).
        scatter: None,
        side_effects: section
            .side_effects
            .as_ref()
            .is_none_or(|said| *said.get_ref()),
    };
    Some((optimise, files))
}

/// Largest number of builds in a robust tuning.
const MOST_BUILDS: i64 = 4096;

/// Reads the builds of a robust tuning.
pub(super) fn scatter(
    section: &file::Optimise,
    tolerance: Option<&Tolerance>,
    setup: Option<&Setup>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Option<Scatter>> {
    let aim = section.robust.as_ref().map(|robust| {
        let aims = [("misfit", false), ("yield", true)];
        (robust, choose(robust, "robust", &aims, problems))
    });
    let Some(written) = &section.scatter else {
        if let Some((robust, _)) = aim {
            let message = "the key \"robust\" needs the key \"scatter\": the number of builds, as in scatter = 256";
            problems.add(robust.span(), message);
        }
        return Some(None);
    };
    let builds = within(written, 2..=MOST_BUILDS, problems);
    if let Some(reason) = no_builds(section, context) {
        return problems.refuse(written.span(), reason);
    }
    let tolerance = tolerance?;
    let seeks_yield = match aim {
        Some((_, chosen)) => chosen?,
        None => false,
    };
    let travels = |motion: &Motion| motion.drive == Drive::Travel;
    let motions = context.motions.iter().map(|(_, motion)| motion);
    if !motions.chain(context.motion).all(travels) {
        let message = "the key \"scatter\" needs motions with drive = \"travel\": at the same arm angle, each build has a different pose";
        return problems.refuse(written.span(), message);
    }
    if let (true, Some(robust)) = (seeks_yield, &section.robust)
        && let Some(reason) = no_yield(section, tolerance)
    {
        return problems.refuse(robust.span(), reason);
    }
    Some(Some(Scatter {
        builds: usize::try_from(builds?).ok()?,
        seed: tolerance.seed,
        contributors: tolerance.scatter.clone(),
        adjust: match (tolerance.aligned, setup) {
            (true, Some(setup)) => Some(setup.adjust.clone()),
            _ => None,
        },
        aim: if seeks_yield {
            RobustAim::Yield(tolerance.bands.clone())
        } else {
            RobustAim::Misfit
        },
    }))
}

/// Reason why a tuning of this study cannot evaluate builds. `None` if it can.
fn no_builds(section: &file::Optimise, context: &Context) -> Option<&'static str> {
    if section.fit.as_ref().is_some_and(|fit| *fit.get_ref()) {
        Some(
            "the key \"scatter\" does not work with fit = true, because measurements come from one car",
        )
    } else if context.file.tolerance.is_none() {
        Some("the key \"scatter\" needs [tolerance] for the scatter of the builds")
    } else if context.suspension.mechanism.has_extra_links() {
        Some(
            "the key \"scatter\" is not available yet for an axle on five links, because its builds have tensions in the links; `hardpoint tolerance` supports such axles",
        )
    } else {
        None
    }
}

/// Reason why a tuning cannot maximise the share of builds within all bands. `None` if it can.
fn no_yield(section: &file::Optimise, tolerance: &Tolerance) -> Option<&'static str> {
    if tolerance.bands.is_empty() {
        Some(
            "robust = \"yield\" needs bands in [tolerance]: a build counts if it is within \
             all of them",
        )
    } else if section.front.is_some() {
        Some(
            "robust = \"yield\" does not work with the key \"front\", because a tuning for yield does not use the targets",
        )
    } else {
        None
    }
}

/// Reads the goals for the trade-off curve.
fn front(
    section: &file::Optimise,
    targets: &[Target],
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<FrontGoal>> {
    let Some(written) = &section.front else {
        return Some(Vec::new());
    };
    let names = written.get_ref();
    if !(2..=3).contains(&names.len()) {
        let message = format!("expected two or three targets, found {}", names.len());
        return problems.refuse(written.span(), message);
    }
    if section.fit.as_ref().is_some_and(|fit| *fit.get_ref()) {
        let message = "the key \"front\" does not work with fit = true, because there is no trade-off between \
                       measurements";
        return problems.refuse(written.span(), message);
    }
    let length = context.suspension.length_unit;
    let known: Vec<String> = targets.iter().map(|t| t.name(length)).collect();
    let mut options: Vec<(&str, ())> = known.iter().map(|name| (name.as_str(), ())).collect();
    options.sort_unstable();
    options.dedup();
    let mut goals: Vec<FrontGoal> = Vec::new();
    for text in names {
        let name = text.get_ref();
        choose(text, "target", &options, problems)?;
        if goals.iter().any(|goal| goal.name == *name) {
            return problems.refuse(text.span(), format!("{name:?} is listed twice"));
        }
        let numbers = (0..known.len()).filter(|number| known[*number] == *name);
        goals.push(FrontGoal {
            name: name.clone(),
            targets: numbers.collect(),
        });
    }
    Some(goals)
}

/// Default for `good_enough`. Below this misfit, the root mean square of the deviations is less than a tenth of their
/// tolerances, so differences between designs are not visible.
pub(crate) const GOOD_ENOUGH: f64 = 0.1;
/// Default limit of the iterations of one start.
pub(crate) const MAX_ITERATIONS: u32 = 200;
/// Largest rotation of a body in degrees. For smaller angles, the series of the rotation is exact to all digits.
const LARGEST_TURN: f64 = 15.0;

fn variables(
    section: &file::Optimise,
    context: &Context,
    problems: &mut Problems,
) -> Option<Vec<Variable>> {
    let suspension = context.suspension;
    let written = some(&section.variables, "variable", problems)?;
    let entries = written.iter().enumerate();
    let resolved: Vec<(usize, Option<Variable>)> = entries
        .flat_map(|(entry, v)| {
            let own = match &v.get_ref().rigid {
                Some(points) => rigid(v, points, suspension, problems),
                None => vec![variable(v, context, problems)],
            };
            own.into_iter().map(move |variable| (entry, variable))
        })
        .collect();
    distinct(written, &resolved, problems);
    resolved.into_iter().map(|(_, variable)| variable).collect()
}

/// Refuses two variables with the same move, the same rotation or the same rate. `resolved` has the variables, each with the
/// index of its entry in `written`.
fn distinct(
    written: &[Spanned<file::Variable>],
    resolved: &[(usize, Option<Variable>)],
    problems: &mut Problems,
) {
    let place = |entry: usize| {
        let points = &written[entry].get_ref().hardpoint;
        points.as_ref().map_or(written[entry].span(), Spanned::span)
    };
    let resolved = resolved.iter();
    let resolved: Vec<_> = resolved
        .filter_map(|(entry, variable)| Some((*entry, variable.as_ref()?)))
        .collect();
    let mut refused = None;
    for (k, (entry, variable)) in resolved.iter().enumerate() {
        // Two variables with different directions have the same name, so they are refused, like equal rotations and rates.
        // Variables along one axis are refused only if they move the same coordinates by the same factors.
        let same = |(_, other): &&(usize, &Variable)| {
            let is_named = other.label() == variable.label();
            is_named && (variable.axis().is_none() || other.moves == variable.moves)
        };
        // The variables of a rigid body have one entry, which is reported once.
        if let Some((first, _)) = resolved[..k].iter().find(same)
            && refused != Some(entry)
        {
            refused = Some(entry);
            let message = format!(
                "{} of {} is already a variable",
                variable.way(),
                variable.name
            );
            let error = problems.add(place(*entry), message);
            error.related(place(*first), "here");
        }
    }
}

fn variable(
    variable: &Spanned<file::Variable>,
    context: &Context,
    problems: &mut Problems,
) -> Option<Variable> {
    let suspension = context.suspension;
    let written = variable.get_ref();
    let named = rate_keys!(
        written,
        variable.span(),
        [hardpoint, hardpoints, rigid, axis, direction, factors],
        [shift, turn]
    );
    if named.is_given(problems)? {
        let cost = cost(written, problems);
        return elastic_targets::rate(variable, &named, context, cost, problems);
    }
    let missing = |key: &str, problems: &mut Problems| {
        problems.add(variable.span(), format!("the key \"{key}\" is missing"));
    };
    for (key, given) in [("shift", &written.shift), ("turn", &written.turn)] {
        if let Some(given) = given {
            let message = format!("{key} needs rigid, a list of points that move as one body");
            problems.add(given.span.clone(), message);
        }
    }
    let no_way = written.axis.is_none() && written.direction.is_none();
    if no_way {
        missing("axis", problems);
    }
    let Some(range) = &written.range else {
        missing("range", problems);
        return None;
    };
    if no_way {
        return None;
    }
    let moved = moves::Written {
        place: variable.span(),
        hardpoint: &written.hardpoint,
        hardpoints: &written.hardpoints,
        factors: &written.factors,
        axis: written.axis.as_ref(),
        direction: written.direction.as_ref(),
    };
    let moves = moves::moves(&moved, suspension, problems);
    let cost = cost(written, problems);
    let [low, high] = moves::range(range, "offsets", problems)?;
    if low > 0.0 || high < 0.0 {
        let message =
            format!("offsets from {low} to {high} do not include the design, which is offset 0");
        return problems.refuse(range.span(), message);
    }
    let moves = moves?;
    Some(Variable {
        name: moves::names(&moves, suspension),
        moves,
        turn: None,
        rate: None,
        range: [low, high],
        cost: cost?,
    })
}

fn cost(written: &file::Variable, problems: &mut Problems) -> Option<f64> {
    match &written.cost {
        None => Some(1.0),
        Some(cost) => above_zero(cost, problems),
    }
}

/// Variables of a rigid body: all three displacements and three rotations, or only those that the study requests.
fn rigid(
    variable: &Spanned<file::Variable>,
    points: &Spanned<Vec<Text>>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Vec<Option<Variable>> {
    let written = variable.get_ref();
    let is_alone = refuse_beside_rigid(written, problems);
    let ids = points_of_body(points, suspension, problems);
    let shift = written
        .shift
        .as_ref()
        .map(|number| above_zero(number, problems));
    let turn = written.turn.as_ref().map(|number| {
        let turn = above_zero(number, problems)?;
        if turn > LARGEST_TURN {
            let message = format!("expected at most {LARGEST_TURN} degrees, found {turn}");
            return problems.refuse(number.span.clone(), message);
        }
        Some(turn)
    });
    let cost = cost(written, problems);
    if shift.is_none() && turn.is_none() {
        let message = "expected \"shift\", \"turn\" or both: the largest movement of the body in both directions";
        problems.add(variable.span(), message);
        return vec![None];
    }
    let (Some(ids), Some(cost), true) = (ids, cost, is_alone) else {
        return vec![None];
    };
    let names = points.get_ref().iter().map(|n| n.get_ref().as_str());
    let name = names.collect::<Vec<_>>().join("+");
    let variable = |reach: f64| Variable {
        name: name.clone(),
        moves: Vec::new(),
        turn: None,
        rate: None,
        range: [-reach, reach],
        cost,
    };
    let shifts = Axis::ALL.into_iter().filter_map(|axis| {
        let moved = ids.iter().map(|point| Move {
            point: *point,
            axis,
            factor: 1.0,
        });
        Some(Some(Variable {
            moves: moved.collect(),
            ..variable(shift.flatten()?)
        }))
    });
    let turns = Axis::ALL.into_iter().filter_map(|axis| {
        let points = ids.clone();
        Some(Some(Variable {
            turn: Some(Turn { points, axis }),
            ..variable(turn.flatten()?)
        }))
    });
    shifts.chain(turns).collect()
}

/// Refuses keys that do not work with `rigid`. Returns true if there are no such keys.
fn refuse_beside_rigid(written: &file::Variable, problems: &mut Problems) -> bool {
    let others = [
        ("axis", written.axis.as_ref().map(Spanned::span)),
        ("direction", written.direction.as_ref().map(Spanned::span)),
        ("range", written.range.as_ref().map(Spanned::span)),
        ("factors", written.factors.as_ref().map(Spanned::span)),
        ("hardpoint", written.hardpoint.as_ref().map(Spanned::span)),
        ("hardpoints", written.hardpoints.as_ref().map(Spanned::span)),
    ];
    let mut is_alone = true;
    for (key, place) in others {
        if let Some(place) = place {
            let message = format!("{key} does not work with \"rigid\": use \"shift\" and \"turn\"");
            problems.add(place, message);
            is_alone = false;
        }
    }
    is_alone
}

/// Points of a rigid body: at least two, each listed once.
fn points_of_body(
    points: &Spanned<Vec<Text>>,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<Vec<PointId>> {
    let names = points.get_ref();
    let ids = each(names, |name| hardpoint(name, suspension, problems))?;
    let mut is_sound = true;
    for (i, name) in names.iter().enumerate() {
        if ids[..i].contains(&ids[i]) {
            problems.add(name.span(), format!("{:?} is listed twice", name.get_ref()));
            is_sound = false;
        }
    }
    if ids.len() < 2 {
        return problems.refuse(points.span(), "a body has at least two points");
    }
    is_sound.then_some(ids)
}
