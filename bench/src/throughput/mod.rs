//! Poses per second, as in a sweep: many designs, including their preparation and the output of the values.
//!
//! The designs are copies of the study's design. Every hardpoint is moved by up to a hundredth of the mechanism's size, with the
//! same moves in every run. The formulation of Attia's paper solves the same designs at the same travels, in the same rounds, but
//! computes no outputs. Jobs with several CPU threads are measured after the rounds.

mod sweep;

use self::sweep::Sweep;
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

/// Largest move of a hardpoint, relative to the mechanism's size.
const SCATTER: f64 = 0.01;
/// Number of blocks of designs that one CPU thread solves per timing sample.
const BLOCKS: usize = 32;
/// Number of blocks of designs per CPU thread if several threads run. Solving these blocks takes much longer than waking the
/// threads.
const BLOCKS_OF_THREAD: usize = 512;
/// Number of designs that slow methods solve.
const FEW: usize = 16;

/// The measured time of one method for solving poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Outputs that are computed at each pose.
    pub asked: &'static str,
    /// Method that finds the poses.
    pub method: String,
    /// Number of CPU threads.
    pub threads: usize,
    /// Elapsed time divided by the number of poses of all CPU threads together.
    pub timing: Timing,
}

impl Measurement {
    /// Millions of poses per second.
    pub fn millions(&self) -> f64 {
        1e3 / self.timing.median
    }
}

/// Measured times of all methods, grouped by the requested outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Throughput {
    /// Measurements. The paper's formulation comes last, if the suspension is a strut.
    pub measurements: Vec<Measurement>,
}

const ANGLES: &str = "four angles";
/// Job that shows the cost of the closed form alone. The angle of the arm is given. At each pose, the job evaluates the closed form
/// once. It computes camber, toe, caster and kingpin inclination.
const LIMIT: &str = "four angles at a given arm angle (the limit)";
/// Largest angle of the arm (rad) in the measurement of the closed form alone.
const LIMIT_ANGLE: f64 = 0.2;
const ONE_BY_ONE: &str = "one by one";
const GAINS: &str = "four angles and their gains";
const POINTS: &str = "four angles and two points";
const MOTION_RATIO: &str = "motion ratio of the spring";
const JACOBIAN: &str = "derivatives of four angles by every hardpoint";
const DEVIATION: &str =
    "gradient of the sum of squared deviations of four angles by every hardpoint";

impl Throughput {
    /// Measures the suspension of a study over its travels, on up to `threads` CPU threads. An axle is measured over its whole
    /// motion; there a pose is one position of both wheels.
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
        let wanted = Requested::of(suspension);
        let sweep = Sweep {
            suspension,
            stations: &stations,
            designs: &designs,
        };
        let limit = Sweep {
            stations: &at_angles,
            ..sweep
        };
        let mut planned = Planned::default();
        planned.values(&sweep, &limit, &wanted, threads)?;
        planned.derivatives(&sweep, &wanted);
        if let Some(job) = sweep.by_the_paper() {
            planned.add("positions", PAPER.to_owned(), 1, job);
        }
        Ok(Throughput {
            measurements: planned.run(clock),
        })
    }

    /// Measurement of the closed form alone, at a given arm angle. No other method can be faster.
    pub fn limit(&self) -> Option<&Measurement> {
        self.measurements.iter().find(|m| m.asked == LIMIT)
    }

    /// Measurement of the paper's formulation, if the study has one.
    pub fn by_the_paper(&self) -> Option<&Measurement> {
        self.measurements.iter().find(|m| m.method == PAPER)
    }
}

/// Groups of outputs that the measurements request.
struct Requested {
    angles: Vec<Quantity>,
    /// The four angles (camber, toe, caster, kingpin inclination) and their derivatives with respect to travel.
    gains: Vec<Quantity>,
    /// The four angles, the wheel centre and the knuckle's origin.
    angles_and_points: Vec<Quantity>,
    /// The motion ratio of the spring, if there is one.
    motion_ratio: Vec<Quantity>,
}

impl Requested {
    fn of(suspension: &Suspension) -> Self {
        use Characteristic::{
            BumpSteer, Camber, CamberGain, Caster, CasterGain, KingpinInclination,
            KingpinInclinationGain, MotionRatio, Toe,
        };
        let angles = quantities(suspension, &[Camber, Toe, KingpinInclination, Caster]);
        let by_travel = [CamberGain, BumpSteer, KingpinInclinationGain, CasterGain];
        let mechanism = &suspension.mechanism;
        let points = [mechanism.wheel_centre, mechanism.origin].into_iter();
        let points = points.flat_map(|id| Axis::ALL.map(|axis| Quantity::Coordinate(id, axis)));
        let with = |more: Vec<Quantity>| [&angles[..], &more[..]].concat();
        Requested {
            gains: with(quantities(suspension, &by_travel)),
            angles_and_points: with(points.collect()),
            motion_ratio: quantities(suspension, &[MotionRatio]),
            angles,
        }
    }
}

/// Jobs to be timed. For each job: the group of outputs, the method and the number of CPU threads.
#[derive(Default)]
struct Planned<'a> {
    rows: Vec<(&'static str, String, usize)>,
    jobs: Vec<Job<'a>>,
}

impl<'a> Planned<'a> {
    fn add(&mut self, asked: &'static str, method: String, threads: usize, job: Job<'a>) {
        self.rows.push((asked, method, threads));
        self.jobs.push(job);
    }

    /// Adds jobs that compute values at given travels, with the scalar solver and in SIMD lanes. `limit` is the sweep at
    /// given arm angles, the fastest case.
    fn values(
        &mut self,
        sweep: &Sweep<'a>,
        limit: &Sweep<'a>,
        wanted: &'a Requested,
        threads: usize,
    ) -> Result<(), Unmeasurable> {
        let angles = &wanted.angles;
        let widest = Width::widest().filter(|_| sweep.runs_in_lanes(angles));
        for (asked, quantities) in [(ANGLES, angles), (GAINS, &wanted.gains)] {
            for width in sweep.widths(angles) {
                self.add(
                    asked,
                    lanes(width),
                    1,
                    sweep.job(quantities, Some(width), 1)?,
                );
            }
            let job = sweep.job(quantities, None, 1)?;
            self.add(asked, ONE_BY_ONE.to_owned(), 1, job);
        }
        let has_limit = hardpoint_engine::solve::has_closed_form(&sweep.suspension.mechanism);
        if let Some(width) = widest
            && has_limit
            && limit.runs_in_lanes(angles)
        {
            self.add(LIMIT, lanes(width), 1, limit.job(angles, widest, 1)?);
        }
        let method = || widest.map_or(ONE_BY_ONE.to_owned(), lanes);
        let most = threads;
        for threads in 2..=most {
            let job = sweep.job(angles, widest, threads);
            let job = job.map_err(|reason| reason.up_to(most))?;
            self.add(ANGLES, method(), threads, job);
        }
        let job = sweep.job(&wanted.angles_and_points, widest, 1)?;
        self.add(POINTS, method(), 1, job);
        let ratio = &wanted.motion_ratio;
        if !ratio.is_empty() {
            self.add(MOTION_RATIO, method(), 1, sweep.job(ratio, widest, 1)?);
            self.add(
                MOTION_RATIO,
                ONE_BY_ONE.to_owned(),
                1,
                sweep.job(ratio, None, 1)?,
            );
        }
        Ok(())
    }

    /// Adds jobs that compute derivatives with respect to travel and to every hardpoint.
    fn derivatives(&mut self, sweep: &Sweep<'a>, wanted: &'a Requested) {
        let angles = &wanted.angles;
        let one_by_one = || ONE_BY_ONE.to_owned();
        let job = sweep.series::<3>(angles);
        self.add("four angles, rates, curvatures", one_by_one(), 1, job);
        let deviations = Some(sweep.wanted(angles.len()));
        for (asked, wanted) in [(DEVIATION, deviations), (JACOBIAN, None)] {
            for width in sweep.widths(angles) {
                if let Some(job) = sweep.gradients_in_lanes(angles, wanted.clone(), width) {
                    self.add(asked, lanes(width), 1, job);
                }
            }
        }
        self.add(JACOBIAN, one_by_one(), 1, sweep.gradients::<1>(angles));
        let job = sweep.gradients::<3>(angles);
        self.add(
            "derivatives of four angles, rates, curvatures by every hardpoint",
            one_by_one(),
            1,
            job,
        );
    }

    /// Measures the computing times of the jobs. Jobs with several CPU threads run alone. Otherwise their threads would lose
    /// their processor cores while other jobs are timed. They would get cores again only after tens of milliseconds.
    fn run(self, clock: &Clock) -> Vec<Measurement> {
        let (mut alone, mut together): (Vec<Job<'_>>, Vec<Job<'_>>) = (Vec::new(), Vec::new());
        for (job, (_, _, threads)) in self.jobs.into_iter().zip(&self.rows) {
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
        let rows = self.rows.into_iter();
        let measurements = rows.map(|(asked, method, threads)| Measurement {
            asked,
            method,
            threads,
            timing: match threads {
                1 => of_one.next(),
                _ => of_several.next(),
            }
            .expect("each job has a time"),
        });
        measurements.collect()
    }
}

/// Name of the method in SIMD lanes of this width.
fn lanes(width: Width) -> String {
    format!("lanes, {}", width.name())
}

const PAPER: &str = "point coordinates (paper)";

/// Returns the characteristics whose inputs the suspension has.
fn quantities(suspension: &Suspension, characteristics: &[Characteristic]) -> Vec<Quantity> {
    let possible = |c: &&Characteristic| c.info().needs.iter().all(|n| n.met_by(suspension));
    let possible = characteristics.iter().filter(possible);
    possible.map(|c| Quantity::Characteristic(*c)).collect()
}

/// Makes stations that are driven by the angle of the arm. Their number is the number of values of the motion.
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

/// One block of designs: the suspension with random moves of the hardpoints.
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
