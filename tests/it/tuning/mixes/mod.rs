//! Random mixes of targets and constraints over all topologies. Some constraints change with no variable, some depend
//! on others, and some contradict each other.

mod constraints;
mod convergence;
mod levels;
mod minima;

use super::noise;
use constraints::constraints;
use hardpoint::curves::Curves;
use hardpoint::optimise::{Control, Fit, Tuning, tune};
use hardpoint::study::{Optimise, Study};

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
    Study::read(&crate::support::studies().join(file), overrides).ok()
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
