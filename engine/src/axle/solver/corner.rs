//! Solver state of one wheel of the axle.

use super::*;

/// Solver for one corner of the axle.
#[derive(Clone, Debug)]
pub(super) struct Corner<'a, const N: usize> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) solver: Solver<'a>,
    /// Power series of poses in the travel, from which the heights of contact points are computed.
    pub(super) slopes: DesignSeries<TERMS>,
    pub(super) series: DesignSeries<N>,
    /// Sign of the rack displacement in the wheel's own frame: 1 for the left wheel, -1 for the right wheel. For a
    /// rigid axle, the held travel takes the place of the rack displacement. The mean travel has the sign 1 on both
    /// sides.
    pub(super) rack_sign: f64,
    pub(super) toggles: Toggles,
    /// Rack displacement (or held travel) at which the search for toggles started, as in the closure equations. `None`
    /// before the first search.
    pub(super) begun: Option<f64>,
    /// Ends of travel that were found for this design and the present displacement of its steering gear.
    pub(super) ends: Vec<End>,
    pub(super) side: Side,
    /// Points whose positions are computed with the wheel.
    pub(super) points: Vec<PointId>,
    /// True if condition numbers of the closure equations' Jacobian are computed with the wheel.
    pub(super) has_condition: bool,
    /// State of the steering gear of a steered axle.
    pub(super) steered: Steered,
}

/// Numbers of a wheel that are computed in a pose.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'w> {
    /// Straight lines in travel and rack along which the series are computed.
    pub(super) lines: &'w [Line],
    pub(super) parts: &'w Parts,
    pub(super) points: &'w [PointId],
    pub(super) has_condition: bool,
}

/// State of a steered axle for one displacement of its steering gear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steered {
    /// Displacement of the steering gear.
    pub(super) displacement: f64,
    /// Failure, if a rod cannot reach the displacement of the steering gear.
    pub(super) failure: Option<Failure>,
    /// Travels of the wheel centres after their knuckles have turned, while the axle is at rest. The first is the
    /// travel that drives the axle; the second is the held travel.
    pub(super) offsets: [f64; 2],
}

impl Steered {
    /// State with the steering gear centred.
    pub(super) const MIDDLE: Steered = Steered {
        displacement: 0.0,
        failure: None,
        offsets: [0.0; 2],
    };
}

/// End of the travel at one rack displacement, both as in the closure equations ([`Corner::inner`]). The search for an end
/// takes as long as a hundred poses, so the end is stored. A search for a roll angle that does not exist needs the same end
/// many times.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) rack: f64,
    pub(super) travel: f64,
    /// Failure beyond the end, with the limit as a travel of the wheel centres.
    pub(super) failure: Failure,
}

/// Pose of a wheel with its derivatives with respect to travel, and the height of its contact point above the origin.
pub(super) struct WheelSeries {
    pub(super) pose: Pose<Jet<f64, TERMS>>,
    pub(super) height: Jet<f64, TERMS>,
}

impl WheelSeries {
    pub(super) fn of(
        at: &Configuration<Jet<f64, TERMS>>,
        centre: PointId,
        ground: Ground<f64>,
        radius: f64,
    ) -> Self {
        let ground = ground.map(Jet::constant);
        let contact = at.point(centre) + ground.contact_lever(at.spin_axis(), radius);
        WheelSeries {
            pose: at.pose,
            height: ground.normal().dot(contact),
        }
    }

    /// Pose after a small step in travel.
    pub(super) fn moved(&self, step: f64) -> Pose<f64> {
        if step == 0.0 {
            return self.pose.map(|c| c[0]);
        }
        let along = |c: Jet<f64, TERMS>| c[0] + step * (c[1] + step * (c[2] + step * c[3]));
        let pose = self.pose.map(along);
        Pose {
            origin: pose.origin,
            rotation: pose.rotation.orthonormalised(),
        }
    }
}

/// Returns the change of half the difference of travels that brings both contact points to the same height. It is
/// computed from the series of both wheels.
pub(super) fn solve_level(left: &Jet<f64, TERMS>, right: &Jet<f64, TERMS>) -> f64 {
    // The right wheel moves in the opposite direction.
    let f = [0, 1, 2, 3].each(|k| match k % 2 {
        0 => left[k] - right[k],
        _ => left[k] + right[k],
    });
    let mut step = -f[0] / f[1];
    for _ in 0..4 {
        let value = f[0] + step * (f[1] + step * (f[2] + step * f[3]));
        let slope = f[1] + step * (2.0 * f[2] + step * 3.0 * f[3]);
        step -= value / slope;
    }
    step
}

impl<'a, const N: usize> Corner<'a, N> {
    pub(super) fn new(
        axle: &'a Axle,
        side: Side,
        parts: &Parts,
        rockers: &[RockerId],
    ) -> Result<Self, DesignFault> {
        let suspension = axle.suspension(side);
        let mechanism = &suspension.mechanism;
        let design = &suspension.design;
        Ok(Corner {
            mechanism,
            solver: Solver::new(mechanism, design)?,
            slopes: DesignSeries::new(mechanism, design).with_steering_axis(false),
            series: DesignSeries::new(mechanism, design)
                .with_steering_axis(parts.contain_steering_axis()),
            rack_sign: match &mechanism.rigid_axle {
                Some(rigid) if rigid.held == AxleTravel::Mean => 1.0,
                _ => side.sign(),
            },
            toggles: Toggles::of(mechanism, rockers.iter().copied()),
            begun: None,
            ends: Vec::new(),
            side,
            points: Vec::new(),
            has_condition: false,
            steered: Steered::MIDDLE,
        })
    }

    /// Moves the steering gear of a steered axle to a displacement. Other axles do not change.
    pub(super) fn steer(&mut self, displacement: f64) -> Result<(), NoPose> {
        let Some(steering) = self.mechanism.axle_steering() else {
            return Ok(());
        };
        if self.steered.displacement != displacement {
            self.steered = self.steered_by(displacement, steering);
        }
        match self.steered.failure {
            None => Ok(()),
            Some(failure) => Err(self.fails(0.0, failure)),
        }
    }

    fn steered_by(&mut self, displacement: f64, steering: &AxleSteering) -> Steered {
        let designed = self.solver.design().to_vec();
        let displaced = |part: f64| {
            let mut design = designed.clone();
            steering.displace(part * displacement, &mut design);
            design
        };
        let knuckles = [steering.near_knuckle, steering.far_knuckle];
        let toggle = Toggles::of(self.mechanism, knuckles).on_way(self.mechanism, displaced);
        let fails = |failure: Failure| Steered {
            displacement,
            failure: Some(failure),
            offsets: [0.0; 2],
        };
        if let Some(rod) = toggle {
            return fails(Failure::Toggle(rod));
        }
        let mut design = designed;
        let offsets = displace(self.mechanism, &mut design, displacement);
        // The solver has already accepted this design with its steering gear centred. So an error here means that the
        // displacement makes the design singular.
        if self.prepare_design(&design).is_err() {
            return fails(Failure::Singular);
        }
        Steered {
            displacement,
            failure: None,
            offsets,
        }
    }

    /// Converts travel and rack displacement to the values in the closure equations. For a steered axle, these are its
    /// driving and held travel by equations (4) and (5) of `model/steered_axle.rs`. For other axles, they equal the
    /// arguments.
    pub(super) fn inner(&self, travel: f64, rack: f64) -> (f64, f64) {
        let [drive, held] = self.steered.offsets;
        (travel - drive, rack - held)
    }

    /// Changes to another design. The steering gear of the new design is centred.
    pub(super) fn prepare(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.steered = Steered::MIDDLE;
        self.prepare_design(design)
    }

    fn prepare_design(&mut self, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        self.solver.prepare(design)?;
        self.slopes.prepare(self.mechanism, design);
        self.series.prepare(self.mechanism, design);
        self.begun = None;
        self.ends.clear();
        Ok(())
    }

    /// Returns the failure if a travel is beyond a known end. `None` if the travel is within all known ends. The arguments
    /// are travel and rack displacement as in the closure equations ([`Corner::inner`]). Beyond an end, the travel has the
    /// sign of the end and a larger magnitude.
    fn beyond_an_end(&self, travel: f64, rack: f64) -> Option<Failure> {
        let is_beyond =
            |end: &&End| end.rack == rack && (travel - end.travel) * end.travel.signum() > 0.0;
        let end = self.ends.iter().find(is_beyond)?;
        Some(end.failure)
    }

    /// Prepares the search for toggles at this rack displacement.
    pub(super) fn begin(&mut self, rack: f64) -> Result<(), DesignFault> {
        let (_, rack) = self.inner(0.0, rack);
        if self.begun == Some(rack) {
            self.toggles.begin_again()
        } else {
            self.toggles.begin(&mut self.solver, Drive::Travel, rack)?;
            self.begun = Some(rack);
        }
        Ok(())
    }

    /// Makes the reason why there is no pose, from a failure of this wheel at a travel. For a rigid axle with constant
    /// mean travel, `travel` is half the difference of the travels.
    pub(super) fn fails(&self, travel: f64, failure: Failure) -> NoPose {
        if self.mechanism.rigid_axle.is_some() {
            return NoPose::RigidAxle {
                difference: 2.0 * travel * self.side.sign(),
                failure,
                side: self.side,
            };
        }
        NoPose::Wheel {
            side: self.side,
            travel,
            failure,
        }
    }

    /// Configuration of the wheel in a pose, with the rack centred.
    pub(super) fn configuration(&self, pose: Pose<f64>) -> Configuration<'_, f64> {
        Configuration::new(self.mechanism, self.solver.design(), pose, 0.0)
    }

    /// Solves the pose at a travel and passes it to `read`.
    pub(super) fn at<R>(
        &mut self,
        travel: f64,
        rack: f64,
        mut read: impl FnMut(&Solver, &DesignSeries<TERMS>, &Pose<f64>) -> Result<R, Failure>,
    ) -> Result<R, NoPose> {
        let (inner_travel, inner_rack) = self.inner(travel, rack);
        if let Some(failure) = self.beyond_an_end(inner_travel, inner_rack) {
            return Err(self.fails(travel, failure));
        }
        let order = StationOrder::through(&[inner_travel]);
        let mut found = Err(Failure::Singular);
        let Corner { solver, slopes, .. } = self;
        let visit = |solver: &Solver, _, pose: Result<&Pose<f64>, Failure>| {
            found = pose.and_then(|pose| read(solver, slopes, pose));
            ControlFlow::Continue(())
        };
        let visited = solver.for_each_pose(Drive::Travel, &order, inner_rack, visit);
        // The constructor of the solver has already checked the design position, so this failure cannot occur.
        let found = visited.map_err(|_| Failure::Singular).and(found);
        found.map_err(|inner| {
            let failure = self.outer(inner);
            if let Failure::Unreachable { limit, .. } = inner {
                self.ends.push(End {
                    rack: inner_rack,
                    travel: limit,
                    failure,
                });
            }
            self.fails(travel, failure)
        })
    }

    /// Converts a failure of the closure equations. The limit in the failure becomes a travel of the wheel centres,
    /// measured from their hardpoints.
    fn outer(&self, failure: Failure) -> Failure {
        let [drive, held] = self.steered.offsets;
        match failure {
            Failure::Unreachable {
                drive: kind,
                limit,
                cause,
            } => Failure::Unreachable {
                drive: kind,
                limit: limit + drive,
                cause,
            },
            Failure::RackUnreachable { limit, cause } => Failure::RackUnreachable {
                limit: limit + held,
                cause,
            },
            failure => failure,
        }
    }

    /// Solves the wheel at a travel on this ground. Returns series of its pose and of the height of its contact point in
    /// the travel.
    pub(super) fn height(
        &mut self,
        travel: f64,
        rack: f64,
        ground: Ground<f64>,
        radius: f64,
    ) -> Result<WheelSeries, NoPose> {
        let rack = rack * self.rack_sign;
        let (inner_travel, inner_rack) = self.inner(travel, rack);
        let motion = MotionPoint {
            drive: Drive::Travel,
            value: inner_travel,
            rack: inner_rack,
        };
        let centre = self.mechanism.wheel_centre;
        self.at(travel, rack, |solver, slopes, pose| {
            let at = solver.configuration_series(slopes, pose, &motion.along_drive())?;
            Ok(WheelSeries::of(&at, centre, ground, radius))
        })
    }

    /// Returns true if a pose at a travel satisfies the closure equations within their rounding.
    pub(super) fn closes(&self, pose: &Pose<f64>, travel: f64, rack: f64) -> bool {
        let (value, rack) = self.inner(travel, rack * self.rack_sign);
        let point = MotionPoint {
            drive: Drive::Travel,
            value,
            rack,
        };
        self.solver.closes(pose, &point)
    }

    /// Solves the wheel at many travels, each on its own ground. `None` for a travel that the wheel cannot reach, or at which
    /// it has no derivatives.
    pub(super) fn heights(
        &mut self,
        travels: &[f64],
        rack: f64,
        ground: impl Fn(usize) -> Ground<f64>,
        radius: f64,
    ) -> Vec<Option<WheelSeries>> {
        let (_, rack) = self.inner(0.0, rack * self.rack_sign);
        let travels: Vec<f64> = travels.iter().map(|z| self.inner(*z, 0.0).0).collect();
        let centre = self.mechanism.wheel_centre;
        let mut found: Vec<_> = travels.iter().map(|_| None).collect();
        let order = StationOrder::through(&travels);
        let Corner { solver, slopes, .. } = self;
        // Stations that cannot be reached stay `None`.
        let _ = solver.for_each_pose(Drive::Travel, &order, rack, |solver, station, pose| {
            let motion = MotionPoint {
                drive: Drive::Travel,
                value: travels[station],
                rack,
            };
            let at = pose
                .and_then(|pose| solver.configuration_series(slopes, pose, &motion.along_drive()));
            let standing = at.map(|at| WheelSeries::of(&at, centre, ground(station), radius));
            found[station] = standing.ok();
            ControlFlow::Continue(())
        });
        found
    }

    /// Computes the values of the wheel at a travel and a rack displacement, both in this wheel's own frame.
    pub(super) fn read(
        &self,
        pose: &Pose<f64>,
        travel: f64,
        rack: f64,
        (lines, parts): (&[Line], &Parts),
    ) -> Result<WheelRead, Failure> {
        let Corner {
            solver,
            series,
            toggles,
            points,
            has_condition,
            ..
        } = self;
        let wanted = Wanted {
            lines,
            parts,
            points,
            has_condition: *has_condition,
        };
        let place = self.inner(travel, rack);
        let read = read_wheel(solver, series, toggles, pose, place, wanted)?;
        // If a knuckle is beyond its toggle, the wheel has no position.
        if let Some(steering) = self.mechanism.axle_steering() {
            for knuckle in [steering.near_knuckle, steering.far_knuckle] {
                if toggles.holds(knuckle) {
                    return Err(Failure::Toggle(self.mechanism.rocker(knuckle).rod));
                }
            }
        }
        Ok(read)
    }
}

/// Computes the values of a wheel at a travel and a rack displacement, both as in the closure equations ([`Corner::inner`]).
pub(super) fn read_wheel<const N: usize>(
    solver: &Solver,
    series: &DesignSeries<N>,
    toggles: &Toggles,
    pose: &Pose<f64>,
    (travel, rack): (f64, f64),
    wanted: Wanted<'_>,
) -> Result<WheelRead, Failure> {
    let Wanted {
        lines,
        parts,
        points,
        has_condition,
    } = wanted;
    let mut snapshots = [Snapshot::<N>::unknown(); 4];
    // Positions of the points: for each line in travel and rack, one series per point.
    let mut ways = Vec::new();
    let (mut condition, mut toggle) = (has_condition.then_some(0.0_f64), None);
    for (number, line) in lines.iter().enumerate() {
        let motion = along(line, travel, rack);
        let at = if let Some(largest) = &mut condition {
            let (at, own) = solver.conditioned_series(series, pose, &motion)?;
            *largest = largest.max(own.number);
            at
        } else {
            solver.configuration_series(series, pose, &motion)?
        };
        snapshots[number] = Snapshot::of(&at, parts);
        ways.extend(points.iter().map(|id| at.point(*id)));
        if number == 0 {
            toggle = toggles.note(Some(solver), &at, travel);
        }
    }
    Ok(WheelRead {
        travel,
        pose: *pose,
        reading: Reading::of(&snapshots[..lines.len()]),
        condition,
        toggle,
        stuck: toggles.held(),
        points: (0..points.len())
            .map(|point| {
                let along = |axis: Axis| {
                    let lines = ways.chunks_exact(points.len());
                    let series: Vec<&[f64]> = lines.map(|way| &way[point][axis].0[..]).collect();
                    Taylor::through(&series)
                };
                Vector3::from(Axis::ALL.each(along))
            })
            .collect(),
    })
}
