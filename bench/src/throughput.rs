//! Poses per second, as in a sweep: many designs, including their preparation and the output of the values.
//!
//! Designs are the study's own with every hardpoint moved by up to a hundredth of the mechanism's size,
//! always the same ones. The seed paper's formulation solves the same designs at the same travels, in the
//! same rounds, and reads off nothing. What several threads do is measured after the rounds.

use super::{Clock, Job, Timing, Unmeasurable, wheel_travel};
use hardpoint_attia::{PointCoordinates, Strut, StrutPoints};
use hardpoint_engine::characteristics::{Characteristic, Constants, Quantity, WheelReading};
use hardpoint_engine::derive::{DesignSeries, MotionPoint};
use hardpoint_engine::evaluate::{AngleTarget, BLOCK, Block, Evaluator, Gradients, Stations};
use hardpoint_engine::model::{Axis, Frame, Suspension};
use hardpoint_engine::number::{Jet, Vector3, Width};
use hardpoint_engine::solve::Solver;
use hardpoint_engine::study::{Drive, Motion, Study};
use hardpoint_engine::sweep::uniform;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// Largest move of a hardpoint, in sizes.
const SCATTER: f64 = 0.01;
/// Number of blocks that one thread solves in a sample.
const BLOCKS: usize = 32;
/// Number of blocks for each of several threads. Solving them takes long compared with waking the threads.
const BLOCKS_OF_THREAD: usize = 512;
/// Number of designs for slow methods.
const FEW: usize = 16;

/// The measured time of one way to solve poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The quantities that are computed at each pose.
    pub asked: &'static str,
    /// Method that finds the poses.
    pub method: String,
    /// Threads at work.
    pub threads: usize,
    /// Time per pose, all threads together.
    pub timing: Timing,
}

impl Measurement {
    /// Millions of poses per second.
    pub fn millions(&self) -> f64 {
        1e3 / self.timing.median
    }
}

/// Every way, what is asked for by turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Throughput {
    /// The paper's formulation last, where the suspension is a strut.
    pub measurements: Vec<Measurement>,
}

const ANGLES: &str = "four angles";
/// Cost of the method itself: one evaluation of the closed form at each pose, for a given angle of the arm, and the
/// four angles from it.
const LIMIT: &str = "four angles at a given arm angle (the limit)";
/// Largest angle of the arm for that measurement (rad).
const LIMIT_ANGLE: f64 = 0.2;
const ONE_BY_ONE: &str = "one by one";
const GAINS: &str = "four angles and their gains";
const POINTS: &str = "four angles and two points";
const MOTION_RATIO: &str = "motion ratio of the spring";
const JACOBIAN: &str = "four angles by every hardpoint";
const DEVIATION: &str = "sum of their squared deviations by every hardpoint";

impl Throughput {
    /// Measures on the suspension of a study, over its travels, on up to `threads` threads; on an axle over its whole
    /// motion, a pose being one position of both wheels.
    pub fn measure(study: &Study, threads: usize, clock: &Clock) -> Result<Self, Unmeasurable> {
        if let Some(both) = study.axle() {
            let measurements = super::axle::measure(study, both, threads, clock)?;
            return Ok(Throughput { measurements });
        }
        let suspension = study.wheel();
        let motion = wheel_travel(&study.motion().values);
        let stations = Stations::of(&motion, &suspension.frame, &[]);
        let at_angles = at_arm_angles(&motion, &suspension.frame);
        Solver::new(&suspension.mechanism, &suspension.design)?;
        let designs = scattered(suspension);
        let angles = quantities(
            suspension,
            &[
                Characteristic::Camber,
                Characteristic::Toe,
                Characteristic::KingpinInclination,
                Characteristic::Caster,
            ],
        );
        let gains: Vec<Quantity> = angles
            .iter()
            .copied()
            .chain(quantities(
                suspension,
                &[
                    Characteristic::CamberGain,
                    Characteristic::BumpSteer,
                    Characteristic::KingpinInclinationGain,
                    Characteristic::CasterGain,
                ],
            ))
            .collect();

        let motion_ratio = quantities(suspension, &[Characteristic::MotionRatio]);

        // The wheel centre and the knuckle's origin.
        let mechanism = &suspension.mechanism;
        let points = [mechanism.wheel_centre, mechanism.origin].into_iter();
        let points = points.flat_map(|id| Axis::ALL.map(|axis| Quantity::Coordinate(id, axis)));
        let angles_and_points: Vec<Quantity> = angles.iter().copied().chain(points).collect();

        let mut found = Vec::new();
        let mut jobs: Vec<Job<'_>> = Vec::new();
        let mut add = |asked, method: String, threads, job| {
            found.push((asked, method, threads));
            jobs.push(job);
        };
        let sweep = Sweep {
            suspension,
            stations: &stations,
            designs: &designs,
        };
        let has_lanes = sweep.runs_in_lanes(&angles);
        let widths = Width::ALL
            .into_iter()
            .filter(|w| has_lanes && w.is_available());
        for (asked, quantities) in [(ANGLES, &angles), (GAINS, &gains)] {
            for width in widths.clone() {
                let method = format!("lanes, {}", width.name());
                add(asked, method, 1, sweep.job(quantities, Some(width), 1)?);
            }
            let job = sweep.job(quantities, None, 1)?;
            add(asked, ONE_BY_ONE.to_owned(), 1, job);
        }
        let widest = has_lanes.then(Width::widest);
        let limit = Sweep {
            suspension,
            stations: &at_angles,
            designs: &designs,
        };
        if hardpoint_engine::solve::has_closed_form(&suspension.mechanism)
            && limit.runs_in_lanes(&angles)
        {
            let method = format!("lanes, {}", Width::widest().name());
            add(LIMIT, method, 1, limit.job(&angles, widest, 1)?);
        }
        let method = widest.map_or(ONE_BY_ONE.to_owned(), |w| format!("lanes, {}", w.name()));
        for threads in 2..=threads {
            let job = sweep.job(&angles, widest, threads)?;
            add(ANGLES, method.clone(), threads, job);
        }
        let job = sweep.job(&angles_and_points, widest, 1)?;
        add(POINTS, method.clone(), 1, job);
        if !motion_ratio.is_empty() {
            add(
                MOTION_RATIO,
                method,
                1,
                sweep.job(&motion_ratio, widest, 1)?,
            );
            let job = sweep.job(&motion_ratio, None, 1)?;
            add(MOTION_RATIO, ONE_BY_ONE.to_owned(), 1, job);
        }
        let job = sweep.series::<3>(&angles);
        add(
            "four angles, rates, curvatures",
            ONE_BY_ONE.to_owned(),
            1,
            job,
        );
        for (asked, wanted) in [
            (DEVIATION, Some(sweep.wanted(angles.len()))),
            (JACOBIAN, None),
        ] {
            for width in widths.clone() {
                let method = format!("lanes, {}", width.name());
                if let Some(job) = sweep.gradients_in_lanes(&angles, wanted.clone(), width) {
                    add(asked, method, 1, job);
                }
            }
        }
        let job = sweep.gradients::<1>(&angles);
        add(JACOBIAN, ONE_BY_ONE.to_owned(), 1, job);
        let job = sweep.gradients::<3>(&angles);
        add(
            "all of it by every hardpoint",
            ONE_BY_ONE.to_owned(),
            1,
            job,
        );
        if let Some(job) = sweep.by_the_paper() {
            add("positions", PAPER.to_owned(), 1, job);
        }

        // Several threads by themselves: between the samples of others theirs would lose their cores, and get
        // them back only after tens of milliseconds.
        let (mut alone, mut together): (Vec<Job<'_>>, Vec<Job<'_>>) = (Vec::new(), Vec::new());
        for (job, (_, _, threads)) in jobs.into_iter().zip(&found) {
            match threads {
                1 => together.push(job),
                _ => alone.push(job),
            }
        }
        let mut of_one = clock.in_rounds(&mut together).into_iter();
        let of_several: Vec<Timing> = alone
            .iter_mut()
            .flat_map(|job| clock.in_rounds(std::slice::from_mut(job)))
            .collect();
        let mut of_several = of_several.into_iter();
        let measurements = found
            .into_iter()
            .map(|(asked, method, threads)| Measurement {
                asked,
                method,
                threads,
                timing: match threads {
                    1 => of_one.next(),
                    _ => of_several.next(),
                }
                .expect("a time for each job"),
            });
        Ok(Throughput {
            measurements: measurements.collect(),
        })
    }

    /// The limit of the method: nothing but its formulas, at a given arm angle.
    pub fn limit(&self) -> Option<&Measurement> {
        self.measurements.iter().find(|m| m.asked == LIMIT)
    }

    /// The seed paper's way to the same poses, where the study has one.
    pub fn by_the_paper(&self) -> Option<&Measurement> {
        self.measurements.iter().find(|m| m.method == PAPER)
    }
}

const PAPER: &str = "point coordinates (paper)";

/// Returns those of the characteristics for which the suspension has the parts and figures.
fn quantities(suspension: &Suspension, characteristics: &[Characteristic]) -> Vec<Quantity> {
    let possible = |c: &&Characteristic| c.info().needs.iter().all(|n| n.met_by(suspension));
    let possible = characteristics.iter().filter(possible);
    possible.map(|c| Quantity::Characteristic(*c)).collect()
}

/// As many stations as the motion has, by the angle of the arm.
fn at_arm_angles(motion: &Motion, frame: &Frame) -> Stations {
    let last = motion.values.len().saturating_sub(1).max(1) as f64;
    let angle = |k: usize| LIMIT_ANGLE * (2.0 * k as f64 / last - 1.0);
    let motion = Motion {
        drive: Drive::ArmAngle,
        values: (0..motion.values.len()).map(angle).collect(),
        ..motion.clone()
    };
    Stations::of(&motion, frame, &[])
}

/// Designs about the suspension's own, a block of them.
fn scattered(suspension: &Suspension) -> Vec<Vector3<f64>> {
    let by = SCATTER * suspension.size();
    let points = suspension.design.len();
    let mut designs = Vec::with_capacity(BLOCK * points);
    for number in 0..BLOCK {
        for (k, point) in suspension.design.iter().enumerate() {
            let part = |axis| by * (2.0 * uniform(number as u64, 3 * k + axis, 1) - 1.0);
            designs.push(*point + Vector3::new(part(0), part(1), part(2)));
        }
    }
    designs
}

/// The designs and stations that are solved.
#[derive(Clone, Copy)]
struct Sweep<'a> {
    suspension: &'a Suspension,
    stations: &'a Stations,
    designs: &'a [Vector3<f64>],
}

impl<'a> Sweep<'a> {
    /// Returns true if most of the designs run in lanes.
    fn runs_in_lanes(&self, quantities: &[Quantity]) -> bool {
        let mut block = Block::new(quantities.len(), self.stations.count());
        Evaluator::new(self.suspension, self.stations, quantities)
            .is_ok_and(|mut e| e.evaluate(self.designs, &mut block) < BLOCK)
    }

    /// Blocks of designs on some threads.
    fn job(
        &self,
        quantities: &'a [Quantity],
        width: Option<Width>,
        threads: usize,
    ) -> Result<Job<'a>, Unmeasurable> {
        let Sweep {
            suspension,
            stations,
            designs,
        } = *self;
        let blocks = match (width, threads) {
            (None, _) => 1,
            (Some(_), 1) => BLOCKS,
            (Some(_), _) => BLOCKS_OF_THREAD,
        };
        let mut workers = Vec::new();
        for _ in 0..threads {
            let evaluator = Evaluator::with_width(suspension, stations, quantities, width)?;
            let block = Block::new(quantities.len(), stations.count());
            workers.push(Mutex::new((evaluator, block)));
        }
        // As in a sweep they live long: it may take a scheduler tens of milliseconds to give a new thread a
        // core of its own.
        let pool = (threads > 1).then(|| hardpoint_engine::threads::pool(threads));
        let pool = pool
            .transpose()
            .map_err(|_| Unmeasurable::Threads(threads))?;
        let work = move |evaluator: &mut Evaluator, block: &mut Block| {
            for _ in 0..blocks {
                evaluator.evaluate(black_box(designs), block);
                black_box(block.value(0, 0, 0));
            }
        };
        Ok(Job {
            items: threads * blocks * BLOCK * stations.count(),
            work: Box::new(move || {
                let work_of = |number: usize| {
                    let mut worker = workers[number].lock().expect("no thread has panicked");
                    let (evaluator, block) = &mut *worker;
                    work(evaluator, block);
                };
                match &pool {
                    None => work_of(0),
                    Some(pool) => {
                        pool.broadcast(|thread| work_of(thread.index()));
                    }
                }
            }),
        })
    }

    /// The first few designs, one by one.
    fn few(&self) -> std::slice::ChunksExact<'a, Vector3<f64>> {
        let points = self.suspension.design.len();
        self.designs[..FEW * points].chunks_exact(points)
    }

    /// Values with derivatives by the travel, `N` coefficients in all.
    fn series<const N: usize>(&self, quantities: &'a [Quantity]) -> Job<'a> {
        let sweep = *self;
        let mechanism = &self.suspension.mechanism;
        let constants = Constants::of(self.suspension);
        let mut solver = Solver::new(mechanism, &self.suspension.design).expect("it was solved");
        let mut design_series = DesignSeries::<N>::new(mechanism, &self.suspension.design);
        Job {
            items: FEW * self.stations.count(),
            work: Box::new(move || {
                sweep.each_pose(
                    &mut solver,
                    &mut design_series,
                    |solver, design_series, pose, motion| {
                        if let Ok(at) = solver.configuration_series(design_series, pose, motion) {
                            let view = WheelReading::of(&at, constants);
                            for quantity in quantities {
                                black_box(view.value(&at, *quantity));
                            }
                        }
                    },
                );
            }),
        }
    }

    /// A wanted value for each angle and station.
    fn wanted(&self, angles: usize) -> Vec<AngleTarget> {
        let wanted = AngleTarget {
            value: 0.01,
            weight: 1.0,
        };
        vec![wanted; angles * self.stations.count()]
    }

    /// Derivatives by every hardpoint coordinate, as many designs at a time as there are lanes: of the sum of
    /// deviations from what is wanted, or of each quantity.
    fn gradients_in_lanes(
        &self,
        quantities: &[Quantity],
        wanted: Option<Vec<AngleTarget>>,
        width: Width,
    ) -> Option<Job<'a>> {
        let Sweep {
            suspension,
            stations,
            designs,
        } = *self;
        let mut gradients = Gradients::new(suspension, stations, quantities, width)?;
        let at_once = gradients.at_once() * suspension.design.len();
        Some(Job {
            items: BLOCKS / 4 * BLOCK * stations.count(),
            work: Box::new(move || {
                for _ in 0..BLOCKS / 4 {
                    for group in designs.chunks(at_once) {
                        let group = black_box(group);
                        match &wanted {
                            Some(wanted) => {
                                black_box(gradients.deviations(group, wanted));
                            }
                            None => gradients.jacobians(group, |jacobians| {
                                black_box(jacobians);
                            }),
                        }
                    }
                }
            }),
        })
    }

    /// Values with derivatives by every hardpoint coordinate, and those of as many derivatives by the
    /// travel.
    fn gradients<const N: usize>(&self, quantities: &'a [Quantity]) -> Job<'a> {
        let sweep = *self;
        let mechanism = &self.suspension.mechanism;
        let constants = Constants::of(self.suspension);
        let mut solver = Solver::new(mechanism, &self.suspension.design).expect("it was solved");
        let mut design_series = DesignSeries::<N>::new(mechanism, &self.suspension.design);
        let none = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        let mut buffer = vec![none; self.suspension.design.len()];
        Job {
            items: FEW * self.stations.count(),
            work: Box::new(move || {
                sweep.each_pose(
                    &mut solver,
                    &mut design_series,
                    |solver, design_series, pose, motion| {
                        if let Ok(linearised) = solver.linearised(design_series, pose, motion) {
                            let view = WheelReading::of(&linearised.at, constants);
                            for quantity in quantities {
                                let mut take = |_, _, gradient| {
                                    black_box(gradient);
                                };
                                view.gradients(
                                    &linearised,
                                    *quantity,
                                    N - 1,
                                    &mut buffer,
                                    &mut take,
                                );
                            }
                        }
                    },
                );
            }),
        }
    }

    fn each_pose<const N: usize>(
        &self,
        solver: &mut Solver<'a>,
        design_series: &mut DesignSeries<N>,
        mut visit: impl FnMut(
            &Solver<'a>,
            &DesignSeries<N>,
            &hardpoint_engine::mechanism::Pose<f64>,
            &MotionPoint<Jet<f64, N>>,
        ),
    ) {
        let drive = self.stations.drive;
        for design in self.few() {
            if solver.prepare(design).is_err() {
                continue;
            }
            design_series.prepare(solver.mechanism(), design);
            let station_order = &self.stations.station_order;
            let _ = solver.for_each_pose(drive, station_order, 0.0, |solver, station, pose| {
                let motion = MotionPoint {
                    drive,
                    value: station_order.values()[station],
                    rack: 0.0,
                };
                if let Ok(pose) = pose {
                    visit(solver, design_series, pose, &motion.along_drive());
                }
                ControlFlow::Continue(())
            });
        }
    }

    /// The fifteen equations of the seed paper.
    fn by_the_paper(&self) -> Option<Job<'a>> {
        let sweep = *self;
        let mechanism = &self.suspension.mechanism;
        Strut::of(mechanism, &self.suspension.design)?;
        Some(Job {
            items: FEW * self.stations.count(),
            work: Box::new(move || {
                for design in sweep.few() {
                    let strut = Strut::of(mechanism, design).expect("it is a strut");
                    let travel = hardpoint_attia::Drive::Travel;
                    let equations = PointCoordinates::new(&strut, StrutPoints::Spread, travel);
                    let Ok(equations) = equations else { continue };
                    let Ok(start) = equations.placed(0.0) else {
                        continue;
                    };
                    equations.for_each_pose(&start, sweep.stations.values(), &mut |_, pose| {
                        let _ = black_box(pose);
                    });
                }
            }),
        })
    }
}
