//! Exact first- and second-order results of the tolerance analysis.
//!
//! The adjoint of the built design ([`crate::assembly::built_curves`]) gives the gradient g, for values and for gains. Taylor
//! series give the Hessian H. The deviations of the parts move along the direction d_j + d_k by a variable distance. The
//! built design, the poses and the values in these poses are Taylor series in this distance. The second coefficient of a
//! value is (H_jj + 2 H_jk + H_kk)/2. Quantities that contain velocities (gains, roll centres, anti-features, swing arms,
//! motion ratios) have no second-order result, because they would also need Taylor series in travel.

use super::{
    Estimate, Problem, Remainder, Spread, axle_expansion, axle_second, elastic, elastic_axle,
};
use crate::assembly::{BuildParameter, SetUpError, built_curves};
use crate::characteristics::{Constants, Slots, WheelReading};
use crate::derive::MotionPoint;
use crate::linear::lu::Lu6;
use crate::mechanism::{Closure, Configuration, Driver};
use crate::model::SteeringAxis;
use crate::number::Jet;
use crate::plan::Plan;
use crate::solve::{Solver, StationOrder};
use crate::study::{Law, Outputs, Source, WheelStudy};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Largest number of tolerance sources for which second derivatives are computed.
const MOST_SOURCES: usize = 120;

/// Mean and variance of every value, from the derivatives at the nominal design.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// Derivatives g, `[cell][tolerance source]`. A cell is the value of an output at a station.
    pub gradient: Vec<f64>,
    /// First-order variance of each cell (an output at a station).
    pub variance: Vec<f64>,
    /// First-order mean minus the nominal value, for each cell (an output at a station). The difference is 0 if all
    /// distributions are centred on 0.
    pub shift: Vec<f64>,
    /// Second-order terms of the mean and of the variance, for each cell (an output at a station). NaN if unknown.
    pub second: Vec<[f64; 2]>,
    sources: usize,
}

impl Expansion {
    /// Expands every value of a study about the nominal design. An error says why that design cannot be built or aligned.
    pub fn of(problem: &Problem) -> Result<Self, SetUpError> {
        let sources: Vec<_> = problem.tolerance.each_source().collect();
        let (count, cells) = (sources.len(), problem.cells());
        let (gradient, second) = match problem.request.axle() {
            // Second derivatives of equilibria are not computed.
            None if !problem.elastic.is_empty() => {
                let gradient = elastic::gradients(problem, &sources)?;
                (gradient, vec![[f64::NAN; 2]; cells])
            }
            None => of_wheel(problem, &sources)?,
            Some(stations) => match &stations.axle.elastic {
                Some(elastic) => {
                    let gradient = elastic_axle::gradients(problem, stations, elastic, &sources)?;
                    (gradient, vec![[f64::NAN; 2]; cells])
                }
                None => {
                    let gradient = axle_expansion::gradients(problem, &sources)?;
                    (gradient, axle_second::second(problem, stations)?)
                }
            },
        };
        let sum = |cell: usize, of: &dyn Fn(f64, &Law) -> f64| -> f64 {
            let row = &gradient[cell * count..(cell + 1) * count];
            row.iter()
                .zip(&sources)
                .map(|(g, source)| of(*g, &source.law))
                .sum()
        };
        let variance = (0..cells).map(|cell| sum(cell, &|g, law| g * g * law.variance()));
        let shift = (0..cells).map(|cell| sum(cell, &|g, law| g * law.mean()));
        let (variance, shift) = (variance.collect(), shift.collect());
        Ok(Expansion {
            second,
            gradient,
            variance,
            shift,
            sources: count,
        })
    }

    /// Derivatives of a value with respect to each tolerance source.
    pub fn gradient(&self, cell: usize) -> &[f64] {
        &self.gradient[cell * self.sources..(cell + 1) * self.sources]
    }

    /// Estimate of the scatter of a value.
    pub fn estimate(&self, cell: usize) -> Estimate {
        Estimate {
            variance: self.variance[cell],
            second: self.second[cell],
        }
    }

    /// Returns true if a value with this nominal value scatters ([`Estimate::scatters`]).
    pub fn scatters(&self, cell: usize, drawn: f64) -> bool {
        self.estimate(cell).scatters(drawn)
    }

    /// Returns true if the second-order term of the value's scatter is small. `None` if the term is unknown.
    pub fn holds(&self, cell: usize) -> Option<bool> {
        self.estimate(cell).is_straight()
    }

    /// Part of the builds' variance that first order does not explain.
    pub fn remainder(&self, cell: usize, spread: &Spread) -> Remainder {
        self.estimate(cell).remainder(spread)
    }

    /// First-order variance from a contributor, given by its index in the study.
    pub fn part(&self, problem: &Problem, cell: usize, contributor: usize) -> f64 {
        let mut gradient = self.gradient(cell).iter();
        let mut part = 0.0;
        for (number, c) in problem.tolerance.scatter.iter().enumerate() {
            for (source, g) in c.sources.iter().zip(gradient.by_ref()) {
                if number == contributor {
                    part += g * g * source.law.variance();
                }
            }
        }
        part
    }
}

/// First- and second-order results for one wheel. The first array holds the derivatives of every cell (an output at a
/// station) with respect to each tolerance source, `[cell][source]`. The second array holds the second-order terms of the
/// mean and the variance, `[cell]`.
fn of_wheel(
    problem: &Problem,
    sources: &[&Source],
) -> Result<(Vec<f64>, Vec<[f64; 2]>), SetUpError> {
    let wheel_assembler = &problem.wheel_assemblers[0];
    let assembler = &wheel_assembler.assembler;
    let built = assembler.build_drawn()?;
    let directions: Vec<Vec<(BuildParameter, f64)>> = sources
        .iter()
        .map(|source| wheel_assembler.direction(&built, source))
        .collect();
    let plan = plan(problem);
    let borrowed: Vec<&[_]> = directions.iter().map(|d| &d[..]).collect();
    let found = built_curves(assembler, &built, &plan, &borrowed)?;
    let count = sources.len();
    let mut gradient = vec![f64::NAN; problem.cells() * count];
    for output in 0..problem.outputs().len() {
        let factor = found.curves.columns[output].factor();
        for station in 0..problem.stations().count() {
            let cell = problem.cell(output, station);
            for source in 0..count {
                gradient[cell * count + source] =
                    found.derivative(source, station, output) / factor;
            }
        }
    }
    Ok((gradient, second(problem, &built)))
}

/// Plans the computation of all quantities at all stations.
fn plan(problem: &Problem) -> Plan {
    let mut own = WheelStudy::of(problem.wheel_assemblers[0].assembler.suspension().clone());
    own.outputs = Outputs::of(problem.characteristics().collect());
    let mut plan = Plan::of(&own);
    plan.rack_moves = problem.study.motion().rack_moves;
    plan.station_order = StationOrder::through(problem.stations().values());
    // The racks of the stations are in the kernel's axes.
    plan.racks = problem
        .stations()
        .racks
        .iter()
        .map(|r| r * plan.rack_sign)
        .collect();
    plan
}

/// Second-order terms of the mean and of the variance, for each cell (an output at a station) of one wheel.
fn second(problem: &Problem, built: &crate::assembly::Built) -> Vec<[f64; 2]> {
    let mechanism = &problem.wheel_assemblers[0].assembler.suspension().mechanism;
    let readable: Vec<bool> = problem
        .characteristics()
        .map(|c| {
            let by_screw = mechanism.steering_axis == Some(SteeringAxis::Instantaneous)
                && c.info().reads_steering_axis();
            !c.info().reads_rates() && !by_screw
        })
        .collect();
    let poses = Poses::of(problem, &readable);
    let second_derivatives =
        poses.map(|poses| move |along: &[&Source]| poses.second_derivatives(problem, built, along));
    combined(problem, &readable, second_derivatives)
}

/// Second-order terms of the mean and of the variance, for each cell (an output at a station). The terms come from the second
/// derivatives of all cells along sums of tolerance sources, each scaled by its standard deviation. NaN for cells for which
/// `readable` is false.
pub(super) fn combined(
    problem: &Problem,
    readable: &[bool],
    second_derivatives: Option<impl Fn(&[&Source]) -> Vec<f64> + Sync>,
) -> Vec<[f64; 2]> {
    let unknown = vec![[f64::NAN; 2]; problem.cells()];
    let sources: Vec<&Source> = problem.tolerance.each_source().collect();
    let Some(second_derivatives) = second_derivatives else {
        return unknown;
    };
    if !readable.contains(&true) {
        return unknown;
    }
    let laws: Vec<Law> = sources.iter().map(|source| source.law).collect();
    let stations = problem.stations().count();
    let second_derivatives = |first: usize, other: Option<usize>| match other {
        None => second_derivatives(&[sources[first]]),
        Some(other) => second_derivatives(&[sources[first], sources[other]]),
    };
    let is_readable = |cell: usize| readable[cell / stations];
    of_pairs(&laws, problem.cells(), is_readable, second_derivatives)
}

/// Second-order terms of the mean and variance of each cell, for tolerance sources with these distributions.
/// `second_derivatives` returns the second derivatives of all cells along one source or the sum of two, each scaled by its
/// standard deviation. NaN for cells for which `is_readable` is false, and if there are too many sources.
pub(super) fn of_pairs(
    laws: &[Law],
    cells: usize,
    is_readable: impl Fn(usize) -> bool,
    second_derivatives: impl Fn(usize, Option<usize>) -> Vec<f64> + Sync,
) -> Vec<[f64; 2]> {
    let mut second = vec![[f64::NAN; 2]; cells];
    let count = laws.len();
    if count > MOST_SOURCES {
        return second;
    }
    let pairs: Vec<(usize, usize)> = (0..count)
        .flat_map(|j| (j..count).map(move |k| (j, k)))
        .collect();
    // Second derivatives y'' along d_j + d_k.
    let second_derivatives: Vec<Vec<f64>> = pairs
        .par_iter()
        .map(|(j, k)| second_derivatives(*j, (j != k).then_some(*k)))
        .collect();
    let place = |j: usize, k: usize| j * count - j * (j + 1) / 2 + k;
    for (cell, entry) in second.iter_mut().enumerate() {
        if !is_readable(cell) {
            continue;
        }
        let own = |j: usize| second_derivatives[place(j, j)][cell];
        let (mut mean, mut variance) = (0.0, 0.0);
        for (j, law) in laws.iter().enumerate() {
            let hjj = own(j);
            mean += 0.5 * hjj;
            variance += 0.25 * hjj * hjj * (law.kurtosis() - 1.0);
            for k in j + 1..count {
                let hjk = 0.5 * (second_derivatives[place(j, k)][cell] - hjj - own(k));
                variance += hjk * hjk;
            }
        }
        *entry = [mean, variance];
    }
    second
}

/// Poses of the nominal design, each with the factors of its Jacobian.
struct Poses<'p> {
    readable: &'p [bool],
    slots: Slots,
    constants: Constants,
    /// Pose of each station, if it has one.
    poses: Vec<Option<SolvedStation>>,
}

/// A pose, its motion point, and the factors of its Jacobian.
type SolvedStation = (crate::mechanism::Pose<f64>, MotionPoint<f64>, Lu6<f64>);

impl<'p> Poses<'p> {
    fn of(problem: &Problem, readable: &'p [bool]) -> Option<Self> {
        let suspension = problem.wheel_assemblers[0].assembler.suspension();
        let mut solver = Solver::new(&suspension.mechanism, &suspension.design).ok()?;
        let stations = problem.stations();
        let mut poses = vec![None; stations.count()];
        for (r, rack) in stations.racks.iter().enumerate() {
            let walked = solver.for_each_pose(
                stations.drive,
                &stations.station_order,
                *rack,
                |solver, value, pose| {
                    let point = MotionPoint {
                        drive: stations.drive,
                        value: stations.values()[value],
                        rack: *rack,
                    };
                    poses[stations.number(r, value)] = pose.ok().and_then(|pose| {
                        let factors = solver.factorise(pose, &point)?;
                        Some((*pose, point, factors))
                    });
                    ControlFlow::Continue(())
                },
            );
            walked.ok()?;
        }
        let characteristics = problem.characteristics().zip(readable);
        let readable_ones = characteristics.filter(|(_, readable)| **readable);
        let slots = Slots::of(readable_ones.map(|(c, _)| c.info().reads));
        Some(Poses {
            readable,
            slots,
            constants: Constants::of(suspension),
            poses,
        })
    }

    /// Second derivative of each cell (an output at a station). The derivative is along the sum of the directions of some
    /// tolerance sources, each scaled by its standard deviation.
    fn second_derivatives(
        &self,
        problem: &Problem,
        built: &crate::assembly::Built,
        along: &[&Source],
    ) -> Vec<f64> {
        let wheel_assembler = &problem.wheel_assemblers[0];
        let mechanism = &wheel_assembler.assembler.suspension().mechanism;
        let design = wheel_assembler.series(built, along);
        let closure = Closure::new(mechanism, &design);
        let mut second_derivatives = vec![f64::NAN; problem.cells()];
        for (station, place) in self.poses.iter().enumerate() {
            let Some((pose, point, factors)) = place else {
                continue;
            };
            let driver = Driver::Travel(Jet::constant(point.value));
            let rack = Jet::constant(point.rack);
            let pose = crate::derive::pose_series(
                mechanism, &design, &closure, factors, pose, driver, rack,
            );
            let at = Configuration::new(mechanism, &design, pose, rack);
            let reading = WheelReading::reading(&at, self.constants, self.slots);
            for (output, c) in problem.characteristics().enumerate() {
                if self.readable[output] {
                    second_derivatives[problem.cell(output, station)] =
                        reading.characteristic(c).derivative(2);
                }
            }
        }
        second_derivatives
    }
}
