//! Tests of constrained minima of random designs, against other methods from the same starts.
//!
//! The other methods are the crate `slsqp` (D. Kraft's sequential quadratic programs, from NLopt) and a method of
//! multipliers below. All methods use the same values with the same exact gradients.

use super::{edited, noise};
use crate::support::larger;
use hardpoint::optimise::{
    Assessment, Bounds, Constrained, ConstrainedFit, Control, Objective, Options, TargetLayout,
    constrained_fit,
};
use hardpoint::study::Study;
use nalgebra::DVector;
use std::cell::RefCell;

/// Largest difference of two misfits that count as equal, in multiples of the tolerance.
const AS_LOW: f64 = 1e-6;
/// Violation up to which a constraint counts as satisfied, for all methods.
const KEPT: f64 = 1e-7;

/// Random tuning of a strut or wishbone: two to twelve variables, two curves or a curve and a band, and constraints at
/// 41 stations. One random design satisfies the limits.
pub(super) struct Random {
    study: Study,
    pub(super) layout: TargetLayout,
    pub(super) bounds: Bounds,
}

/// Kind of constraint with its limits, in mm and degrees.
#[derive(Clone)]
struct Limit {
    kind: Kind,
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Length,
    Rim,
    Band,
    Sphere,
    Clearance,
}

impl Limit {
    /// Constraint as a study writes it.
    fn written(&self, number: u64) -> String {
        let Limit { kind, low, high } = self;
        match kind {
            Kind::Length => {
                format!("{{ length = \"tie_rod\", between = [{low}, {high}] }}")
            }
            Kind::Rim => format!(
                "{{ point = \"tie_rod_outer\", inside = {{ rim = {high}, from = -150.0, to = 40.0 }} }}"
            ),
            Kind::Band => format!("{{ characteristic = \"toe\", between = [{low}, {high}] }}"),
            Kind::Sphere => format!(
                "{{ point = \"lower_ball_joint\", inside = {{ sphere = {{ centre = [0.0, 700.0, 190.0], radius = {high} }} }} }}"
            ),
            Kind::Clearance => {
                let other = ["strut", "lower_arm_front"][number as usize % 2];
                format!("{{ members = [\"tie_rod\", \"{other}\"], clearance = {low} }}")
            }
        }
    }

    /// Limits so wide that no design reaches them.
    fn wide(kind: Kind) -> Self {
        let (low, high) = match kind {
            Kind::Length => (1.0, 1000.0),
            Kind::Band => (-40.0, 40.0),
            Kind::Rim | Kind::Sphere => (0.0, 1000.0),
            Kind::Clearance => (0.0, 0.0),
        };
        Limit { kind, low, high }
    }
}

impl Random {
    fn new(number: u64) -> Self {
        let mut seed = 0x9E37_79B9_7F4A_7C15 ^ (number + 1).wrapping_mul(0xD134_2543_DE82_EF95);
        let mut off = |by: f64| by * noise(&mut seed);
        let file = ["macpherson_front.toml", "double_wishbone_front.toml"][number as usize % 2];
        let plain = edited(file, &[]);
        let points = &plain.wheel().mechanism.points;
        let names = points.iter().map(|p| p.name.as_str());
        let names = names.filter(|n| !n.starts_with("wheel") && !n.starts_with("spindle"));
        let mut coordinates: Vec<(&str, &str)> = names
            .flat_map(|name| ["x", "y", "z"].map(|axis| (name, axis)))
            .collect();
        // Number of random variables; even and odd numbers choose the topology.
        let count = 2 + (number / 2) as usize % 11;
        for k in 0..count {
            let last = coordinates.len() - 1;
            let drawn = k + ((0.5 + off(0.5)) * (last + 1 - k) as f64) as usize;
            coordinates.swap(k, drawn.min(last));
        }
        let variables = coordinates[..count].iter().map(|(name, axis)| {
            format!("{{ hardpoint = \"{name}\", axis = \"{axis}\", range = [-15.0, 15.0] }}")
        });
        let variables = variables.collect::<Vec<_>>().join(", ");
        let variables = format!("optimise.variables=[{variables}]");
        let curve =
            |at: [f64; 3]| format!("[[-60.0, {}], [0.0, {}], [60.0, {}]]", at[0], at[1], at[2]);
        let camber = [1.0 + off(0.4), -0.5 + off(0.2), -1.2 + off(0.4)];
        let camber = match number % 3 {
            0 => format!(
                "between = [{}, {}]",
                curve(camber.map(|c| c - 0.1)),
                curve(camber.map(|c| c + 0.1))
            ),
            _ => format!("points = {}", curve(camber)),
        };
        let inclination = curve([9.5 + off(0.5), 12.0 + off(0.5), 13.0 + off(0.5)]);
        let targets = format!(
            "optimise.targets=[{{ characteristic = \"camber\", {camber}, tolerance = 0.05 }}, \
             {{ characteristic = \"kingpin_inclination\", points = {inclination}, tolerance = 0.1 }}]"
        );
        let with = |limits: &[Limit]| {
            let constraints: Vec<String> = limits.iter().map(|l| l.written(number)).collect();
            let constraints = format!("optimise.constraints=[{}]", constraints.join(", "));
            let travel = "motion.travel={ from = -60.0, to = 60.0, steps = 41 }";
            edited(file, &[travel, &variables, &targets, &constraints])
        };
        let mut kinds = vec![Kind::Length, Kind::Rim, Kind::Band];
        let more = [Kind::Sphere, Kind::Clearance];
        kinds.extend(
            (0..2)
                .filter(|k| (number >> (k + 1)) & 1 == 1)
                .map(|k| more[k]),
        );
        let mut limits: Vec<Limit> = kinds.into_iter().map(Limit::wide).collect();
        // A random design satisfies the constraints. In some problems its margins are almost zero, in others large.
        let most = 0.05 * 40.0_f64.powf(0.5 + off(0.5));
        let keeps = DVector::from_fn(count, |_, _| off(9.0));
        let wide = Random::of(with(&limits));
        let at = wide.assessed(&keeps);
        for (limit, room) in limits.iter_mut().zip(wide.rooms(&at)) {
            let visible = if limit.kind == Kind::Band { 0.1 } else { 1.0 };
            let slack = most * visible * (0.5 + off(0.5));
            match limit.kind {
                Kind::Clearance => limit.low = (room[0] - slack).max(0.0),
                _ => {
                    limit.low += room[0] - slack;
                    limit.high -= room[1] - slack;
                }
            }
        }
        Random::of(with(&limits))
    }

    /// Random design of a strut or wishbone, with every coordinate within 15 mm of the study's. Its variables are the
    /// eight coordinates with the largest effects. The targets are camber and kingpin inclination of another design
    /// that can be reached, plus a deviation that cannot. The limits apply at 41 stations (126 constraint values). A
    /// third design just satisfies them.
    fn of_design(number: u64) -> Self {
        let mut seed = 0x2545_F491_4F6C_DD1D ^ (number + 1).wrapping_mul(0xD134_2543_DE82_EF95);
        let mut off = |by: f64| by * noise(&mut seed);
        let is_strut = number.is_multiple_of(2);
        let file = if is_strut {
            "macpherson_front.toml"
        } else {
            "double_wishbone_front.toml"
        };
        let plain = edited(file, &[]);
        let suspension = plain.wheel();
        let names = suspension.mechanism.points.iter().map(|p| p.name.as_str());
        let mut overrides: Vec<String> = names
            .zip(&suspension.design)
            .filter(|(name, _)| !name.starts_with("wheel") && !name.starts_with("spindle"))
            .map(|(name, at)| {
                let [x, y, z] = at.to_array().map(|c| c + off(15.0));
                format!("suspension.hardpoints.{name}=[{x}, {y}, {z}]")
            })
            .collect();
        let moved = if is_strut {
            [
                ("strut_top", "y"),
                ("lower_ball_joint", "y"),
                ("lower_ball_joint", "z"),
                ("lower_arm_front", "y"),
                ("lower_arm_front", "z"),
                ("lower_arm_rear", "z"),
                ("tie_rod_inner", "z"),
                ("tie_rod_outer", "y"),
            ]
        } else {
            [
                ("upper_ball_joint", "y"),
                ("lower_ball_joint", "y"),
                ("lower_ball_joint", "z"),
                ("upper_arm_front", "z"),
                ("upper_arm_rear", "z"),
                ("lower_arm_front", "z"),
                ("tie_rod_inner", "z"),
                ("tie_rod_outer", "y"),
            ]
        };
        let variables = moved.map(|(name, axis)| {
            format!("{{ hardpoint = \"{name}\", axis = \"{axis}\", range = [-20.0, 20.0] }}")
        });
        overrides.push(format!("optimise.variables=[{}]", variables.join(", ")));
        overrides.push("motion.travel={ from = -60.0, to = 60.0, steps = 41 }".to_owned());
        let with = |curves: &[Vec<[f64; 2]>; 2], limits: &[Limit]| {
            let [camber, inclination] = curves;
            let constraints: Vec<String> = limits.iter().map(|l| l.written(number)).collect();
            let more = [
                format!(
                    "optimise.targets=[{{ characteristic = \"camber\", points = {camber:?}, tolerance = 0.05 }}, \
                     {{ characteristic = \"kingpin_inclination\", points = {inclination:?}, tolerance = 0.1 }}]"
                ),
                format!("optimise.constraints=[{}]", constraints.join(", ")),
            ];
            let all: Vec<&str> = overrides.iter().chain(&more).map(String::as_str).collect();
            Random::of(edited(file, &all))
        };
        let mut limits = [Kind::Length, Kind::Rim, Kind::Band].map(Limit::wide);
        let nought = || vec![[-60.0, 0.0], [60.0, 0.0]];
        let wide = with(&[nought(), nought()], &limits);
        // If all targets are zero, the residuals of a design are its curves, in multiples of the tolerance. The curves
        // of a random design, plus a deviation, become the targets.
        let wanted = wide.assessed(&DVector::from_fn(8, |_, _| off(20.0)));
        let wanted = &wanted.goal.residuals;
        let stations = &wide.study.motion().values;
        let bent = [off(1.0), off(1.0)];
        let curves = [0, 1].map(|target| {
            let points = stations.iter().enumerate().map(|(k, travel)| {
                let tolerance = [0.05, 0.1][target];
                let swing = 4.0 * bent[target] * (travel / 20.0).sin();
                [
                    *travel,
                    (wanted[target * stations.len() + k] + swing) * tolerance,
                ]
            });
            points.collect()
        });
        let at = wide.assessed(&DVector::from_fn(8, |_, _| off(12.0)));
        for (limit, room) in limits.iter_mut().zip(wide.rooms(&at)) {
            let slack = if limit.kind == Kind::Band { 0.1 } else { 1.0 };
            limit.low += room[0] - slack;
            limit.high -= room[1] - slack;
        }
        with(&curves, &limits)
    }

    pub(super) fn of(study: Study) -> Self {
        let optimise = study.optimise.as_ref().unwrap();
        let layout = TargetLayout::of(optimise, &study.vehicle);
        let ranges: Vec<[f64; 2]> = optimise.variables.iter().map(|v| v.range).collect();
        Random {
            bounds: Bounds::new(&ranges).unwrap(),
            layout,
            study,
        }
    }

    fn problem(&self) -> Objective<'_> {
        let variables = &self.study.optimise.as_ref().unwrap().variables;
        Objective::new(self.study.wheel(), variables, &self.layout).unwrap()
    }

    fn assessed(&self, x: &DVector<f64>) -> Assessment {
        let mut problem = self.problem();
        let mut at = Assessment::new(&Constrained::shape(&problem));
        problem.assess(x, &mut at).unwrap();
        at
    }

    /// Margins to the lower and upper limit of each constraint. If a constraint has several values, the smallest margin
    /// counts.
    fn rooms(&self, at: &Assessment) -> Vec<[f64; 2]> {
        let count = self.study.optimise.as_ref().unwrap().constraints.len();
        let mut rooms = vec![[f64::INFINITY; 2]; count];
        for (label, value) in self.layout.labels().iter().zip(at.rows.residuals.iter()) {
            // For a rim constraint, the test uses only the distance from the rim's radius, not from the ends of the
            // rim.
            if label.part == self.first_part(label.constraint) {
                let room = &mut rooms[label.constraint][usize::from(label.is_upper)];
                *room = room.min(-value);
            }
        }
        rooms
    }

    fn first_part(&self, constraint: usize) -> usize {
        let labels = self.layout.labels().iter();
        let parts = labels.filter(|l| l.constraint == constraint);
        parts.map(|l| l.part).min().unwrap()
    }

    pub(super) fn ours(&self, from: &DVector<f64>) -> ConstrainedFit {
        let (options, control) = (Options::default(), Control::default());
        constrained_fit(0, self.problem(), &self.bounds, from, &options, control).unwrap()
    }
}

/// End of a run by another method.
#[derive(Clone, Debug)]
pub(super) struct End {
    pub(super) x: DVector<f64>,
    pub(super) misfit: f64,
    violation: f64,
    /// Distance of every evaluated point from the end of the run. The unit is half the range of a variable.
    away: Vec<f64>,
    /// Message of the method about its end.
    said: String,
}

impl End {
    /// Number of evaluations until the method stays within the distance `near` of its end. The unit of `near` is half
    /// the range of a variable.
    fn evaluations_to(&self, near: f64) -> u64 {
        let last = self.away.iter().rposition(|away| *away > near);
        // Position `k` is the last point beyond the distance. The next point has the number k + 2, because numbers
        // start at 1.
        last.map_or(1, |k| k as u64 + 2).min(self.away.len() as u64)
    }

    pub(super) fn is_feasible(&self) -> bool {
        self.violation <= KEPT
    }
}

/// Values and gradients at the last evaluated point.
struct Looked<'p> {
    problem: Objective<'p>,
    half: Vec<f64>,
    at: Assessment,
    z: Vec<f64>,
    refused: bool,
    points: Vec<Vec<f64>>,
}

impl<'p> Looked<'p> {
    fn new(random: &'p Random) -> Self {
        let problem = random.problem();
        let shape = Constrained::shape(&problem);
        assert_eq!(shape.equalities, 0);
        let half: Vec<f64> = random.bounds.width().iter().map(|w| 0.5 * w).collect();
        Looked {
            at: Assessment::new(&shape),
            problem,
            half,
            z: Vec::new(),
            refused: false,
            points: Vec::new(),
        }
    }

    /// Evaluates a point (coordinates in units of half the range of each variable), unless it is the point of the last
    /// evaluation.
    fn look(&mut self, z: &[f64]) {
        if self.z == z {
            return;
        }
        self.z = z.to_vec();
        let x = DVector::from_fn(z.len(), |j, _| z[j] * self.half[j]);
        self.refused = self.problem.assess(&x, &mut self.at).is_err();
        self.points.push(self.z.clone());
    }

    /// Squared misfit. Writes its slopes into `gradient`.
    fn goal(&mut self, z: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        self.look(z);
        if self.refused {
            return f64::INFINITY;
        }
        let goal = &self.at.goal;
        let share = 1.0 / goal.residuals.len() as f64;
        if let Some(gradient) = gradient {
            for (j, slope) in gradient.iter_mut().enumerate() {
                let slopes = goal.jacobian.column(j).dot(&goal.residuals);
                *slope = 2.0 * share * slopes * self.half[j];
            }
        }
        2.0 * share * goal.cost()
    }

    fn row(&mut self, row: usize, z: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        self.look(z);
        if self.refused {
            return f64::INFINITY;
        }
        let rows = &self.at.rows;
        if let Some(gradient) = gradient {
            for (j, slope) in gradient.iter_mut().enumerate() {
                *slope = rows.jacobian[(row, j)] * self.half[j];
            }
        }
        rows.residuals[row]
    }

    fn ended(mut self, z: &[f64], said: String) -> End {
        let x = DVector::from_fn(z.len(), |j, _| z[j] * self.half[j]);
        let points = std::mem::take(&mut self.points);
        let away = points.iter().map(|point| {
            let apart = point.iter().zip(z).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, larger)
        });
        let away = away.collect();
        self.look(z);
        End {
            x,
            misfit: self.at.goal.misfit(),
            violation: self.at.violation(0, &[]),
            away,
            said,
        }
    }
}

/// Runs the crate `slsqp` from `start` (coordinates in units of half the range of each variable). The run ends when the
/// crate's own criteria are met at ten digits.
pub(super) fn slsqp(random: &Random, start: &DVector<f64>) -> End {
    let looked = RefCell::new(Looked::new(random));
    let n = start.len();
    let half = looked.borrow().half.clone();
    let z: Vec<f64> = (0..n).map(|j| start[j] / half[j]).collect();
    let (lower, upper) = (random.bounds.lower(), random.bounds.upper());
    let bounds: Vec<(f64, f64)> = (0..n)
        .map(|j| (lower[j] / half[j], upper[j] / half[j]))
        .collect();
    let goal = |z: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| {
        looked.borrow_mut().goal(z, gradient)
    };
    let rows = random.layout.labels().len();
    let rows: Vec<_> = (0..rows)
        .map(|row| {
            let looked = &looked;
            move |z: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| {
                looked.borrow_mut().row(row, z, gradient)
            }
        })
        .collect();
    let rows: Vec<&dyn slsqp::Func<()>> = rows.iter().map(|r| r as &dyn slsqp::Func<()>).collect();
    let stop = slsqp::StopTols {
        ftol_rel: 1e-10,
        xtol_rel: 1e-10,
        ..Default::default()
    };
    let (z, said) = match slsqp::minimize(goal, &z, &bounds, &rows, (), 500, Some(stop)) {
        Ok((status, z, _)) => (z, format!("{status:?}")),
        Err((status, z, _)) => (z, format!("{status:?}")),
    };
    drop(rows);
    looked.into_inner().ended(&z, said)
}

/// Runs the method of multipliers from `start` (D. P. Bertsekas, Constrained optimization and Lagrange multiplier
/// methods, 1982) with projected BFGS steps. This method is slow but reliable.
fn multipliers(random: &Random, start: &DVector<f64>) -> End {
    let mut looked = Looked::new(random);
    let n = start.len();
    let rows = random.layout.labels().len();
    let (lower, upper) = (random.bounds.lower(), random.bounds.upper());
    let half = looked.half.clone();
    let clamped = |z: DVector<f64>| {
        DVector::from_fn(n, |j, _| z[j].clamp(lower[j] / half[j], upper[j] / half[j]))
    };
    let mut weights = vec![0.0; rows];
    let mut penalty = 10.0;
    let mut z = clamped(DVector::from_fn(n, |j, _| start[j] / half[j]));
    // Squared misfit plus augmented Lagrangian terms of the constraints, and the slope of this sum.
    let value = |looked: &mut Looked, z: &DVector<f64>, weights: &[f64], penalty: f64| {
        let mut slope = vec![0.0; n];
        let mut value = looked.goal(z.as_slice(), Some(&mut slope));
        if !value.is_finite() {
            return None;
        }
        let rows = &looked.at.rows;
        for (row, weight) in weights.iter().enumerate() {
            let push = (weight + penalty * rows.residuals[row]).max(0.0);
            value += (push * push - weight * weight) / (2.0 * penalty);
            if push > 0.0 {
                for (j, slope) in slope.iter_mut().enumerate() {
                    *slope += push * rows.jacobian[(row, j)] * half[j];
                }
            }
        }
        Some((value, DVector::from_vec(slope)))
    };
    for _ in 0..40 {
        let mut inverse = nalgebra::DMatrix::<f64>::identity(n, n);
        let (mut cost, mut gradient) = value(&mut looked, &z, &weights, penalty).unwrap();
        for _ in 0..300 {
            let free = DVector::from_fn(n, |j, _| {
                let at_low = z[j] <= lower[j] / half[j] && gradient[j] > 0.0;
                let at_high = z[j] >= upper[j] / half[j] && gradient[j] < 0.0;
                f64::from(u8::from(!at_low && !at_high))
            });
            let projected = gradient.component_mul(&free);
            if projected.amax() < 1e-10 * cost.max(1.0) {
                break;
            }
            let mut direction = -(&inverse * &projected).component_mul(&free);
            if direction.dot(&projected) > -1e-14 * direction.norm() * projected.norm() {
                inverse = nalgebra::DMatrix::identity(n, n);
                direction = -projected.clone();
            }
            let lengths = (0..40).map(|k| 0.5_f64.powi(k));
            let found = lengths.into_iter().find_map(|length| {
                let trial = clamped(&z + &direction * length);
                let (at, slope) = value(&mut looked, &trial, &weights, penalty)?;
                let enough = at <= cost + 1e-4 * projected.dot(&(&trial - &z));
                enough.then_some((trial, at, slope))
            });
            let Some((next, at, slope)) = found else {
                break;
            };
            let (step, change) = (&next - &z, &slope - &gradient);
            let along = step.dot(&change);
            if along > 1e-12 * step.norm() * change.norm() {
                let image = &inverse * &change;
                let factor = (1.0 + change.dot(&image) / along) / along;
                inverse += &step * step.transpose() * factor
                    - (&image * step.transpose() + &step * image.transpose()) / along;
            }
            let stalled = cost - at <= 1e-15 * cost;
            (z, cost, gradient) = (next, at, slope);
            if stalled {
                break;
            }
        }
        looked.look(z.as_slice());
        let residuals = looked.at.rows.residuals.clone();
        for (weight, c) in weights.iter_mut().zip(residuals.iter()) {
            *weight = (*weight + penalty * c).max(0.0);
        }
        if residuals.max() < 1e-9 {
            break;
        }
        penalty = (penalty * 2.0).min(1e6);
    }
    looked.ended(z.as_slice(), "multipliers".to_owned())
}

/// Comparison of the end of this program's search with the ends of the other methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// The ends coincide, or have equally low misfits at different points.
    AsLow,
    /// This program's misfit is lower, and the other method ended elsewhere.
    Lower,
    /// The other methods satisfied the constraints only when started at the end of this program's search, and found no
    /// lower misfit from that point.
    NothingLowerThere,
    /// The other method has a lower misfit at another point. When started at that point, this program keeps or lowers
    /// the misfit.
    Elsewhere,
    /// No method satisfied the constraints. Or only this program did, and the other methods violated them even when
    /// started at the end of this program's search.
    Undecided,
    /// The other method has a lower misfit. When started at the end of the other method, this program ends with a
    /// higher misfit.
    Worse,
    /// The other method satisfies the constraints, but this program does not.
    Lost,
}

/// Problem solved by all methods.
struct Compared {
    verdict: Verdict,
    ours: ConstrainedFit,
    slsqp: End,
}

fn compared(random: &Random) -> Compared {
    let start = random
        .bounds
        .nearest(&DVector::zeros(random.bounds.variables()));
    let ours = random.ours(&start);
    let first = slsqp(random, &start);
    let other = if first.is_feasible() {
        first.clone()
    } else {
        multipliers(random, &start)
    };
    let misfit = ours.at.goal.misfit();
    let keeps = ours.violation <= KEPT;
    let verdict = match (keeps, other.is_feasible()) {
        (false, true) => Verdict::Lost,
        (false, false) => Verdict::Undecided,
        (true, true) if misfit < other.misfit - AS_LOW => Verdict::Lower,
        (true, true) if misfit <= other.misfit + AS_LOW => Verdict::AsLow,
        (true, true) => {
            let again = random.ours(&other.x);
            let keeps = again.violation <= KEPT && again.at.goal.misfit() <= other.misfit + AS_LOW;
            if keeps {
                Verdict::Elsewhere
            } else {
                Verdict::Worse
            }
        }
        (true, false) => {
            let from_ours = [slsqp(random, &ours.x), multipliers(random, &ours.x)];
            let kept: Vec<&End> = from_ours.iter().filter(|e| e.is_feasible()).collect();
            match kept.iter().all(|end| misfit <= end.misfit + AS_LOW) {
                _ if kept.is_empty() => Verdict::Undecided,
                true => Verdict::NothingLowerThere,
                false => Verdict::Worse,
            }
        }
    };
    Compared {
        verdict,
        ours,
        slsqp: first,
    }
}

#[test]
#[ignore = "forty problems by slow methods"]
fn forty_constrained_minima_are_those_of_independent_methods() {
    let mut verdicts = std::collections::BTreeMap::<Verdict, Vec<u64>>::new();
    let mut active = std::collections::BTreeMap::<String, usize>::new();
    for number in 0..40 {
        let random = Random::new(number);
        let found = compared(&random);
        println!(
            "{number}: {} variables {:?} ours {:.9} {:.1e} {} ({}), slsqp {:.9} {:.1e} {} ({})",
            random.bounds.variables(),
            found.verdict,
            found.ours.at.goal.misfit(),
            found.ours.violation,
            found.ours.evaluations(),
            found.ours.termination,
            found.slsqp.misfit,
            found.slsqp.violation,
            found.slsqp.away.len(),
            found.slsqp.said
        );
        verdicts.entry(found.verdict).or_default().push(number);
        let labels = random.layout.labels().iter().zip(&found.ours.multipliers);
        let held: std::collections::BTreeSet<usize> = labels
            .filter(|(_, multiplier)| **multiplier > 0.0)
            .map(|(label, _)| label.constraint)
            .collect();
        for constraint in held {
            let names = &random.study.optimise.as_ref().unwrap().constraints;
            let name = names[constraint].name.split(' ').next().unwrap();
            *active.entry(name.to_owned()).or_default() += 1;
        }
    }
    println!("40 problems: {verdicts:?}; held: {active:?}");
    let count = |verdict| verdicts.get(&verdict).map_or(0, Vec::len);
    assert_eq!(count(Verdict::Worse) + count(Verdict::Lost), 0);
    assert!(count(Verdict::Elsewhere) <= 4);
    assert!(count(Verdict::Undecided) + count(Verdict::NothingLowerThere) <= 2);
    // Constraints that are never active would test nothing.
    for kind in [
        "length",
        "tie_rod_outer",
        "toe",
        "lower_ball_joint",
        "clearance",
    ] {
        assert!(active.get(kind).is_some_and(|count| *count >= 5), "{kind}");
    }
}

/// Numbers of evaluations of a problem. `ours` counts all evaluations of this program. `other` has two counts of the
/// other method: until it reaches six digits of the ranges, and in total.
struct Evaluations {
    ours: u64,
    other: Option<[u64; 2]>,
}

/// Results of the solved problems.
#[derive(Default)]
struct Course {
    kept: usize,
    balanced: usize,
    refused: usize,
    /// Numbers of evaluations, one entry for each problem.
    evaluations: Vec<Evaluations>,
}

impl Course {
    /// Solves the problems with these numbers. If `others` is true, also solves them with the crate `slsqp`.
    fn of(numbers: std::ops::Range<u64>, problem: fn(u64) -> Random, others: bool) -> Self {
        let mut course = Course::default();
        for number in numbers {
            let random = problem(number);
            let start = random
                .bounds
                .nearest(&DVector::zeros(random.bounds.variables()));
            let ours = random.ours(&start);
            if ours.violation > KEPT {
                course.refused += 1;
                println!(
                    "{number}: cannot be kept: {:.1e} {}",
                    ours.violation, ours.termination
                );
                continue;
            }
            course.kept += 1;
            let is_balanced = ours.imbalance < 1e-6;
            course.balanced += usize::from(is_balanced);
            if !is_balanced {
                println!(
                    "{number}: {:.1e} {} {}",
                    ours.imbalance,
                    ours.evaluations(),
                    ours.termination
                );
            }
            let other = others.then(|| slsqp(&random, &start));
            let other = other.filter(End::is_feasible);
            course.evaluations.push(Evaluations {
                ours: ours.evaluations(),
                other: other.map(|end| [end.evaluations_to(1e-6), end.away.len() as u64]),
            });
        }
        course
    }

    /// Median numbers of evaluations: of this program, of the other method to six digits, and of the other method in
    /// total. Counts only problems that both methods solved within the constraints.
    fn medians(&self) -> [u64; 3] {
        let both = self.evaluations.iter();
        let both: Vec<[u64; 3]> = both
            .filter_map(|e| e.other.map(|[near, all]| [e.ours, near, all]))
            .collect();
        std::array::from_fn(|k| {
            let mut counts: Vec<u64> = both.iter().map(|counts| counts[k]).collect();
            counts.sort_unstable();
            counts[counts.len() / 2]
        })
    }

    /// Prints the results.
    fn say(&self) {
        let mut ours: Vec<u64> = self.evaluations.iter().map(|e| e.ours).collect();
        ours.sort_unstable();
        println!(
            "{} kept, {} balanced, {} cannot be kept; evaluations median {}, 95 % {}, most {}",
            self.kept,
            self.balanced,
            self.refused,
            ours[ours.len() / 2],
            ours[ours.len() * 95 / 100],
            ours[ours.len() - 1]
        );
    }
}

/// A design that satisfies the constraints at nine stations, and at the extremes between them, satisfies them
/// everywhere. Some limits are active at two positions at once. Others are active within the first or last interval.
#[test]
fn nothing_is_violated_between_stations() {
    let mut between = 0;
    for number in [13, 25, 40, 42, 50, 65, 71, 77] {
        let with = |stations: i32| {
            let mut study = Random::new(number).study;
            let step = 120.0 / f64::from(stations - 1);
            let values = (0..stations).map(|k| -60.0 + step * f64::from(k));
            study.one_wheel_mut().unwrap().motion.values = values.collect();
            Random::of(study)
        };
        let (coarse, fine) = (with(9), with(961));
        let ours = coarse.ours(&DVector::zeros(coarse.bounds.variables()));
        assert!(ours.violation <= KEPT, "{number}: {}", ours.termination);
        let at = fine.assessed(&ours.x);
        let violation = at.violation(0, &[]);
        assert!(violation < 1e-6, "{number}: {violation:e}");
        // Counts limits that are active only between the nine stations.
        let rows = fine.layout.labels().iter().zip(at.rows.residuals.iter());
        let reached = |row: usize| ours.multipliers[row] > 0.0;
        let labels = coarse.layout.labels();
        let held: Vec<_> = (0..labels.len())
            .filter(|row| reached(*row))
            .map(|r| labels[r])
            .collect();
        let same = |l: &hardpoint::optimise::RowLabel| {
            held.iter()
                .any(|h| h.part == l.part && h.is_upper == l.is_upper)
        };
        let mut most = std::collections::BTreeMap::<(usize, bool), f64>::new();
        for (label, value) in rows.filter(|(label, _)| same(label)) {
            if label.station.is_multiple_of(120) {
                let most = most
                    .entry((label.part, label.is_upper))
                    .or_insert(f64::NEG_INFINITY);
                *most = larger(*most, *value);
            }
        }
        between += most.values().filter(|most| **most < -1e-4).count();
    }
    assert!(between >= 6, "{between}");
}

/// If the constraints can be satisfied, the optimality conditions hold to a millionth: the multipliers balance the
/// gradient.
#[test]
fn multipliers_balance() {
    for problem in [Random::new, Random::of_design] {
        let course = Course::of(0..8, problem, false);
        let Course { kept, balanced, .. } = course;
        assert!(kept >= 7 && balanced == kept, "{kept} {balanced}");
    }
}

/// Prints the time of tuning six hundred random designs, in milliseconds. Prints separately: one start to the smallest
/// misfit, and the search back towards the nominal design.
#[test]
#[ignore = "six hundred designs, to be timed"]
fn times_of_six_hundred_designs() {
    let mut times = [Vec::new(), Vec::new()];
    for number in 0..600 {
        let Random { mut study, .. } = Random::of_design(number);
        let optimise = study.optimise.as_mut().unwrap();
        optimise.starts = 1;
        optimise.good_enough = 0.0;
        let least = std::time::Instant::now();
        let tuning = study.tune(Control::default()).unwrap();
        let least = least.elapsed().as_secs_f64();
        if !tuning
            .starts
            .best_fit()
            .is_some_and(|fit| fit.is_feasible())
        {
            continue;
        }
        study.optimise.as_mut().unwrap().good_enough = 0.1;
        let nearest = std::time::Instant::now();
        study.tune(Control::default()).unwrap();
        let nearest = nearest.elapsed().as_secs_f64();
        times[0].push(1e3 * least);
        times[1].push(1e3 * (nearest - least).max(0.0));
    }
    for (what, mut times) in ["a start", "the way back"].into_iter().zip(times) {
        times.sort_by(f64::total_cmp);
        let [median, most] = [2, 20].map(|part| times[times.len() - 1 - times.len() / part]);
        println!(
            "{} designs, {what}: median {median:.2} ms, 95 % {most:.2} ms",
            times.len()
        );
    }
}

/// For at least 99 % of six hundred random designs, the multipliers balance the gradient to a millionth. The median
/// number of evaluations is at most a fifth of that of `slsqp`.
#[test]
#[ignore = "six hundred problems by two methods"]
fn multipliers_of_six_hundred_designs_balance() {
    let course = Course::of(0..600, Random::of_design, true);
    course.say();
    let ended = course.evaluations.iter().filter(|e| e.other.is_some());
    let ended = ended.count();
    let [ours, near, all] = course.medians();
    println!("slsqp kept {ended}: {near} evaluations to six digits, {all} in all; ours {ours}");
    assert!(course.kept >= 590 && course.balanced * 100 >= course.kept * 99);
    assert!(ended >= 500 && 5 * ours <= all, "{ours} {near} {all}");
}

/// For at least 99 % of six hundred problems of two to twelve variables, the multipliers balance the gradient to a
/// millionth.
#[test]
#[ignore = "six hundred problems"]
fn multipliers_of_six_hundred_problems_balance() {
    let course = Course::of(0..600, Random::new, false);
    course.say();
    assert!(course.kept >= 590 && course.balanced * 100 >= course.kept * 99);
}
