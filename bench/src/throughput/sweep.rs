//! Timed work: blocks of designs in SIMD lanes, or single designs in the scalar solver.

use super::*;

/// Designs and stations that a job solves.
#[derive(Clone, Copy)]
pub(super) struct Sweep<'a> {
    pub(super) suspension: &'a Suspension,
    pub(super) stations: &'a Stations,
    pub(super) designs: &'a [Vector3<f64>],
}

impl<'a> Sweep<'a> {
    /// True if most of the designs run in lanes.
    pub(super) fn runs_in_lanes(&self, quantities: &[Quantity]) -> bool {
        let mut block = Block::new(quantities.len(), self.stations.count());
        Evaluator::new(self.suspension, self.stations, quantities)
            .is_ok_and(|mut e| e.evaluate(self.designs, &mut block) < BLOCK)
    }

    /// Lane widths that this machine has. Empty if most of the designs need the scalar solver.
    pub(super) fn widths(&self, quantities: &[Quantity]) -> impl Iterator<Item = Width> + use<> {
        let has_lanes = self.runs_in_lanes(quantities);
        Width::available().filter(move |_| has_lanes)
    }

    /// Makes a job that solves blocks of designs on this number of CPU threads.
    pub(super) fn job(
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
        // The CPU threads are reused, as in a sweep, because a scheduler may take tens of milliseconds to give a new thread a
        // separate core.
        let pool = (threads > 1).then(|| hardpoint_engine::threads::pool(threads));
        let pool = pool
            .transpose()
            .map_err(|_| Unmeasurable::threads(threads))?;
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

    /// First few designs, for slow methods.
    pub(super) fn few(&self) -> std::slice::ChunksExact<'a, Vector3<f64>> {
        let points = self.suspension.design.len();
        self.designs[..FEW * points].chunks_exact(points)
    }

    /// Makes a job that computes values with derivatives with respect to the travel, `N` coefficients in all.
    pub(super) fn series<const N: usize>(&self, quantities: &'a [Quantity]) -> Job<'a> {
        let constants = Constants::of(self.suspension);
        self.job_of_poses::<N>(move |solver, design_series, pose, motion| {
            if let Ok(at) = solver.configuration_series(design_series, pose, motion) {
                let view = WheelReading::of(&at, constants);
                for quantity in quantities {
                    black_box(view.value(&at, *quantity));
                }
            }
        })
    }

    /// A target value for each of the `angles` angles at each station.
    pub(super) fn wanted(&self, angles: usize) -> Vec<AngleTarget> {
        let wanted = AngleTarget {
            value: 0.01,
            weight: 1.0,
        };
        vec![wanted; angles * self.stations.count()]
    }

    /// Makes a job that computes derivatives with respect to every hardpoint coordinate, one design in each lane. With
    /// `wanted`, it differentiates the sum of squared deviations from these targets, else each quantity.
    pub(super) fn gradients_in_lanes(
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

    /// Makes a job that computes values and `N - 1` derivatives with respect to the travel. The job also computes the gradient
    /// of each of these numbers with respect to every hardpoint coordinate.
    pub(super) fn gradients<const N: usize>(&self, quantities: &'a [Quantity]) -> Job<'a> {
        let constants = Constants::of(self.suspension);
        let none = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        let mut buffer = vec![none; self.suspension.design.len()];
        self.job_of_poses::<N>(move |solver, design_series, pose, motion| {
            if let Ok(linearised) = solver.linearised(design_series, pose, motion) {
                let view = WheelReading::of(&linearised.at, constants);
                for quantity in quantities {
                    let mut take = |_, _, gradient| {
                        black_box(gradient);
                    };
                    view.gradients(&linearised, *quantity, N - 1, &mut buffer, &mut take);
                }
            }
        })
    }

    /// Makes a job that solves the first few designs one by one and passes each pose to `visit`.
    fn job_of_poses<const N: usize>(
        &self,
        mut visit: impl FnMut(
            &Solver<'a>,
            &DesignSeries<N>,
            &hardpoint_engine::mechanism::Pose<f64>,
            &MotionPoint<Jet<f64, N>>,
        ) + 'a,
    ) -> Job<'a> {
        let sweep = *self;
        let mechanism = &self.suspension.mechanism;
        let mut solver =
            Solver::new(mechanism, &self.suspension.design).expect("the design was solved before");
        let mut design_series = DesignSeries::<N>::new(mechanism, &self.suspension.design);
        let drive = self.stations.drive;
        let station_order = &self.stations.station_order;
        let work = move || {
            for design in sweep.few() {
                if solver.prepare(design).is_err() {
                    continue;
                }
                design_series.prepare(solver.mechanism(), design);
                let _ = solver.for_each_pose(drive, station_order, 0.0, |solver, station, pose| {
                    let motion = MotionPoint {
                        drive,
                        value: station_order.values()[station],
                        rack: 0.0,
                    };
                    if let Ok(pose) = pose {
                        visit(solver, &design_series, pose, &motion.along_drive());
                    }
                    ControlFlow::Continue(())
                });
            }
        };
        Job {
            items: FEW * self.stations.count(),
            work: Box::new(work),
        }
    }

    /// Makes a job that solves the fifteen equations of Attia's paper. `None` for other suspensions than struts, or if no pose
    /// can be solved.
    pub(super) fn by_the_paper(&self) -> Option<Job<'a>> {
        let sweep = *self;
        let mechanism = &self.suspension.mechanism;
        Strut::of(mechanism, &self.suspension.design)?;
        let solved = move || {
            let mut solved = 0;
            for design in sweep.few() {
                let strut = Strut::of(mechanism, design).expect("the suspension is a strut");
                let travel = hardpoint_attia::Drive::Travel;
                let equations = PointCoordinates::new(&strut, StrutPoints::Spread, travel);
                let Ok(equations) = equations else { continue };
                let Ok(start) = equations.placed(0.0) else {
                    continue;
                };
                equations.for_each_pose(&start, sweep.stations.values(), &mut |_, pose| {
                    solved += usize::from(black_box(pose).is_ok());
                });
            }
            solved
        };
        // Designs without a pose do not reduce the time per pose.
        let items = solved();
        (items > 0).then(|| Job {
            items,
            work: Box::new(move || _ = black_box(solved())),
        })
    }
}
