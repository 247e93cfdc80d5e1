//! Equilibria per second of a wheel or an axle with elastic parts. Also the time of a complete set of compliance tests with
//! derivatives.

use super::{Clock, Job, JobTime, Unmeasurable};
use hardpoint_engine::bench_hooks::{equilibria_in_lanes, wheel_figures};
use hardpoint_engine::compliance::{
    AxialStiffness, AxleKcRun, Compliance, ElasticAxle, ElasticWheel, Equilibrium, HeldQuantity,
    KcRun, KcValue, Parameter, Shape, WheelLoads, quantities,
};
use hardpoint_engine::model::{Axis, PointId, Suspension};
use hardpoint_engine::number::{Vector3, Width};
use hardpoint_engine::study::{AxleStudy, Study, WheelStudy};
use std::hint::black_box;

/// Number of loads whose equilibria one timing sample computes.
const LOADS: usize = 64;
/// Largest component of a load's force, N.
const LARGEST: f64 = 2000.0;

/// Computing times of the equilibria of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibria {
    /// Measured time of each job.
    pub measurements: Vec<JobTime>,
}

/// Evenly spread loads, the same on every machine.
fn loads() -> Vec<WheelLoads> {
    let part = |k: usize, irrational: f64| 2.0 * ((k + 1) as f64 * irrational).fract() - 1.0;
    let load = |k| {
        let mut load = WheelLoads::none(0.0);
        let (x, y) = (part(k, 0.754_877_666), part(k, 0.569_840_291));
        load.contact = Vector3::new(x, y, 0.0) * LARGEST;
        load
    };
    (0..LOADS).map(load).collect()
}

/// Side forces that rise to [`LARGEST`].
fn side_forces() -> impl Iterator<Item = WheelLoads> {
    (1..=LOADS).map(|k| {
        let mut load = WheelLoads::none(0.0);
        load.side = LARGEST * k as f64 / LOADS as f64;
        load
    })
}

/// All hardpoints and rates of a wheel with elastic parts.
fn parameters(suspension: &Suspension, parts: &Compliance) -> Vec<Parameter> {
    let points = (0..suspension.design.len()).map(PointId);
    let mut all: Vec<Parameter> = points
        .flat_map(|point| Axis::ALL.map(|axis| Parameter::Point(point, axis)))
        .collect();
    for (number, part) in parts.bushings.iter().enumerate() {
        let laws = part.shapes.iter().enumerate();
        let given = laws.filter(|(_, shape)| !matches!(shape, Shape::Cubic { rate: 0.0, .. }));
        all.extend(given.map(|(axis, _)| Parameter::Stiffness(number, axis)));
    }
    let links = parts.links.iter().enumerate();
    let given = links.filter(|(_, link)| !matches!(link.stiffness, AxialStiffness::Rate(0.0)));
    all.extend(given.map(|(number, _)| Parameter::Link(number)));
    all
}

impl Equilibria {
    /// Measures the computing times of the equilibria of a study. Returns an error if the study has no elastic parts, or if its
    /// design has no equilibrium.
    pub fn measure(study: &Study, clock: &Clock) -> Result<Self, Unmeasurable> {
        match (study.one_wheel(), study.axle()) {
            (Some(wheel), _) => Equilibria::of_wheel(wheel, clock),
            (None, Some(both)) => Equilibria::of_axle(both, clock),
            (None, None) => Err(Unmeasurable::Rigid),
        }
    }

    fn of_wheel(wheel: &WheelStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let elastic = wheel.compliance.as_ref().ok_or(Unmeasurable::Rigid)?;
        let (suspension, parts) = (&wheel.suspension, &elastic.parts);
        let fault = |fault: hardpoint_engine::compliance::ElasticFault| {
            Unmeasurable::Design(fault.of_design())
        };
        let own = ElasticWheel::new(suspension, parts).map_err(fault)?;
        let run = KcRun::new(suspension, parts, elastic.tyre_rate).map_err(fault)?;
        let Ok(station) = own.at(0.0, 0.0) else {
            return Err(Unmeasurable::NoEquilibrium);
        };
        let loads = loads();
        let solved = |from: &Equilibrium, load: &WheelLoads| {
            let found = own.loaded_about(&station, from, load, HeldQuantity::WheelHeight);
            found.ok().map(|at| (wheel_figures(&own, &at), at))
        };
        let from_design = || {
            let found = |load: &&WheelLoads| black_box(solved(&station, load)).is_some();
            loads.iter().filter(found).count()
        };
        let levels = || {
            let (mut at, mut found) = (station, 0);
            for load in side_forces() {
                if let Some((_, next)) = black_box(solved(&at, &load)) {
                    (at, found) = (next, found + 1);
                }
            }
            found
        };
        let mut wanted = Vec::new();
        for test in &elastic.tests {
            for (quantity, _) in quantities(suspension, parts, elastic.tyre_rate, test) {
                let kinds: &[bool] = if test.load.is_motion() {
                    &[false]
                } else {
                    &[false, true]
                };
                wanted.extend(kinds.iter().map(|is_secant| KcValue::Figure {
                    test: *test,
                    quantity,
                    is_secant: *is_secant,
                }));
            }
        }
        let parameters = parameters(suspension, parts);
        let sheet = || {
            black_box(run.run(&[0.0], &[0.0], &elastic.tests));
            let mut sum = 0.0;
            let read = run.gradients([0.0, 0.0], &wanted, &parameters, &mut |found| {
                sum += found.by.iter().sum::<f64>();
            });
            black_box((sum, read.is_ok()));
            1
        };
        let names = [
            "equilibrium, started at the design position",
            "equilibrium, started at the previous load",
            "rig tests of one wheel with all derivatives",
        ];
        let works: [Box<dyn FnMut() -> usize>; 3] =
            [Box::new(from_design), Box::new(levels), Box::new(sheet)];
        let mut found = Equilibria::timed(names, works, clock);
        // Equilibria do not use AVX-512.
        for width in Width::available().filter(|width| *width != Width::Avx512) {
            found.add_lanes(&own, width, clock);
        }
        Ok(found)
    }

    /// Adds times of equilibria in SIMD lanes, if the wheel can be computed in lanes.
    fn add_lanes(&mut self, own: &ElasticWheel, width: Width, clock: &Clock) {
        let names = match width {
            Width::Portable => [
                "equilibrium, started at the design position, portable lanes",
                "equilibrium, started at the previous load, portable lanes",
            ],
            Width::Avx2 | Width::Avx512 => [
                "equilibrium, started at the design position, avx2 lanes",
                "equilibrium, started at the previous load, avx2 lanes",
            ],
        };
        let levels: Vec<WheelLoads> = side_forces().collect();
        let items = [LOADS, LOADS * width.lanes()];
        equilibria_in_lanes(width, own, &loads(), &levels, &mut |work| {
            for (number, job) in names.into_iter().enumerate() {
                // The program measures the time of a job only if the job finds every equilibrium.
                let mut found = 0;
                work(&mut |_| found += 1, number);
                if found != items[number] {
                    continue;
                }
                let timing = clock.time(items[number], || {
                    work(&mut |figures| _ = black_box(figures), number);
                });
                self.measurements.push(JobTime { job, timing });
            }
        });
    }

    fn of_axle(both: &AxleStudy, clock: &Clock) -> Result<Self, Unmeasurable> {
        let axle = &both.axle;
        let elastic = axle.elastic.as_ref().ok_or(Unmeasurable::Rigid)?;
        let parts = &elastic.parts;
        let vehicle = axle.on_rig(elastic.tyre_rate);
        let fault =
            |fault: hardpoint_engine::compliance::AxleFault| Unmeasurable::Axle(fault.describe());
        let designs = vehicle.suspensions.map(|wheel| &wheel.design[..]);
        let own = ElasticAxle::of(vehicle.suspensions, designs, parts).map_err(fault)?;
        let run = AxleKcRun::new(vehicle, parts).map_err(fault)?;
        let Ok(station) = own.at([0.0; 2], 0.0) else {
            return Err(Unmeasurable::NoEquilibrium);
        };
        let loads = loads();
        let from_design = || {
            let found = |k: &usize| {
                let both = [loads[*k], loads[(k + 1) % LOADS]];
                let found = own.loaded_about(&station, &station, &both, HeldQuantity::WheelHeight);
                black_box(found).is_ok()
            };
            (0..LOADS).filter(found).count()
        };
        let levels = || {
            let (mut at, mut found) = (station, 0);
            for load in side_forces() {
                let held = HeldQuantity::WheelHeight;
                if let Ok(next) = black_box(own.loaded_about(&station, &at, &[load; 2], held)) {
                    (at, found) = (next, found + 1);
                }
            }
            found
        };
        let parameters = parameters(&axle.left, &parts.wheels[0]);
        let sheet = || {
            black_box(run.run(&[([0.0; 2], 0.0)], &elastic.tests));
            let found = run.gradients([0.0; 2], 0.0, &elastic.tests, &parameters);
            black_box(found.is_some());
            1
        };
        let names = [
            "equilibrium of both wheels, started at the design position",
            "equilibrium of both wheels, started at the previous load",
            "rig tests of both wheels with all derivatives",
        ];
        let works: [Box<dyn FnMut() -> usize>; 3] =
            [Box::new(from_design), Box::new(levels), Box::new(sheet)];
        Ok(Equilibria::timed(names, works, clock))
    }

    /// Measures the computing times of three jobs. The first one computes the equilibria of all sample loads, each started at
    /// the design position. The second one computes the equilibria of all side forces, each started at the equilibrium of the
    /// previous one. The third one computes a complete set of compliance tests. Each job returns the number of its results, so
    /// loads without equilibrium do not reduce the time per equilibrium. A job without results is omitted.
    fn timed(
        names: [&'static str; 3],
        works: [Box<dyn FnMut() -> usize + '_>; 3],
        clock: &Clock,
    ) -> Self {
        let (mut found, mut jobs) = (Vec::new(), Vec::new());
        for (name, mut work) in names.into_iter().zip(works) {
            let items = work();
            if items > 0 {
                let work = Box::new(move || _ = black_box(work()));
                found.push(name);
                jobs.push(Job { items, work });
            }
        }
        let measured = found.into_iter().zip(clock.in_rounds(&mut jobs));
        let measurements = measured.map(|(job, timing)| JobTime { job, timing });
        Equilibria {
            measurements: measurements.collect(),
        }
    }
}
