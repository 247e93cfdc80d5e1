//! States of a car per second: from a neighbour, by themselves, with results, member loads and derivatives; and a tuning.

use super::{Clock, Job, JobTime, Unmeasurable};
use hardpoint_engine::car::{CarQuantity, CarSolver, Case, Equilibrium};
use hardpoint_engine::optimise::Control;
use hardpoint_engine::study::{CarStudy, GgMap};
use std::hint::black_box;

/// Number of accelerations of each axis, if the study has no g-g map.
const COUNT: usize = 9;
/// Accelerations forward and to the left in that case, g.
const AX: [f64; 2] = [-0.6, 0.3];
const AY: [f64; 2] = [0.0, 0.6];

/// Times of the states of a car.
#[derive(Clone, Debug, PartialEq)]
pub struct Cars {
    /// One time per job.
    pub measurements: Vec<JobTime>,
}

/// Cases of a map, row by row: each row has one ax, and each case follows its neighbour.
fn map(study: &CarStudy) -> Vec<Vec<Case>> {
    let between = |[from, to]: [f64; 2]| -> Vec<f64> {
        let at = |k: usize| from + (to - from) * k as f64 / (COUNT - 1) as f64;
        (0..COUNT).map(at).collect()
    };
    let usual = || {
        let mut case = Case::at_rest("map");
        case.setting.elastic_tyres = study.car.tyres.is_some();
        GgMap {
            ax: between(AX),
            ay: between(AY),
            case,
        }
    };
    let map = study.gg_map.clone().unwrap_or_else(usual);
    let row = |ax: &f64| map.ay.iter().map(|ay| map.at(*ax, *ay)).collect();
    map.ax.iter().map(row).collect()
}

/// A case that has a state, with the state before it in its row.
struct Step {
    case: Case,
    found: Equilibrium,
    before: Option<Equilibrium>,
}

/// The cases of a map that have a state.
fn steps(solver: &mut CarSolver<'_>, map: Vec<Vec<Case>>) -> Vec<Step> {
    let mut steps = Vec::new();
    for row in map {
        let mut before: Option<Equilibrium> = None;
        for case in row {
            let found = match &before {
                Some(before) => solver.solve_from(&case, before),
                None => solver.solve(&case),
            };
            let Ok(found) = found else { continue };
            steps.push(Step {
                case,
                found: found.clone(),
                before: before.replace(found),
            });
        }
    }
    steps
}

/// A job that works on every one of these states.
fn each<'a>(steps: &'a [&Step], mut work: impl FnMut(&Step) + 'a) -> Job<'a> {
    Job {
        items: steps.len(),
        work: Box::new(move || steps.iter().for_each(|step| work(step))),
    }
}

impl Cars {
    /// Times the states of a car over its g-g map, or over a usual one, and the tuning of the study, if it has one. Returns an
    /// error if a design cannot be solved, or if no state exists.
    pub fn measure(study: &CarStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let car = &study.car;
        let solver = || {
            let made = CarSolver::new(car);
            made.map_err(|fault| Unmeasurable::Car(car.describe_fault(&fault)))
        };
        let mut first = solver()?;
        let steps = steps(&mut first, map(study));
        if steps.is_empty() {
            return Err(Unmeasurable::NoState);
        }
        let followers: Vec<&Step> = steps.iter().filter(|step| step.before.is_some()).collect();
        let some: Vec<&Step> = steps.iter().step_by(steps.len().div_ceil(8)).collect();
        let quantities = &CarQuantity::default_columns(car);
        let mut jobs: Vec<(&str, Job<'_>)> = Vec::new();
        if !followers.is_empty() {
            let mut own = solver()?;
            let work = move |step: &Step| {
                if let Some(before) = &step.before {
                    _ = black_box(own.solve_from(&step.case, before));
                }
            };
            jobs.push(("state from its neighbour", each(&followers, work)));
        }
        let mut own = solver()?;
        let alone = move |step: &Step| _ = black_box(own.solve(&step.case));
        jobs.push(("state by itself", each(&some, alone)));
        let mut own = solver()?;
        let results = move |step: &Step| {
            if let Ok(solved) = own.solved(&step.case, &step.found) {
                let printed = quantities.iter().map(|of| of.printed(&solved, &step.case));
                black_box(printed.flatten().sum::<f64>());
            }
        };
        jobs.push(("all results of a state", each(&some, results)));
        let mut own = solver()?;
        let members = move |step: &Step| _ = black_box(own.members(&step.case, &step.found));
        jobs.push(("member loads of a state", each(&some, members)));
        let mut own = solver()?;
        let derivatives = move |step: &Step| {
            _ = black_box(own.gradients(&step.case, &step.found, quantities));
        };
        let name = "all derivatives of all results of a state";
        jobs.push((name, each(&some, derivatives)));
        if let Some(wanted) = &study.optimise {
            let work = || _ = black_box(study.tuned(wanted, Control::default()).is_ok());
            let job = Job {
                items: 1,
                work: Box::new(work),
            };
            jobs.push(("tuning of the study", job));
        }
        let (names, mut jobs): (Vec<_>, Vec<_>) = jobs.into_iter().unzip();
        let timings = clock.in_rounds(&mut jobs);
        let measured = names.into_iter().zip(timings);
        Ok(Cars {
            measurements: measured
                .map(|(job, timing)| JobTime { job, timing })
                .collect(),
        })
    }
}
