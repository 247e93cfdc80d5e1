//! Targets and constraints of a study as a least-squares problem over its variables.
//!
//! A residual is the deviation from a target at one station, in tolerances, times a share s of the target's weight. The
//! deviation from a band is measured from the nearer limit. The misfit is the root mean square of all residuals. The shares
//! are such that
//!
//! ```text
//! misfit^2 = sum_targets weight rms^2 / sum_targets weight,   rms over the target's own stations
//! ```
//!
//! for any numbers of stations. One visit of a station gives everything: the pose, one factorisation, and one adjoint for
//! each value.
//!
//! Constraints also hold between the stations: see [`extremes`](super::extremes).

use super::axle::{Moved, RowsBeside, ScatteredRate, axle_rows, moved_points};
use super::builds::{Builds, follower};
use super::carried::AlongVariables;
use super::constrained::{Assessment, Constrained, Shape};
use super::elastic::elastic_rows;
use super::extremes::{self, SEARCHES, Search};
use super::lane_builds::LaneBuilds;
use super::lane_rows::{Checked, LaneRows};
use super::layout::{Beside, Extremes, Leg, TargetLayout};
use super::moves::{PointRate, moved_design, point_rates};
use super::station_reader::{
    PartValues, ReadStations, Reader, Reading, Visit, read, read_poses, reader, refused,
};
use super::{Infeasible, LeastSquares, Linearisation};
use crate::characteristics::{Constants, WheelReading};
use crate::mechanism::DesignFault;
use crate::model::{Frame, PointId, Suspension};
use crate::number::{Vector3, Width};
use crate::solve::{Solver, StationOrder, Toggles};
use crate::study::{Scatter, Variable};
use nalgebra::DVector;

/// The problem, with its workspace.
pub struct Objective<'a> {
    frame: Frame,
    variables: &'a [Variable],
    layout: &'a TargetLayout,
    constants: Constants,
    design: &'a [Vector3<f64>],
    moved: Vec<Vector3<f64>>,
    point_rates: Vec<PointRate>,
    /// Lane evaluation of designs (and builds) that the tracker accepts. `None` if lanes cannot read a target, or if lanes
    /// are switched off.
    lanes: Option<LaneRows<'a>>,
    robust: Option<Robust<'a>>,
    solver: Solver<'a>,
    toggles: Toggles,
    reader: Box<dyn ReadStations + 'a>,
    /// Reader with one more derivative by the drive. The search for extremes needs it.
    sloped: Option<Reader<3>>,
    /// Rates at which forces under loads change with the variables. `None` if no target or constraint concerns a force.
    moving: Option<AlongVariables>,
    /// Rows of targets of an axle or of elastic parts. `None` if there are none.
    beside: Option<Box<dyn RowsBeside + 'a>>,
    values: PartValues,
    searches: Vec<Search>,
}

/// Builds of a robust tuning. Their residuals replace those of the nominal design.
struct Robust<'a> {
    builds: Builds<'a>,
    lanes: Option<LaneBuilds>,
    /// Buffer for the design of a build.
    built: Vec<Vector3<f64>>,
    follower: Option<(PointId, PointId)>,
}

impl<'a> Objective<'a> {
    /// Makes the problem of a suspension.
    pub fn new(
        suspension: &'a Suspension,
        variables: &'a [Variable],
        layout: &'a TargetLayout,
    ) -> Result<Self, DesignFault> {
        let design = &suspension.design;
        let mut points: Vec<PointId> = Vec::new();
        for variable in variables {
            points.extend(variable.moves.iter().map(|m| m.point));
            points.extend(variable.turn.iter().flat_map(|turn| &turn.points));
        }
        let mechanism = &suspension.mechanism;
        let parts = layout.parts.iter().map(|part| &part.limited.of);
        let all = || layout.measures.iter().chain(parts.clone());
        let rockers = all().flat_map(|measure| measure.rockers(mechanism));
        let has_extremes = layout.legs.iter().any(|leg| !leg.extremes.is_empty());
        Ok(Objective {
            frame: suspension.frame,
            variables,
            layout,
            constants: Constants::of(suspension),
            design,
            moved: design.clone(),
            point_rates: Vec::new(),
            lanes: LaneRows::new(suspension, layout, true, Width::widest()),
            robust: None,
            solver: Solver::new(&suspension.mechanism, design)?,
            toggles: Toggles::of(mechanism, rockers),
            reader: reader(suspension, layout, &points, variables.len()),
            sloped: has_extremes.then(|| Reader::new(suspension, layout, &points, variables.len())),
            moving: AlongVariables::new(suspension, variables.len(), all()),
            beside: match &layout.beside {
                Some(Beside::Axle(axle)) => Some(axle_rows(axle, variables)?),
                Some(Beside::Elastic(elastic)) => {
                    let points = moved_points(variables);
                    Some(elastic_rows(elastic, suspension, variables, points))
                }
                None => None,
            },
            values: vec![Vec::new(); layout.parts.len()],
            searches: Vec::new(),
        })
    }

    /// Makes the problem of a robust tuning, whose residuals are those of builds. With `width` they are solved in lanes,
    /// otherwise build by build. `suspension` is the suspension of the `study` as [`crate::assembly::Assembler`] extends it:
    /// it may have an additional spindle point.
    pub fn of_builds(
        study: &Suspension,
        suspension: &'a Suspension,
        variables: &'a [Variable],
        layout: &'a TargetLayout,
        scatter: &'a Scatter,
        width: Option<Width>,
    ) -> Result<Self, DesignFault> {
        let mut objective = Objective::new(suspension, variables, layout)?;
        // A move of the nominal design may move every point of a build.
        let all: Vec<PointId> = (0..suspension.design.len()).map(PointId).collect();
        objective.reader = reader(suspension, layout, &all, variables.len());
        // Lanes do not evaluate elastic parts.
        let width = width.filter(|_| layout.beside.is_none());
        if let Some(Beside::Elastic(elastic)) = &layout.beside {
            let moving = all.into_iter().filter(|_| !variables.is_empty());
            objective.beside = Some(elastic_rows(elastic, suspension, variables, moving));
        }
        let builds = Builds::new(suspension, scatter)?;
        let points = suspension.design.len();
        // Constraints apply to the nominal design.
        objective.lanes = width.and_then(|width| LaneRows::new(suspension, layout, false, width));
        objective.robust = Some(Robust {
            lanes: width.map(|w| LaneBuilds::new(builds.draws(), points, variables.len(), w)),
            builds,
            built: suspension.design.clone(),
            follower: follower(study, suspension),
        });
        Ok(objective)
    }

    /// Returns the problem solved in lanes of this width, or station by station without a width. Used to compare the two.
    #[must_use]
    pub fn with_width(mut self, suspension: &'a Suspension, width: Option<Width>) -> Self {
        self.lanes = width.and_then(|width| LaneRows::new(suspension, self.layout, true, width));
        self
    }

    /// Returns true if the design at `x` is evaluated in lanes.
    pub fn is_in_lanes(&mut self, x: &DVector<f64>) -> bool {
        self.move_to(x);
        let mut into = Linearisation::new(self.layout.residuals(), x.len());
        let mut rows = Linearisation::new(self.layout.labels.len(), x.len());
        matches!(self.evaluate_in_lanes(&mut into, Some(&mut rows)), Ok(true))
    }

    /// Number of builds with residuals; 1 for the nominal design.
    pub(super) fn build_count(&self) -> usize {
        self.layout.builds
    }

    /// Number of builds that were evaluated in lanes.
    pub fn builds_in_lanes(&self) -> usize {
        let Some(robust) = self.robust.as_ref().filter(|_| self.lanes.is_some()) else {
            return 0;
        };
        let is_accepted = |b: &usize| robust.lanes.as_ref().is_some_and(|l| l.is_accepted(*b));
        (0..robust.builds.count()).filter(is_accepted).count()
    }

    /// Moves the design, or the nominal design of builds, to `x`.
    fn move_to(&mut self, x: &DVector<f64>) {
        let (frame, variables) = (&self.frame, self.variables);
        moved_design(self.design, frame, variables, x, &mut self.moved);
        point_rates(self.design, frame, variables, x, &mut self.point_rates);
        if let Some((follower, leader)) = self.robust.as_ref().and_then(|r| r.follower) {
            let from = self.design[follower.0] - self.design[leader.0];
            self.moved[follower.0] = self.moved[leader.0] + from;
            let follows = self
                .point_rates
                .iter()
                .filter(|rate| rate.point == leader.0);
            let point = follower.0;
            let point_rates: Vec<PointRate> =
                follows.map(|rate| PointRate { point, ..*rate }).collect();
            self.point_rates.extend(point_rates);
        }
    }

    /// Moves the design to `x`. Writes its residuals into `into`, and the rows of the constraints into `rows` if given.
    pub(super) fn evaluate_all(
        &mut self,
        x: &DVector<f64>,
        into: &mut Linearisation,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        self.move_to(x);
        let Some(mut robust) = self.robust.take() else {
            if !self.evaluate_in_lanes(into, rows.as_deref_mut())? {
                self.evaluate_moved(Some((&mut *into, 0)), rows.as_deref_mut())?;
            }
            return self.evaluate_beside(x, &[], Some((into, 0)), rows);
        };
        // Constraints apply to the nominal design.
        let found = match &mut rows {
            Some(rows) => {
                let rigid = self.evaluate_moved(None, Some(&mut **rows));
                rigid.and_then(|()| self.evaluate_beside(x, &[], None, Some(rows)))
            }
            None => Ok(()),
        };
        let found = found.and_then(|()| self.evaluate_builds(&mut robust, x, into));
        self.robust = Some(robust);
        found
    }

    /// Writes the rows of an axle or of elastic parts for the moved design, whose elastic rates scatter in a build.
    fn evaluate_beside(
        &mut self,
        x: &DVector<f64>,
        scattered: &[ScatteredRate],
        into: Option<(&mut Linearisation, usize)>,
        rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let Some(beside) = &mut self.beside else {
            return Ok(());
        };
        let moved = Moved {
            variables: self.variables,
            x,
            design: &self.moved,
            point_rates: &self.point_rates,
            scattered,
        };
        beside.evaluate(&moved, into, rows)
    }

    /// Evaluates the moved design of one wheel in lanes. Returns false if lanes cannot provide everything, or if the
    /// tracker rejects the design; the caller must then overwrite the written values.
    fn evaluate_in_lanes(
        &mut self,
        into: &mut Linearisation,
        rows: Option<&mut Linearisation>,
    ) -> Result<bool, Infeasible> {
        let rows = rows.filter(|_| !self.layout.labels.is_empty());
        let tell_all = |lanes: &mut LaneRows| rows.is_none() || lanes.has_parts();
        let Some(mut lanes) = self.lanes.take_if(tell_all) else {
            return Ok(false);
        };
        lanes.begin(self.moved.len(), &self.point_rates, self.variables.len());
        let found = self.evaluate_legs(&mut lanes, into, rows);
        self.lanes = Some(lanes);
        found
    }

    /// Evaluates the moved design in lanes, leg by leg. Returns false under the conditions of
    /// [`Objective::evaluate_in_lanes`].
    fn evaluate_legs(
        &mut self,
        lanes: &mut LaneRows<'a>,
        into: &mut Linearisation,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<bool, Infeasible> {
        let mut is_prepared = false;
        for (number, leg) in self.layout.legs.iter().enumerate() {
            let values = &mut self.values[..];
            let checked = rows.as_deref_mut().map(|rows| Checked { rows, values });
            if !lanes.of_leg(number, self.layout, &self.moved, into, checked) {
                return Ok(false);
            }
            let Some(rows) = &mut rows else {
                continue;
            };
            self.list_searches(leg, rows);
            if self.searches.is_empty() {
                continue;
            }
            if !is_prepared {
                self.prepare()?;
                is_prepared = true;
            }
            self.begin(leg)?;
            self.find_extremes(leg, rows)?;
        }
        Ok(true)
    }

    /// Writes the residuals of all builds of the moved nominal design. Builds that lanes cannot solve are solved one by one.
    fn evaluate_builds(
        &mut self,
        robust: &mut Robust<'a>,
        x: &DVector<f64>,
        into: &mut Linearisation,
    ) -> Result<(), Infeasible> {
        let (builds, built) = (&mut robust.builds, &mut robust.built);
        let alignment = builds.redraw(&self.moved)?;
        let mut lanes = robust.lanes.as_mut().zip(self.lanes.as_mut());
        if let Some((lanes, rows)) = &mut lanes {
            lanes.assemble(builds, alignment.as_ref(), &self.point_rates);
            rows.of_builds(self.layout, lanes, into);
        }
        let lanes = lanes.map(|(lanes, _)| lanes);
        for number in 0..builds.count() {
            if lanes
                .as_ref()
                .is_some_and(|lanes| lanes.is_accepted(number))
            {
                continue;
            }
            let variables = self.variables.len();
            builds.build(
                number,
                alignment.as_ref(),
                &self.point_rates,
                variables,
                built,
            )?;
            // The build temporarily replaces the nominal design.
            std::mem::swap(&mut self.moved, built);
            std::mem::swap(&mut self.point_rates, &mut builds.point_rates);
            let first = number * self.layout.rows;
            let found = self.evaluate_moved(Some((into, first)), None);
            let found = found.and_then(|()| {
                let scattered = builds.scattered_rates(number);
                self.evaluate_beside(x, &scattered, Some((into, first)), None)
            });
            std::mem::swap(&mut self.moved, built);
            std::mem::swap(&mut self.point_rates, &mut builds.point_rates);
            found.map_err(|reason| Infeasible::Refused(format!("build {number}: {reason}")))?;
        }
        Ok(())
    }

    /// Solves and reads the poses of one wheel with the moved design, one by one. Writes the residuals into `into`,
    /// from the given row on, and the rows of the constraints into `rows`.
    fn evaluate_moved(
        &mut self,
        mut into: Option<(&mut Linearisation, usize)>,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        self.prepare()?;
        for leg in &self.layout.legs {
            self.begin(leg)?;
            self.reader.visit(Visit {
                leg,
                layout: self.layout,
                constants: self.constants,
                point_rates: &self.point_rates,
                toggles: &self.toggles,
                moving: self.moving.as_ref(),
                solver: &mut self.solver,
                values: &mut self.values,
                into: into.as_mut().map(|(into, first)| (&mut **into, *first)),
                rows: rows.as_deref_mut(),
            })?;
            if let Some(rows) = &mut rows {
                self.list_searches(leg, rows);
                self.find_extremes(leg, rows)?;
            }
        }
        Ok(())
    }

    /// Lists the searches for extremes of a leg, from the values at its stations.
    fn list_searches(&mut self, leg: &Leg, rows: &Linearisation) {
        let (parts, values) = (&self.layout.parts, &self.values);
        extremes::searches(leg, parts, values, rows, &mut self.searches);
    }

    /// Prepares to solve the moved design station by station.
    fn prepare(&mut self) -> Result<(), Infeasible> {
        let mechanism = self.solver.mechanism();
        let prepared = self.solver.prepare(&self.moved);
        prepared.map_err(refused(mechanism))?;
        self.reader.prepare(mechanism, &self.moved);
        if let Some(moving) = &mut self.moving {
            moving.prepare(&self.solver, &self.moved, &self.point_rates);
        }
        if let Some(sloped) = &mut self.sloped {
            sloped.series.prepare(mechanism, &self.moved);
        }
        Ok(())
    }

    /// Prepares to visit the stations of a leg.
    fn begin(&mut self, leg: &Leg) -> Result<(), Infeasible> {
        let mechanism = self.solver.mechanism();
        let begun = self.toggles.begin(&mut self.solver, leg.drive, leg.rack);
        begun.map_err(refused(mechanism))
    }

    /// Runs the listed searches for extremes between the stations of a leg. In the rows, each extreme replaces the value at
    /// its station.
    fn find_extremes(&mut self, leg: &Leg, rows: &mut Linearisation) -> Result<(), Infeasible> {
        let Objective {
            layout,
            constants,
            point_rates,
            solver,
            sloped: Some(reader),
            searches,
            moving,
            ..
        } = self
        else {
            return Ok(());
        };
        for round in 1..=SEARCHES {
            if searches.is_empty() {
                break;
            }
            let places: Vec<f64> = searches.iter().map(|search| search.place).collect();
            let order = StationOrder::through(&places);
            read_poses(solver, leg, &order, |solver, number, place, pose| {
                let search = &mut searches[number];
                let motion = place.along_drive::<3>();
                let linearised = solver.linearised(&reader.series, pose, &motion)?;
                let Extremes { part, sign, .. } = &leg.extremes[search.of];
                let part = &layout.parts[*part].limited;
                let limit = if *sign > 0.0 { part.upper } else { part.lower };
                let limit = limit.expect("an extreme is sought for a limit");
                let scale = sign / part.scale;
                let view = WheelReading::reading(&linearised.at, *constants, layout.reads);
                let series = read(&part.of, &view, &linearised, solver.size());
                let value = (series[0] - limit) * scale;
                search.is_found = search.advance(series[1]) || round == SEARCHES;
                if search.is_found && value > search.at_station {
                    reader.slopes.form(&Reading {
                        measure: &part.of,
                        view: &view,
                        linearised: &linearised,
                        solver,
                        motion: place,
                        point_rates,
                        moving: moving.as_ref(),
                    });
                    rows.residuals[search.row] = value;
                    let slopes = &reader.slopes.by_variable;
                    rows.write_slopes(search.row, slopes, scale);
                }
                Ok(())
            })?;
            searches.retain(|search| !search.is_found);
        }
        Ok(())
    }
}

impl LeastSquares for Objective<'_> {
    fn variables(&self) -> usize {
        self.variables.len()
    }

    fn residuals(&self) -> usize {
        self.layout.residuals()
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible> {
        self.evaluate_all(x, into, None)
    }
}

impl Constrained for Objective<'_> {
    fn shape(&self) -> Shape {
        Shape {
            variables: self.variables.len(),
            goal: self.layout.residuals(),
            levels: Vec::new(),
            rows: self.layout.labels.len(),
            equalities: self.layout.equalities,
        }
    }

    fn row_limits(&self) -> Vec<f64> {
        self.layout.row_limits()
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        self.evaluate_all(x, &mut into.goal, Some(&mut into.rows))
    }
}
