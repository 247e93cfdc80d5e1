//! Solved states of a car per second: started from a neighbouring state, started without one, and in SIMD lanes. Further jobs
//! add results, member loads and derivatives. Two more jobs compute a whole map on two threads, and a tuning.

use super::{Clock, Job, JobTime, Unmeasurable};
use hardpoint_engine::car::{
    Car, CarQuantity, CarSolver, Case, Equilibrium, WheelPlace, WheelResult,
};
use hardpoint_engine::optimise::Control;
use hardpoint_engine::study::{CarStudy, GgMap};
use hardpoint_engine::threads::pool;
use std::hint::black_box;

/// Number of accelerations on each axis of the g-g map (a map over forward and lateral acceleration), if the study has none.
const COUNT: usize = 9;
/// Range of the forward acceleration in the default g-g map, g.
const AX: [f64; 2] = [-0.6, 0.3];
/// Range of the lateral acceleration in the default g-g map, g.
const AY: [f64; 2] = [0.0, 0.6];

/// Computing times of the states of a car.
#[derive(Clone, Debug, PartialEq)]
pub struct Cars {
    /// Measured time of each job.
    pub measurements: Vec<JobTime>,
}

/// Number of accelerations on each axis of the g-g map that is timed as a whole.
const WHOLE: usize = 41;
/// Largest number of timing samples for the g-g map that is timed as a whole.
const WHOLE_SAMPLES: usize = 5;
/// Number of CPU threads that solve the g-g map that is timed as a whole.
const THREADS: usize = 2;

/// Evenly spaced numbers from `from` to `to`.
fn between([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    let at = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
    (0..count).map(at).collect()
}

/// Load cases of the study's g-g map or of the default map, row by row. All cases of a row have the same forward acceleration ax.
/// Neighbouring cases of a row have neighbouring lateral accelerations ay. If `count` is given, it replaces the numbers of
/// accelerations of the map.
fn map(study: &CarStudy, count: Option<usize>) -> Vec<Vec<Case>> {
    let usual = || {
        let mut case = Case::at_rest("map");
        case.setting.elastic_tyres = study.car.tyres.is_some();
        GgMap {
            ax: between(AX, COUNT),
            ay: between(AY, COUNT),
            case,
        }
    };
    let mut map = study.gg_map.clone().unwrap_or_else(usual);
    for axis in [&mut map.ax, &mut map.ay] {
        if let (Some(count), Some(first), Some(last)) = (count, axis.first(), axis.last()) {
            *axis = between([*first, *last], count);
        }
    }
    let row = |ax: &f64| map.ay.iter().map(|ay| map.at(*ax, *ay)).collect();
    map.ax.iter().map(row).collect()
}

/// A load case that has a state, with the state of the previous case in the same row.
struct Step {
    case: Case,
    found: Equilibrium,
    before: Option<Equilibrium>,
}

/// Solves the load cases of a row, each from the state of the previous case. `take` receives each case with a state, this
/// state, and the previous state.
fn along<'c>(
    solver: &mut CarSolver<'c>,
    row: &[Case],
    mut take: impl FnMut(&mut CarSolver<'c>, &Case, &Equilibrium, Option<&Equilibrium>),
) {
    let mut before: Option<Equilibrium> = None;
    for case in row {
        let found = match &before {
            Some(before) => solver.solve_from(case, before),
            None => solver.solve(case),
        };
        if let Ok(found) = found {
            take(solver, case, &found, before.as_ref());
            before = Some(found);
        }
    }
}

/// The load cases of a map that have a state.
fn steps(solver: &mut CarSolver<'_>, map: &[Vec<Case>]) -> Vec<Step> {
    let mut steps = Vec::new();
    for row in map {
        along(solver, row, |_, case, found, before| {
            steps.push(Step {
                case: case.clone(),
                found: found.clone(),
                before: before.cloned(),
            });
        });
    }
    steps
}

/// Solves the rows of a map on two CPU threads, each with its own solver, and calls `work` for every state.
fn on_two_threads(
    car: &Car,
    rows: &[Vec<Case>],
    work: impl Fn(&mut CarSolver<'_>, &Case, &Equilibrium) + Sync,
) {
    let part = |first: usize| {
        let Ok(mut solver) = CarSolver::new(car) else {
            return;
        };
        for row in rows.iter().skip(first).step_by(THREADS) {
            along(&mut solver, row, |solver, case, found, _| {
                work(solver, case, found)
            });
        }
    };
    match pool(THREADS) {
        Ok(pool) => _ = pool.broadcast(|thread| part(thread.index())),
        Err(_) => (0..THREADS).for_each(part),
    }
}

/// Makes a job that calls `work` for every one of these states.
fn each<'a>(steps: &'a [&Step], mut work: impl FnMut(&Step) + 'a) -> Job<'a> {
    Job {
        items: steps.len(),
        work: Box::new(move || steps.iter().for_each(|step| work(step))),
    }
}

/// Name of a job, and the job.
type NamedJob<'a> = (&'static str, Job<'a>);

/// Makes a solver of a car.
fn solver(car: &Car) -> Result<CarSolver<'_>, Unmeasurable> {
    let made = CarSolver::new(car);
    made.map_err(|fault| Unmeasurable::Car(car.describe_fault(&fault)))
}

/// Jobs that solve each state from its neighbour: the state alone, and the state with all results.
fn neighbour_jobs<'a>(
    car: &'a Car,
    followers: &'a [&Step],
    quantities: &'a [CarQuantity],
) -> Result<Vec<NamedJob<'a>>, Unmeasurable> {
    if followers.is_empty() {
        return Ok(Vec::new());
    }
    let mut own = solver(car)?;
    let alone = move |step: &Step| {
        if let Some(before) = &step.before
            && let Ok(found) = own.solve_from(&step.case, before)
        {
            _ = black_box(own.balance(&step.case, &found));
        }
    };
    let mut own = solver(car)?;
    let with_results = move |step: &Step| {
        if let Some(before) = &step.before
            && let Ok(found) = own.solve_from(&step.case, before)
        {
            printed(&mut own, quantities, &step.case, &found);
        }
    };
    Ok(vec![
        ("state started from its neighbour", each(followers, alone)),
        (
            "state with all results started from its neighbour",
            each(followers, with_results),
        ),
    ])
}

/// Jobs that solve single states without a neighbour, or compute results, member loads and derivatives of solved states.
fn state_jobs<'a>(
    car: &'a Car,
    states: &'a [&Step],
    quantities: &'a [CarQuantity],
) -> Result<Vec<NamedJob<'a>>, Unmeasurable> {
    let mut own = solver(car)?;
    let alone = move |step: &Step| _ = black_box(own.solve(&step.case));
    let mut own = solver(car)?;
    let results = move |step: &Step| printed(&mut own, quantities, &step.case, &step.found);
    let mut own = solver(car)?;
    let members = move |step: &Step| _ = black_box(own.members(&step.case, &step.found));
    let loads = WheelPlace::ALL.map(|place| CarQuantity::Wheel(place, WheelResult::Load));
    let mut own = solver(car)?;
    let of_loads = move |step: &Step| {
        _ = black_box(own.gradients(&step.case, &step.found, &loads));
    };
    let mut own = solver(car)?;
    let derivatives = move |step: &Step| {
        _ = black_box(own.gradients(&step.case, &step.found, quantities));
    };
    Ok(vec![
        ("state without a neighbour", each(states, alone)),
        ("all results of a state", each(states, results)),
        ("member loads of a state", each(states, members)),
        (
            "all derivatives of the wheel loads of a state",
            each(states, of_loads),
        ),
        (
            "all derivatives of all results of a state",
            each(states, derivatives),
        ),
    ])
}

impl Cars {
    /// Measures the computing times of the states of a car over its g-g map, or over a default map. If the study has a tuning,
    /// also measures the time of the tuning. Returns an error if a design cannot be solved, or if no state exists.
    pub fn measure(study: &CarStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let car = &study.car;
        let mut first = solver(car)?;
        let steps = steps(&mut first, &map(study, None));
        if steps.is_empty() {
            return Err(Unmeasurable::NoState);
        }
        let followers: Vec<&Step> = steps.iter().filter(|step| step.before.is_some()).collect();
        let some: Vec<&Step> = steps.iter().step_by(steps.len().div_ceil(8)).collect();
        let quantities = &CarQuantity::default_columns(car);
        let whole = map(study, Some(WHOLE));
        let rows: Vec<&[Case]> = whole.iter().map(Vec::as_slice).collect();
        let mut jobs = neighbour_jobs(car, &followers, quantities)?;
        let mut own = solver(car)?;
        let rows = &rows;
        let work = move || {
            own.solve_rows(rows, &mut |_, _, state| _ = black_box(state.is_ok()));
        };
        jobs.push((
            "state of an ax-ay map (rows of the map computed in SIMD lanes)",
            Job {
                items: WHOLE * WHOLE,
                work: Box::new(work),
            },
        ));
        jobs.extend(state_jobs(car, &some, quantities)?);
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
        let mut measurements: Vec<JobTime> = measured
            .map(|(job, timing)| JobTime { job, timing })
            .collect();
        measurements.push(whole_map(study, clock));
        Ok(Cars { measurements })
    }
}

/// Computes the printed value of each quantity in a state, for timing. Prints nothing.
fn printed(
    solver: &mut CarSolver<'_>,
    quantities: &[CarQuantity],
    case: &Case,
    found: &Equilibrium,
) {
    if let Ok(solved) = solver.solved(case, found) {
        let printed = quantities.iter().map(|of| of.printed(&solved, case));
        black_box(printed.flatten().sum::<f64>());
    }
}

/// Measures the computing time of a whole map with member loads.
fn whole_map(study: &CarStudy, clock: &Clock) -> JobTime {
    let rows = map(study, Some(WHOLE));
    let clock = Clock {
        samples: clock.samples.min(WHOLE_SAMPLES),
        ..*clock
    };
    let members = || {
        on_two_threads(&study.car, &rows, |solver, case, found| {
            _ = black_box(solver.members(case, found));
        });
    };
    JobTime {
        job: "map of 41 x 41 states with member loads on two threads",
        timing: clock.time(1, members),
    }
}
