//! Tests of random mixes of targets and constraints over all topologies. Some constraints change with no variable, some depend
//! on others, and some contradict each other.

use super::minima::{Random, slsqp};
use super::noise;
use crate::support::larger;
use hardpoint::curves::Curves;
use hardpoint::optimise::{Control, Fit, Termination, Tuning, tune};
use hardpoint::study::{Optimise, Study};
use nalgebra::DVector;
use std::path::Path;

const FILES: [&str; 4] = [
    "macpherson_front.toml",
    "double_wishbone_front.toml",
    "five_link_rear.toml",
    "semi_trailing_arm_rear.toml",
];
/// Characteristics that every topology has, with tolerances in the study's units.
const CHARACTERISTICS: [(&str, f64); 5] = [
    ("camber", 0.05),
    ("toe", 0.02),
    ("camber_gain", 0.0005),
    ("bump_steer", 0.0005),
    ("roll_centre_height", 2.0),
];
const TRAVELS: [f64; 7] = [-45.0, -30.0, -15.0, 0.0, 15.0, 30.0, 45.0];

/// Generator of repeatable random numbers.
struct Draw(u64);

impl Draw {
    fn new(seed: u64, number: u64) -> Self {
        let mut draw = Draw(seed ^ (number + 1).wrapping_mul(0xD134_2543_DE82_EF95));
        draw.of(1);
        draw
    }

    /// Random number between -`by` and `by`.
    fn off(&mut self, by: f64) -> f64 {
        by * noise(&mut self.0)
    }

    /// Random number between `low` and `high`.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (0.5 + self.off(0.5))
    }

    /// Random index below `count`.
    fn of(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }
}

/// Kinds of mixes of targets and constraints.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Any mix, including mixes that cannot be satisfied.
    Any,
    /// Constraints that the study's nominal design satisfies and that the variables affect.
    Kept,
    /// Like `Kept`, with at least one constraint that no variable affects or that depends on another constraint.
    Degenerate,
}

/// Random tuning.
pub(super) struct Mix {
    pub study: Study,
    pub file: &'static str,
    /// Overrides of the study file.
    pub overrides: Vec<String>,
    /// Kinds of the constraints of the mix.
    pub kinds: Vec<&'static str>,
}

fn read(file: &str, overrides: &[String]) -> Option<Study> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    Study::read(&path.join(file), overrides).ok()
}

/// Curve as a study writes it.
fn curve(values: impl Iterator<Item = f64>) -> String {
    let knots = TRAVELS.iter().zip(values);
    let knots: Vec<String> = knots.map(|(t, v)| format!("[{t}, {v}]")).collect();
    format!("[{}]", knots.join(", "))
}

/// Values of a characteristic at the travels.
fn column(curves: &Curves, name: &str) -> Vec<f64> {
    // Several column names can begin with the name of the characteristic. The shortest one has only the unit after this
    // name.
    let columns = curves.columns.iter().enumerate();
    let own = columns.filter(|(_, c)| c.name.starts_with(name));
    let (index, _) = own.min_by_key(|(_, c)| c.name.len()).unwrap();
    let stations = curves.stations.iter();
    stations.map(|s| s.values[index].unwrap()).collect()
}

/// Movable points of a wheel, with their coordinates in the study's axes.
fn points(plain: &Study) -> Vec<(String, [f64; 3])> {
    let suspension = plain.wheel();
    let names = suspension.mechanism.points.iter().map(|p| p.name.clone());
    let places = suspension
        .design
        .iter()
        .map(|p| suspension.frame.vector(*p).to_array());
    let is_own = |name: &str| !name.starts_with("spindle");
    names.zip(places).filter(|(name, _)| is_own(name)).collect()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = (0..3).map(|k| (a[k] - b[k]).powi(2));
    squares.sum::<f64>().sqrt()
}

impl Mix {
    /// Random mix that follows from the seed of a test and the number of the mix.
    pub(super) fn new(seed: u64, number: u64, kind: Kind) -> Self {
        let file = FILES[number as usize % FILES.len()];
        for attempt in 0..20 {
            let mut draw = Draw::new(seed.wrapping_add(attempt * 7919), number);
            let (overrides, kinds) = drawn(file, &mut draw, kind);
            if let Some(study) = read(file, &overrides) {
                return Mix {
                    study,
                    file,
                    overrides,
                    kinds,
                };
            }
        }
        panic!("{number}: no study can be read");
    }

    pub(super) fn tuned(&self, good_enough: f64) -> Tuning {
        let mut optimise = self.study.optimise.clone().unwrap();
        optimise.good_enough = good_enough;
        self.tuned_as(&optimise)
    }

    fn tuned_as(&self, optimise: &Optimise) -> Tuning {
        tune(&self.study.vehicle, optimise, Control::default()).unwrap()
    }

    /// Distance from the nominal design, in multiples of the range.
    pub(super) fn distance(&self, fit: &Fit) -> f64 {
        let variables = &self.study.optimise.as_ref().unwrap().variables;
        let moves = fit.x.iter().zip(variables);
        let squares = moves.map(|(x, v)| v.cost * (x / (v.range[1] - v.range[0])).powi(2));
        squares.sum::<f64>().sqrt()
    }
}

/// Overrides that turn a study file into a mix.
fn drawn(file: &'static str, draw: &mut Draw, kind: Kind) -> (Vec<String>, Vec<&'static str>) {
    let travels: Vec<String> = TRAVELS.iter().map(|t| format!("{t:?}")).collect();
    let names: Vec<String> = CHARACTERISTICS
        .iter()
        .map(|(n, _)| format!("\"{n}\""))
        .collect();
    let mut overrides = vec![
        format!("motion.travel=[{}]", travels.join(", ")),
        format!("outputs.characteristics=[{}]", names.join(", ")),
    ];
    let plain = read(file, &overrides).unwrap();
    let plan = hardpoint::plan::Plan::with_targets(plain.one_wheel().unwrap(), None);
    let curves = hardpoint::curves::curves(plain.wheel(), &plan).unwrap();
    let all = points(&plain);
    // Chooses variables.
    let mut coordinates: Vec<(usize, usize)> = (0..all.len())
        .filter(|k| all[*k].0 != "wheel_centre")
        .flat_map(|k| [0, 1, 2].map(|axis| (k, axis)))
        .collect();
    let count = 2 + draw.of(6);
    let mut variables = Vec::new();
    let mut moved = Vec::new();
    for _ in 0..count.min(coordinates.len()) {
        let (k, axis) = coordinates.swap_remove(draw.of(coordinates.len()));
        let by = draw.between(4.0, 20.0);
        variables.push(format!(
            "{{ hardpoint = \"{}\", axis = \"{}\", range = [{}, {by}] }}",
            all[k].0,
            ["x", "y", "z"][axis],
            -by
        ));
        moved.push(k);
    }
    overrides.push(format!("optimise.variables=[{}]", variables.join(", ")));
    // Chooses targets.
    let mut targets = Vec::new();
    let first = draw.of(CHARACTERISTICS.len());
    for k in 0..1 + draw.of(3) {
        let (name, tolerance) = CHARACTERISTICS[(first + k) % CHARACTERISTICS.len()];
        let values = column(&curves, name);
        let (shift, tilt) = (draw.off(10.0 * tolerance), draw.off(0.1 * tolerance));
        let wanted = || {
            values
                .iter()
                .zip(TRAVELS)
                .map(|(v, t)| v + shift + tilt * t)
        };
        let wanted = match draw.of(3) {
            0 => format!("at = 0.0, value = {}", values[3] + shift),
            1 => format!("points = {}", curve(wanted())),
            _ => {
                let half = 1.5 * tolerance;
                let (low, high) = (wanted().map(|v| v - half), wanted().map(|v| v + half));
                format!("between = [{}, {}]", curve(low), curve(high))
            }
        };
        targets.push(format!(
            "{{ characteristic = \"{name}\", {wanted}, tolerance = {tolerance} }}"
        ));
    }
    overrides.push(format!("optimise.targets=[{}]", targets.join(", ")));
    let (constraints, kinds) = constraints(draw, kind, &all, &moved, &curves);
    overrides.push(format!("optimise.constraints=[{}]", constraints.join(", ")));
    overrides.push("optimise.starts=1".to_owned());
    (overrides, kinds)
}

/// Random constraints, with the kind of each constraint.
fn constraints(
    draw: &mut Draw,
    kind: Kind,
    all: &[(String, [f64; 3])],
    moved: &[usize],
    curves: &Curves,
) -> (Vec<String>, Vec<&'static str>) {
    let still: Vec<usize> = (0..all.len()).filter(|k| !moved.contains(k)).collect();
    let (mut written, mut kinds): (Vec<String>, Vec<&'static str>) = (Vec::new(), Vec::new());
    let degenerate = kind != Kind::Kept;
    for place in 0..1 + draw.of(5) {
        let a = moved[draw.of(moved.len())];
        let b = (a + 1 + draw.of(all.len() - 1)) % all.len();
        let pair = format!("length = [\"{}\", \"{}\"]", all[a].0, all[b].0);
        let long = apart(all[a].1, all[b].1);
        let slack = draw.between(0.0, 6.0);
        let choice = match (kind, place) {
            (Kind::Degenerate, 0) => 6 + draw.of(2),
            (Kind::Any, _) => draw.of(11),
            // Omits equalities, because the crate `slsqp`, with which the test compares, does not support them.
            (Kind::Degenerate, _) => 1 + draw.of(5),
            _ => draw.of(6),
        };
        let (text, name) = match choice {
            0 => (format!("{pair}, kept = true, at = \"design\""), "kept"),
            1 | 2 => {
                let (low, high) = (long - slack, long + draw.between(0.0, 4.0));
                (
                    format!("{pair}, between = [{low}, {high}], at = \"design\""),
                    "length",
                )
            }
            3 => {
                let centre = all[a].1;
                let low = centre.map(|c| c - draw.between(0.0, 8.0));
                let high = centre.map(|c| c + draw.between(0.0, 8.0));
                let name = &all[a].0;
                let text = format!(
                    "point = \"{name}\", inside = {{ box = [{low:?}, {high:?}] }}, at = \"design\""
                );
                (text, "box")
            }
            4 => {
                let (name, tolerance) = CHARACTERISTICS[draw.of(2)];
                let values = column(curves, name);
                let least = values.iter().copied().fold(f64::INFINITY, f64::min);
                let most = values.iter().copied().fold(f64::NEG_INFINITY, larger);
                let low = least - draw.between(0.0, 6.0) * tolerance;
                let high = most + draw.between(0.0, 6.0) * tolerance;
                (
                    format!("characteristic = \"{name}\", between = [{low}, {high}]"),
                    "band",
                )
            }
            5 => {
                let centre = all[a].1.map(|c| c + draw.off(3.0));
                let radius = apart(centre, all[a].1) + draw.between(0.0, 6.0);
                let name = &all[a].0;
                let text = format!(
                    "point = \"{name}\", inside = {{ sphere = {{ centre = {centre:?}, radius = {radius} }} }}, at = \"design\""
                );
                (text, "sphere")
            }
            // Lengths that no variable affects, at their limits.
            6 if degenerate && still.len() > 1 => {
                let (c, d) = (still[0], still[1 + draw.of(still.len() - 1)]);
                let long = apart(all[c].1, all[d].1);
                let limit = match draw.of(3) {
                    0 if kind == Kind::Any => "kept = true".to_owned(),
                    0 | 1 => format!("at_most = {long}"),
                    _ => format!("between = [{long}, {}]", long + 1.0),
                };
                let text = format!(
                    "length = [\"{}\", \"{}\"], {limit}, at = \"design\"",
                    all[c].0, all[d].0
                );
                (text, "still")
            }
            // Repeats a constraint.
            7 | 6 => match (written.last(), kind) {
                (Some(last), _) => (last.clone(), "twice"),
                (None, _) => {
                    let text = format!("{pair}, at_most = {}, at = \"design\"", long + slack);
                    written.push(format!("{{ {text} }}"));
                    kinds.push("length");
                    (text, "twice")
                }
            },
            // A violated constraint that no variable affects.
            8 if still.len() > 1 => {
                let (c, d) = (still[0], still[1 + draw.of(still.len() - 1)]);
                let most = apart(all[c].1, all[d].1) - draw.between(0.5, 5.0);
                let text = format!(
                    "length = [\"{}\", \"{}\"], at_most = {most}, at = \"design\"",
                    all[c].0, all[d].0
                );
                (text, "missed")
            }
            9 => {
                let text = format!("{pair}, at_most = {}, at = \"design\"", long - 1.0);
                written.push(format!("{{ {text} }}"));
                kinds.push("short");
                (
                    format!("{pair}, at_least = {}, at = \"design\"", long + 1.0),
                    "contradiction",
                )
            }
            _ => {
                let other = |k: usize| (a + 1 + (b + k) % (all.len() - 1)) % all.len();
                let four: Vec<usize> = if all.len() > 3 {
                    vec![a, other(0), other(1), other(2)]
                } else {
                    // The wheel has at most three movable points, and the constraint uses all of them. Three points
                    // always lie in a plane.
                    (0..all.len()).collect()
                };
                let names: Vec<String> =
                    four.iter().map(|k| format!("\"{}\"", all[*k].0)).collect();
                (
                    format!("coplanar = [{}], at = \"design\"", names.join(", ")),
                    "coplanar",
                )
            }
        };
        // A text that begins with a brace is a copy of an earlier constraint.
        written.push(if text.starts_with('{') {
            text
        } else {
            format!("{{ {text} }}")
        });
        kinds.push(name);
    }
    (written, kinds)
}

/// Outcomes of many mixes.
#[derive(Default)]
struct Tally {
    evaluations: Vec<u64>,
    feasible: usize,
    converged: usize,
    failed: Vec<String>,
}

/// Tunes mixes, and counts how the tunings end.
fn tally(seed: u64, numbers: std::ops::Range<u64>) -> Tally {
    let mut tally = Tally::default();
    let out = std::env::var("HARDPOINT_MIXES").ok();
    let mut lines = String::new();
    for number in numbers {
        let mix = Mix::new(seed, number, Kind::Any);
        let good_enough = [0.0, 0.0, 0.1, 0.0, 1.0][number as usize % 5];
        let tuning = mix.tuned(good_enough);
        let Some(fit) = tuning.starts.best_fit() else {
            panic!("{number}: {:?}", tuning.starts.starts[0].outcome);
        };
        let most = tuning.starts.starts.iter();
        let most = most.filter_map(|s| s.outcome.as_ref().ok().map(Fit::evaluations));
        tally.evaluations.push(most.max().unwrap());
        let is_feasible = fit.is_feasible();
        let converged = fit.termination.at_minimum() && fit.residual.is_some_and(|r| r < 1e-6);
        let is_met = fit.termination.at_minimum() && fit.misfit() < 1e-11;
        if is_feasible {
            tally.feasible += 1;
            if converged || is_met {
                tally.converged += 1;
            } else {
                tally.failed.push(format!(
                    "{number} {} {:?}: {} evaluations, {}",
                    mix.file,
                    mix.kinds,
                    fit.evaluations(),
                    fit.ended()
                ));
            }
        }
        lines += &format!(
            "{number}\t{}\t{good_enough}\t{}\t{:e}\t{}\t{:?}\t{}\t{}\n",
            mix.file,
            is_feasible,
            fit.misfit(),
            fit.evaluations(),
            fit.residual,
            fit.ended(),
            mix.overrides.join("\u{1}")
        );
    }
    if let Some(path) = out {
        std::fs::write(path, lines).unwrap();
    }
    tally.evaluations.sort_unstable();
    tally
}

fn check(tally: &Tally, least_share: f64) {
    let median = tally.evaluations[tally.evaluations.len() / 2].max(1);
    let most = *tally.evaluations.last().unwrap();
    println!(
        "{} mixes: median {median} evaluations, most {most}; {} feasible, {} converged",
        tally.evaluations.len(),
        tally.feasible,
        tally.converged
    );
    for line in &tally.failed {
        println!("  {line}");
    }
    // Ninety-nine of a hundred runs need at most twenty times the median number of evaluations. In the other runs the
    // smallest change is hard to find: the search repeats with other misfit levels until it uses up its budget. The
    // budget is 0.1 of `max_evaluations`, and 8 of a thousand runs were so long. With a budget of 0.04 only 5 were so
    // long, but 3 more runs ended without a known smallest change.
    let many = tally
        .evaluations
        .iter()
        .filter(|e| **e > 20 * median)
        .count();
    println!("{many} took more than 20 times the median");
    assert!(many * 100 <= tally.evaluations.len(), "{many}");
    assert!(most <= 50 * median, "{most} evaluations, median {median}");
    // Of a thousand mixes, 642 could be satisfied.
    assert!(4 * tally.feasible >= tally.evaluations.len());
    assert!(tally.converged as f64 >= least_share * tally.feasible as f64);
}

/// Forty mixes of seed 1 all end. Mixes that can be satisfied converge.
#[test]
fn mixes_end_and_converge() {
    if !crate::support::has_lanes() {
        return;
    }
    check(&tally(1, 0..40), 0.97);
}

/// A thousand mixes of seed 2 all end. Mixes that can be satisfied converge.
#[test]
#[ignore = "takes minutes; .ci/long"]
fn a_thousand_mixes_end_and_converge() {
    check(&tally(2, 0..1000), 0.97);
}

/// Tunes with rising values of `good_enough`. Counts how often the distance from the nominal design grows, and how
/// often the program warns that it may grow.
fn rising_levels(seed: u64, problems: std::ops::Range<u64>, levels: usize) -> [usize; 4] {
    let (mut grown, mut silent, mut labelled, mut count) = (0, 0, 0, 0);
    for number in problems {
        let mix = Mix::new(seed, number, Kind::Kept);
        let to_least = mix.tuned(0.0);
        let least = to_least.starts.best_fit().unwrap().misfit();
        let Ok(before) = &to_least.before else {
            continue;
        };
        let before = before.misfit;
        let mut last: Option<(f64, bool)> = None;
        for k in 0..levels {
            let share = (k as f64 + 0.5) / levels as f64;
            let level = (least + 1e-3) * 1.02 + share * (before - least).max(0.0);
            let tuning = mix.tuned(level);
            let fit = tuning.starts.best_fit().unwrap();
            let distance = mix.distance(fit);
            let unsure = matches!(
                fit.termination,
                Termination::GoodEnoughNotKnownNearest | Termination::BestNotKnownNearest
            );
            count += 1;
            labelled += usize::from(unsure);
            assert!(
                fit.misfit() <= level + 1e-6,
                "{number} {level}: {}",
                fit.misfit()
            );
            if let Some((nearest, was_unsure)) = last
                && distance > nearest + 1e-6
            {
                grown += 1;
                silent += usize::from(!unsure && !was_unsure);
                println!(
                    "{number} {} level {level}: {nearest} -> {distance}, {}, {:?}",
                    mix.file,
                    fit.ended(),
                    mix.kinds
                );
            }
            if unsure {
                println!(
                    "{number} {} level {level}: {} evaluations, {}",
                    mix.file,
                    fit.evaluations(),
                    fit.ended()
                );
            }
            let nearest = last.map_or(distance, |(nearest, _)| nearest.min(distance));
            last = Some((nearest, unsure));
        }
    }
    println!(
        "{count} levels: {grown} grow, {silent} of them silently; {labelled} not known to be the smallest change"
    );
    [count, grown, silent, labelled]
}

/// If `good_enough` rises, the kept design comes nearer to the nominal design, in eight problems of seed 4.
#[test]
fn a_higher_level_is_no_farther() {
    let [count, grown, silent, labelled] = rising_levels(4, 0..8, 5);
    assert!(count >= 20, "{count}");
    assert!(grown == 0 && silent == 0, "{grown} of {count}");
    assert!(labelled * 100 <= 3 * count, "{labelled} of {count}");
}

/// If `good_enough` rises in ten steps, the kept design comes nearer to the nominal design, in thirty problems of seed 4. At most
/// three of the three hundred designs are farther away than before, and the program warns of each of them.
#[test]
#[ignore = "takes minutes; .ci/long"]
fn three_hundred_rising_levels_are_no_farther() {
    let [count, grown, silent, labelled] = rising_levels(4, 0..30, 10);
    assert!(count >= 150, "{count}");
    assert!(grown <= 3 && silent == 0, "{grown} of {count}");
    assert!(labelled * 100 <= 3 * count, "{labelled} of {count}");
}

/// Compares misfits of this program with those of the crate `slsqp` from the same design. Each case has constraints
/// that no variable affects, or dependent constraints. This program may end with a higher misfit only if `slsqp` ends
/// in another minimum. Then this program, started from that minimum, stays there.
fn against_slsqp(seed: u64, numbers: std::ops::Range<u64>) {
    let (mut compared, mut others) = (0, 0);
    for number in numbers {
        let mix = Mix::new(seed, number, Kind::Degenerate);
        let tuning = mix.tuned(0.0);
        let ours = tuning.starts.best_fit().unwrap();
        let random = Random::of(mix.study);
        let theirs = slsqp(&random, &DVector::zeros(random.bounds.variables()));
        if !theirs.is_feasible() {
            continue;
        }
        compared += 1;
        assert!(ours.is_feasible(), "{number}: {}", ours.ended());
        let misfit = ours.misfit();
        if misfit > theirs.misfit * (1.0 + 1e-6) + 1e-9 {
            others += 1;
            let again = random.ours(&theirs.x);
            println!(
                "{number}: {misfit} above {}, {}",
                theirs.misfit,
                ours.ended()
            );
            assert!(
                ours.residual.is_some_and(|r| r < 1e-6),
                "{number}: {:?}",
                ours.residual
            );
            assert!(
                again.at.goal.misfit() <= theirs.misfit * (1.0 + 1e-6),
                "{number}"
            );
        }
    }
    println!("{compared} compared, {others} other minima");
    assert!(compared > 0);
}

/// In forty cases of seed 5, no misfit of this program is above that of `slsqp`, unless `slsqp` ends in another minimum.
#[test]
fn no_misfit_is_above_that_of_slsqp() {
    against_slsqp(5, 0..40);
}
