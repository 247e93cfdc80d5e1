//! Limits of a design, and the nearest limits among builds.

use crate::answers::{rigid, tolerance_of};
use crate::errors::failure;
use crate::study::Study;
use crate::threads::{interruptible, on_threads};
use hardpoint::analyse::{Range, RangeEnd};
use hardpoint::axle::{Axle, AxleEnd, TravelRanges};
use hardpoint::model::{Axis, Suspension};
use hardpoint::scatter;
use hardpoint::solve::Solver;
use hardpoint::study::Vehicle;
use hardpoint::tolerance::Problem;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Value of one end of a range, and the cause of this limit. A quantity that can turn a full circle ends at half a turn on either
/// side.
type End = (f64, String);

/// Lower and upper end of each quantity, by name. `None` if nothing moves the quantity, or if its range is unknown.
type Ranges = Vec<(&'static str, Option<[End; 2]>)>;

/// Lower and upper end of each quantity, each with the number of the build that has it.
type NearestRanges<'py> = Bound<'py, PyDict>;

/// Limits of a wheel (travel, rack and arm angle) or of an axle (both travels, rack and roll): (lower, upper) with their causes.
#[pyfunction]
pub(crate) fn limits<'py>(py: Python<'py>, study: &Study) -> PyResult<Bound<'py, PyDict>> {
    let own = rigid(&study.study, "limits")?;
    let found = on_threads(py, Some(1), |_| match &own.vehicle {
        Vehicle::Wheel(own) => of_wheel(&own.suspension),
        Vehicle::Axle(both) => of_axle(&both.axle),
    })?;
    let result = PyDict::new(py);
    for (name, ends) in found.map_err(failure)? {
        result.set_item(name, ends)?;
    }
    Ok(result)
}

/// Nearest limits among the first builds of `[tolerance]`: (lower, upper), each with its cause and its build. Also returns the
/// number of builds that cannot be assembled. `progress(done, all)` is called on this thread.
#[pyfunction]
#[pyo3(signature = (study, builds, threads=None, progress=None))]
pub(crate) fn limits_of_builds<'py>(
    py: Python<'py>,
    study: &Study,
    builds: u64,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(NearestRanges<'py>, u64)> {
    if builds == 0 {
        return Err(failure("builds is 0; expected at least 1"));
    }
    let own = rigid(study.whole(), "limits")?;
    let tolerance = tolerance_of(own)?;
    let done = AtomicU64::new(0);
    let work = |flag: &AtomicBool| -> Result<Nearest, String> {
        let problem = Problem::of(own, tolerance).map_err(|why| scatter::refusal(own, why))?;
        let one = |number| {
            done.fetch_add(1, Ordering::Relaxed);
            Nearest::of(number, of_build(own, &problem, number))
        };
        let all = (0..builds).into_par_iter();
        let heard = all.take_any_while(|_| !flag.load(Ordering::Relaxed));
        Ok(heard.map(one).reduce(Nearest::default, Nearest::and))
    };
    let listen = |_: Python<'_>, _: &AtomicBool| match &progress {
        None => Ok(()),
        Some(progress) => {
            let done = done.load(Ordering::Relaxed);
            progress.call1((done, builds)).map(drop)
        }
    };
    let found = interruptible(py, threads, work, listen)?.map_err(failure)?;
    let result = PyDict::new(py);
    for (name, ends) in found.ranges {
        let ends = ends.map(|ends| ends.map(|((value, cause), build)| (value, cause, build)));
        result.set_item(name, ends)?;
    }
    Ok((result, found.rejected))
}

/// Limits of one build. `None` if it cannot be assembled or cannot move.
fn of_build(own: &hardpoint::Study, problem: &Problem, number: u64) -> Option<Ranges> {
    let mut wheels = problem.built_wheels(number).ok()?.into_iter();
    let left = wheels.next()?;
    match &own.vehicle {
        Vehicle::Wheel(_) => of_wheel(&left).ok(),
        Vehicle::Axle(both) => of_axle(&both.axle.with_wheels(left, wheels.next())).ok(),
    }
}

fn of_wheel(suspension: &Suspension) -> Result<Ranges, String> {
    let solver = Solver::new(&suspension.mechanism, &suspension.design);
    let found = solver.and_then(|mut solver| solver.limits());
    let found = found.map_err(|fault| fault.describe(&suspension.mechanism))?;
    let range =
        |range: &Range, factor: f64| ends([&range.lower, &range.upper].map(cause_of), factor);
    let sign = suspension.frame.sign(Axis::Y);
    let degrees = 1.0_f64.to_degrees();
    Ok(vec![
        ("travel", Some(range(&found.travel, 1.0))),
        ("rack", found.rack.as_ref().map(|r| range(r, sign))),
        (
            "arm_angle_deg",
            found.arm_angle.as_ref().map(|r| range(r, degrees)),
        ),
    ])
}

fn of_axle(axle: &Axle) -> Result<Ranges, String> {
    let found = axle.limits().map_err(|fault| axle.describe_fault(fault))?;
    let range =
        |range: &Range, factor: f64| ends([&range.lower, &range.upper].map(cause_of), factor);
    let mut ranges: Ranges = match &found.travels {
        TravelRanges::OfWheels([left, right]) => vec![
            ("left_travel", Some(range(left, 1.0))),
            ("right_travel", Some(range(right, 1.0))),
        ],
        TravelRanges::OfAxle {
            heave,
            half_difference,
        } => vec![
            ("heave", Some(range(heave, 1.0))),
            ("travel_difference", Some(range(half_difference, 2.0))),
        ],
    };
    let end = |end: &AxleEnd| {
        let (_, cause) = cause_of(&end.end);
        let cause = if axle.is_rigid() {
            cause
        } else {
            format!("{} wheel: {cause}", end.side.name())
        };
        (end.value, cause)
    };
    let sign = axle.left.frame.sign(Axis::Y);
    let rack = found.rack.as_ref();
    let roll = match &found.roll {
        [Some(lower), Some(upper)] => Some([lower, upper].map(end)),
        _ => None,
    };
    ranges.extend([
        (
            "rack",
            rack.map(|both| ends(both.each_ref().map(end), sign)),
        ),
        (
            "roll_deg",
            roll.map(|both| ends(both, 1.0_f64.to_degrees())),
        ),
    ]);
    Ok(ranges)
}

/// Value of an end and its cause. The value is NaN if the quantity turns without an end.
fn cause_of(end: &RangeEnd) -> End {
    match end {
        RangeEnd::Fold(limit) => (end.value(), limit.cause.to_string()),
        RangeEnd::FullTurn => (f64::NAN, "turns right round".to_owned()),
        RangeEnd::Toggle { rod, .. } => (end.value(), format!("the {rod} is at toggle")),
        RangeEnd::Unresolved(_) => {
            let cause = "the path could not be followed any further";
            (end.value(), cause.to_owned())
        }
    }
}

/// Both ends as printed values, the lower one first.
fn ends([lower, upper]: [End; 2], factor: f64) -> [End; 2] {
    let half_turn = std::f64::consts::PI;
    let printed = |(value, cause): End, otherwise: f64| {
        let value = if value.is_nan() { otherwise } else { value };
        (value * factor, cause)
    };
    let [lower, upper] = [printed(lower, -half_turn), printed(upper, half_turn)];
    if factor < 0.0 {
        [upper, lower]
    } else {
        [lower, upper]
    }
}

/// Nearest limits among some builds. If limits are equal, the first build counts.
#[derive(Default)]
struct Nearest {
    ranges: Vec<(&'static str, Option<[(End, u64); 2]>)>,
    /// Number of builds that cannot be assembled or cannot move.
    rejected: u64,
}

impl Nearest {
    fn of(build: u64, ranges: Option<Ranges>) -> Self {
        let rejected = u64::from(ranges.is_none());
        let numbered =
            |(name, ends): (_, Option<[End; 2]>)| (name, ends.map(|e| e.map(|end| (end, build))));
        let ranges = ranges.into_iter().flatten().map(numbered);
        Nearest {
            ranges: ranges.collect(),
            rejected,
        }
    }

    /// Merges these limits with the limits of builds that have higher numbers.
    fn and(mut self, later: Nearest) -> Nearest {
        self.rejected += later.rejected;
        if self.ranges.is_empty() {
            self.ranges = later.ranges;
            return self;
        }
        for ((_, mine), (_, theirs)) in self.ranges.iter_mut().zip(later.ranges) {
            let (Some([lower, upper]), Some([later_lower, later_upper])) =
                (mine.as_mut(), theirs.as_ref())
            else {
                *mine = mine.take().or(theirs);
                continue;
            };
            if later_lower.0.0 > lower.0.0 {
                *lower = later_lower.clone();
            }
            if later_upper.0.0 < upper.0.0 {
                *upper = later_upper.clone();
            }
        }
        self
    }
}
