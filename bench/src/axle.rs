//! Axle poses per second: designs of both wheels over the study's motion, as in a sweep.
//!
//! A design moves every hardpoint of both wheels, in mirror image, by up to ten millimetres. A pose is one position of the whole
//! axle. The evaluators are the same as in sweeps and in [`DesignFunction`].

use super::throughput::Measurement;
use super::{Clock, Job, Timing, Unmeasurable};
use hardpoint_engine::axle::Quantity;
use hardpoint_engine::evaluate::BLOCK;
use hardpoint_engine::number::Width;
use hardpoint_engine::study::{AxleStudy, Designs, FileFormat, Sampled, Sampling, Study, Sweep};
use hardpoint_engine::sweep::{NotBegun, SweepPlan, Worker, uniform};
use hardpoint_engine::{DesignFunction, DesignStatus, DesignVariable, FunctionError};
use std::hint::black_box;
use std::sync::Mutex;

/// Number of blocks of designs that one CPU thread solves in SIMD lanes per timing sample.
const BLOCKS: u64 = 8;
/// Number of designs that slow methods solve.
const FEW: u64 = 16;

const ANGLES: &str = "four angles of both wheels";
const OUTPUTS: &str = "outputs of the study";
const JACOBIAN: &str = "derivatives of four angles of both wheels by every hardpoint";
const ONE_BY_ONE: &str = "one by one";

/// Quantities of one benchmark, with a sweep of many designs and a sweep of few designs.
struct Question<'s> {
    asked: &'static str,
    many: SweepPlan<'s>,
    few: SweepPlan<'s>,
}

/// Measures an axle over its motion, on up to `threads` CPU threads.
pub(super) fn measure(
    study: &Study,
    both: &AxleStudy,
    threads: usize,
    clock: &Clock,
) -> Result<Vec<Measurement>, Unmeasurable> {
    let names = ["camber", "toe", "kingpin_inclination", "caster"];
    let angles = names.iter().flat_map(|name| Quantity::named(name));
    let angles: Vec<Quantity> = angles.filter(|q| both.axle.has(*q)).collect();
    let of_angles = asking(study, angles);
    let of_outputs = asking(study, both.plan.quantities.clone());
    let variables = DesignVariable::of(&of_angles);
    let sweeps = [BLOCKS * BLOCK as u64, FEW].map(|samples| sweep(&variables, samples));
    let mut questions = Vec::new();
    for (asked, study) in [(ANGLES, &of_angles), (OUTPUTS, &of_outputs)] {
        let [many, few] = sweeps.each_ref().map(|sweep| SweepPlan::of(study, sweep));
        questions.push(Question {
            asked,
            many: many.map_err(unmeasurable)?,
            few: few.map_err(unmeasurable)?,
        });
    }
    let mut found = Vec::new();
    let mut jobs: Vec<Job<'_>> = Vec::new();
    for question in &questions {
        for width in Width::available() {
            let worker = question.many.worker_of_width(Some(width))?;
            if worker.not_in_lanes().is_none() {
                found.push((question.asked, format!("lanes, {}", width.name()), 1));
                jobs.push(of_one_thread(&question.many, worker));
            }
        }
        found.push((question.asked, ONE_BY_ONE.to_owned(), 1));
        let worker = question.few.worker_of_width(None)?;
        jobs.push(of_one_thread(&question.few, worker));
    }
    found.push((JACOBIAN, ONE_BY_ONE.to_owned(), 1));
    jobs.push(jacobians(&of_angles, variables)?);
    let mut timings = clock.in_rounds(&mut jobs);
    // A job with several CPU threads is measured alone, not in turn with other jobs.
    let many = &questions[0].many;
    let method = match (Width::widest(), many.worker()?.not_in_lanes()) {
        (Some(width), None) => format!("lanes, {}", width.name()),
        _ => ONE_BY_ONE.to_owned(),
    };
    let most = threads;
    for threads in 2..=most {
        found.push((ANGLES, method.clone(), threads));
        let job = of_threads(many, threads).map_err(|reason| reason.up_to(most))?;
        timings.extend(clock.in_rounds(&mut [job]));
    }
    let measurement = |((asked, method, threads), timing): ((_, _, _), Timing)| Measurement {
        asked,
        method,
        threads,
        timing,
    };
    Ok(found.into_iter().zip(timings).map(measurement).collect())
}

/// Copy of the study that requests only these quantities.
fn asking(study: &Study, quantities: Vec<Quantity>) -> Study {
    let mut asking = study.clone();
    asking.optimise = None;
    asking.sweep = None;
    if let Some(both) = asking.axle_mut() {
        both.plan = both.plan.quantities_alone();
        both.plan.quantities = quantities;
    }
    asking
}

/// A random sweep with this number of designs.
fn sweep(variables: &[DesignVariable], samples: u64) -> Sweep {
    let variables = variables.iter().filter_map(DesignVariable::swept_as);
    Sweep {
        designs: Designs::Sampled(Sampled {
            method: Sampling::Random,
            samples,
            seed: 1,
            variables: variables.collect(),
        }),
        curves: false,
        format: FileFormat::Csv,
        constraints: false,
    }
}

fn unmeasurable(reason: NotBegun) -> Unmeasurable {
    match reason {
        NotBegun::Fault(fault) => Unmeasurable::Design(fault),
        NotBegun::Columns(fault) => Unmeasurable::Columns(fault),
        NotBegun::Designs(errors) => unreachable!("designs are sampled: {errors}"),
    }
}

/// Number of poses of all designs of a plan.
fn poses(plan: &SweepPlan) -> usize {
    plan.record.designs as usize * plan.stations().count()
}

/// Solves every design of a plan.
fn solve_all(plan: &SweepPlan, worker: &mut Worker) {
    for block in 0..plan.record.designs.div_ceil(BLOCK as u64) {
        black_box(worker.rows(block));
    }
}

fn of_one_thread<'p>(plan: &'p SweepPlan<'p>, mut worker: Worker<'p>) -> Job<'p> {
    Job {
        items: poses(plan),
        work: Box::new(move || solve_all(plan, &mut worker)),
    }
}

/// Makes a job for several CPU threads. Each thread solves every design, so the number of poses grows with the number of
/// threads.
fn of_threads<'p>(plan: &'p SweepPlan<'p>, threads: usize) -> Result<Job<'p>, Unmeasurable> {
    let pool = hardpoint_engine::threads::pool(threads);
    let pool = pool.map_err(|_| Unmeasurable::threads(threads))?;
    let workers: Result<Vec<_>, _> = (0..threads)
        .map(|_| plan.worker().map(Mutex::new))
        .collect();
    let workers = workers?;
    Ok(Job {
        items: threads * poses(plan),
        work: Box::new(move || {
            pool.broadcast(|thread| {
                let worker = workers[thread.index()].lock();
                solve_all(plan, &mut worker.expect("no thread has panicked"));
            });
        }),
    })
}

/// Makes a job that computes values with exact derivatives with respect to every hardpoint coordinate.
fn jacobians<'p>(study: &Study, variables: Vec<DesignVariable>) -> Result<Job<'p>, Unmeasurable> {
    let function = DesignFunction::with_variables(study, variables);
    let function =
        function.map_err(|reason: FunctionError| Unmeasurable::Axle(reason.to_string()))?;
    let width = function.variables().len();
    let designs = FEW as usize;
    let x: Vec<f64> = (0..designs * width)
        .map(|k| {
            let (design, variable) = (k / width, k % width);
            let [low, high] = function.variables()[variable].range();
            low + (high - low) * uniform(design as u64, variable, 1)
        })
        .collect();
    let mut values = vec![0.0; designs * function.len()];
    let mut jacobian = vec![0.0; values.len() * width];
    let mut status = vec![DesignStatus::Ok; designs];
    Ok(Job {
        items: designs * function.stations(),
        work: Box::new(move || {
            let mut evaluation = function.evaluation();
            evaluation.value_and_jacobian(&x, &mut values, &mut jacobian, &mut status);
            black_box(&jacobian);
        }),
    })
}
