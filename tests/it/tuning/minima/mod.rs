//! Tests of constrained minima of random designs, against other methods from the same starts.
//!
//! The other methods are the crate `slsqp` (D. Kraft's sequential quadratic programs, from NLopt) and a method of
//! multipliers (`methods`). All methods use the same values with the same exact gradients.

mod course;
mod methods;

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
