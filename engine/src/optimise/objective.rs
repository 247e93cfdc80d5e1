//! Targets and constraints of a study as a least-squares problem over its variables.
//!
//! A residual is the deviation from a target at one station, in multiples of the tolerance, times a factor s that follows
//! from the target's weight. The deviation from a band is measured from the nearer limit of the band. The misfit is the root
//! mean square of all residuals. The factors are chosen so that
//!
//! ```text
//! misfit^2 = sum_targets weight rms^2 / sum_targets weight,   rms over the stations of one target
//! ```
//!
//! This holds for any number of stations. If the targets are measurements (`fit = true`), s depends only on the weights of
//! the targets, and each measured point of a target has the same weight. Each station needs one pose, one factorisation, and
//! one adjoint for each value.
//!
//! Limits of a rigid wheel also hold between the stations: see [`extremes`](super::extremes). Other limits, and equalities,
//! hold at the stations only.

mod margins;

use super::axle::{Moved, RowsBeside, ScatteredRate, axle_rows, moved_points};
use super::carried::AlongVariables;
use super::constrained::{Assessment, Constrained, Shape};
use super::elastic::elastic_rows;
use super::extremes::{self, FAR, SEARCHES, Search};
use super::lane_rows::{Checked, LaneRows};
use super::layout::{Beside, Extremes, Leg, TargetLayout};
use super::moved_wheel::MovedWheel;
use super::robust::Robust;
use super::station_reader::{
    PartValues, ReadStations, Reader, Reading, Visit, read, read_poses, reader, refused,
};
use super::{Infeasible, LeastSquares, Linearisation};
use crate::characteristics::{Constants, WheelReading};
use crate::mechanism::DesignFault;
use crate::model::{PointId, Side, Suspension};
use crate::number::Width;
use crate::solve::{Solver, StationOrder, Toggles};
use crate::study::{Scatter, Variable, Vehicle};
use nalgebra::DVector;

/// Least-squares problem of a study's targets and constraints, with its workspace.
pub struct Objective<'a> {
    pub(super) variables: &'a [Variable],
    pub(super) layout: &'a TargetLayout,
    constants: Constants,
    /// The wheel, or the left wheel of an axle.
    pub(super) wheel: MovedWheel<'a>,
    /// Right wheel of an axle, if its hardpoints differ from the left ones. `None` for one wheel, or if the right wheel is
    /// the mirror image of the left wheel.
    pub(super) right: Option<MovedWheel<'a>>,
    /// Evaluation in SIMD lanes (several poses at once), for designs and builds that the solver in lanes accepts. `None` if
    /// lanes are switched off, or if a target is not available in lanes. Also `None` if no target applies to a leg (a
    /// motion at one rack displacement).
    pub(super) lanes: Option<LaneRows<'a>>,
    robust: Option<Robust<'a>>,
    solver: Solver<'a>,
    toggles: Toggles,
    reader: Box<dyn ReadStations + 'a>,
    /// Evaluator of poses ([`Reader`]) with two derivatives with respect to the drive value, for the search for extremes.
    /// `None` if no limit applies to extremes.
    sloped: Option<Reader<3>>,
    /// Taylor series of the design along each variable, from which the derivatives of member forces follow. `None` if no
    /// target or constraint uses a member force.
    moving: Option<AlongVariables>,
    /// Evaluator of the targets and constraints of an axle or of elastic parts. `None` if there are none.
    beside: Option<Box<dyn RowsBeside + 'a>>,
    values: PartValues,
    searches: Vec<Search>,
    /// Distance from a row to its limit, in the unit of the rows, above which the search for an extreme is skipped.
    far: f64,
    /// Drive values of the extremes whose values are in the rows.
    extremes: Vec<Option<f64>>,
}

impl<'a> Objective<'a> {
    /// Makes the problem of a suspension.
    pub fn new(
        suspension: &'a Suspension,
        variables: &'a [Variable],
        layout: &'a TargetLayout,
    ) -> Result<Self, DesignFault> {
        let design = &suspension.design;
        let points = moved_points(variables);
        let mechanism = &suspension.mechanism;
        let parts = layout.parts.iter().map(|part| &part.limited.of);
        let all = || layout.measures.iter().chain(parts.clone());
        let rockers = all().flat_map(|measure| measure.rockers(mechanism));
        let has_extremes = layout.legs.iter().any(|leg| !leg.extremes.is_empty());
        Ok(Objective {
            variables,
            layout,
            constants: Constants::of(suspension),
            wheel: MovedWheel::new(suspension, suspension.frame),
            right: match &layout.beside {
                Some(Beside::Axle(own)) => {
                    let right = own.axle.right.as_ref();
                    right.map(|right| MovedWheel::new(right, suspension.frame))
                }
                _ => None,
            },
            lanes: (Width::widest())
                .and_then(|width| LaneRows::new(suspension, layout, true, width)),
            robust: None,
            solver: Solver::new(&suspension.mechanism, design)?,
            toggles: Toggles::of(mechanism, rockers),
            reader: reader(suspension, layout, &points, variables.len()),
            sloped: has_extremes.then(|| Reader::new(suspension, layout, &points, variables.len())),
            moving: AlongVariables::new(suspension, variables.len(), all()),
            beside: match &layout.beside {
                Some(Beside::Axle(axle)) => Some(axle_rows(axle, &axle.axle, &points, variables)?),
                Some(Beside::Elastic(elastic)) => {
                    Some(elastic_rows(elastic, suspension, variables, points))
                }
                None => None,
            },
            values: vec![Vec::new(); layout.parts.len()],
            searches: Vec::new(),
            far: FAR,
            extremes: vec![None; layout.labels.len()],
        })
    }

    /// Makes the problem of a robust tuning. Its residuals are the residuals of the builds. If `width` is given, the builds of
    /// a rigid wheel that lanes can evaluate are solved in lanes. All other builds are solved one by one. `assembled` comes
    /// from [`Vehicle::assembled`]; the wheels of `assembled` may have additional points.
    pub fn of_builds(
        assembled: &'a Vehicle,
        variables: &'a [Variable],
        layout: &'a TargetLayout,
        scatter: &'a Scatter,
        width: Option<Width>,
    ) -> Result<Self, DesignFault> {
        let suspension = assembled.wheel();
        let mut objective = Objective::new(suspension, variables, layout)?;
        // If the tuning moves any point of the nominal design, the assembly can move every point of a build.
        let all: Vec<PointId> = (0..suspension.design.len()).map(PointId).collect();
        objective.reader = reader(suspension, layout, &all, variables.len());
        let frame = suspension.frame;
        objective.wheel = MovedWheel::assembled(suspension, frame);
        let moving = if variables.is_empty() {
            Vec::new()
        } else {
            all
        };
        if let Vehicle::Axle(both) = assembled {
            let right = both.axle.suspension(Side::Right);
            objective.right = Some(MovedWheel::assembled(right, frame));
            if let Some(Beside::Axle(layout)) = &layout.beside {
                objective.beside = Some(axle_rows(layout, &both.axle, &moving, variables)?);
            }
        }
        if let Some(Beside::Elastic(elastic)) = &layout.beside {
            objective.beside = Some(elastic_rows(elastic, suspension, variables, moving));
        }
        // Axles and elastic parts are not evaluated in lanes.
        let width = width.filter(|_| layout.beside.is_none());
        // Constraints apply to the nominal design, which is evaluated without lanes. So the builds in lanes have no
        // constraint rows.
        objective.lanes = width.and_then(|width| LaneRows::new(suspension, layout, false, width));
        objective.robust = Some(Robust::new(assembled, scatter, variables.len(), width)?);
        Ok(objective)
    }

    /// Returns the problem with poses solved in SIMD lanes of this width, or station by station if `width` is `None`. Used
    /// to compare the two methods.
    #[must_use]
    pub fn with_width(mut self, suspension: &'a Suspension, width: Option<Width>) -> Self {
        self.lanes = width.and_then(|width| LaneRows::new(suspension, self.layout, true, width));
        self
    }

    /// Returns true if the design at `x` is evaluated in SIMD lanes (several poses at once).
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

    /// Number of builds that the last evaluation solved in SIMD lanes (several builds at once).
    pub fn builds_in_lanes(&self) -> usize {
        let robust = self.robust.as_ref().filter(|_| self.lanes.is_some());
        robust.map_or(0, Robust::builds_in_lanes)
    }

    /// The wheel, or both wheels of an axle. A right wheel that is the mirror image of the left wheel is not included.
    pub(super) fn wheels(&self) -> impl Iterator<Item = &MovedWheel<'a>> {
        [Some(&self.wheel), self.right.as_ref()]
            .into_iter()
            .flatten()
    }

    /// Moves the design, or the nominal design of builds, to `x`.
    fn move_to(&mut self, x: &DVector<f64>) {
        let variables = self.variables;
        self.wheel.move_to(variables, x);
        let Some(right) = &mut self.right else {
            return;
        };
        right.move_to(variables, x);
        // In a build, every point moves independently, so the design of the build is already complete.
        if let (Some(_), Some(rigid)) = (&self.robust, &self.solver.mechanism().rigid_axle) {
            self.wheel.complete(right, rigid, variables.len());
        }
    }

    /// Moves the design to `x`. Writes its residuals into `into`, and the rows of the constraints into `rows` if given.
    pub(super) fn evaluate_all(
        &mut self,
        x: &DVector<f64>,
        into: &mut Linearisation,
        rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        self.move_to(x);
        self.evaluate_here(x, into, rows)
    }

    /// Writes residuals and rows like [`Objective::evaluate_all`], for the design to which the wheels have been moved. The
    /// variables that are rates have the values `x`.
    fn evaluate_here(
        &mut self,
        x: &DVector<f64>,
        into: &mut Linearisation,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        self.extremes.fill(None);
        let Some(mut robust) = self.robust.take() else {
            if !self.evaluate_in_lanes(into, rows.as_deref_mut())? {
                self.evaluate_moved(Some((&mut *into, 0)), rows.as_deref_mut())?;
            }
            return self.evaluate_beside(x, None, Some((into, 0)), rows);
        };
        // Constraints apply to the nominal design. So its rows are evaluated before the builds replace the nominal design.
        let found = match &mut rows {
            Some(rows) => {
                let rigid = self.evaluate_moved(None, Some(&mut **rows));
                rigid.and_then(|()| self.evaluate_beside(x, None, None, Some(rows)))
            }
            None => Ok(()),
        };
        let found = found.and_then(|()| robust.evaluate(self, x, into));
        self.robust = Some(robust);
        found
    }

    /// Writes the rows of an axle or of elastic parts for the moved design. `scattered` holds the scattered elastic rates of
    /// a build; it is `None` for the nominal design.
    pub(super) fn evaluate_beside(
        &mut self,
        x: &DVector<f64>,
        scattered: Option<&[ScatteredRate]>,
        into: Option<(&mut Linearisation, usize)>,
        rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let Some(beside) = &mut self.beside else {
            return Ok(());
        };
        let left = self.wheel.moved();
        let moved = Moved {
            variables: self.variables,
            x,
            wheels: [left, self.right.as_ref().map_or(left, MovedWheel::moved)],
            scattered: scattered.unwrap_or_default(),
            is_build: scattered.is_some(),
        };
        beside.evaluate(&moved, into, rows)
    }

    /// Evaluates the moved design of one wheel in lanes. Returns false if some row is not available in lanes, or if the
    /// solver in lanes rejects the design. The caller must then overwrite the written values.
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
        let (design, point_rates) = self.wheel.moved();
        lanes.begin(design.len(), point_rates, self.variables.len());
        let found = self.evaluate_legs(&mut lanes, into, rows);
        self.lanes = Some(lanes);
        found
    }

    /// Evaluates the moved design in lanes, one leg (a motion at one rack displacement) after another. Returns false under
    /// the conditions of [`Objective::evaluate_in_lanes`].
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
            if !lanes.of_leg(number, self.layout, &self.wheel.design, into, checked) {
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

    /// Solves and reads the poses of one wheel with the moved design, one by one. Writes the residuals into `into`,
    /// from the given row on, and the rows of the constraints into `rows`. Skips the stations that neither of them needs:
    /// a build may lack a pose where only constraints apply.
    pub(super) fn evaluate_moved(
        &mut self,
        mut into: Option<(&mut Linearisation, usize)>,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        self.prepare()?;
        for leg in &self.layout.legs {
            let Some(order) = leg.order_of(into.is_some(), rows.is_some()) else {
                continue;
            };
            self.begin(leg)?;
            self.reader.visit(Visit {
                leg,
                order,
                layout: self.layout,
                constants: self.constants,
                point_rates: &self.wheel.point_rates,
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

    /// Lists the searches for extremes in a leg (a motion at one rack displacement), from the values at its stations.
    fn list_searches(&mut self, leg: &Leg, rows: &Linearisation) {
        let (parts, values) = (&self.layout.parts, &self.values);
        extremes::searches(leg, parts, values, (rows, self.far), &mut self.searches);
    }

    /// Prepares to solve the moved design station by station.
    fn prepare(&mut self) -> Result<(), Infeasible> {
        let mechanism = self.solver.mechanism();
        let (design, point_rates) = self.wheel.moved();
        let prepared = self.solver.prepare(design);
        prepared.map_err(refused(mechanism))?;
        self.reader.prepare(mechanism, design);
        if let Some(moving) = &mut self.moving {
            moving.prepare(&self.solver, design, point_rates);
        }
        if let Some(sloped) = &mut self.sloped {
            sloped.series.prepare(mechanism, design);
        }
        Ok(())
    }

    /// Prepares to visit the stations of a leg (a motion at one rack displacement).
    fn begin(&mut self, leg: &Leg) -> Result<(), Infeasible> {
        let mechanism = self.solver.mechanism();
        let begun = self.toggles.begin(&mut self.solver, leg.drive, leg.rack);
        begun.map_err(refused(mechanism))
    }

    /// Runs the listed searches for extremes between the stations of a leg (a motion at one rack displacement). In the
    /// rows, the value at an extreme replaces the value at its station if it is nearer to the limit or beyond it.
    fn find_extremes(&mut self, leg: &Leg, rows: &mut Linearisation) -> Result<(), Infeasible> {
        let Objective {
            layout,
            constants,
            wheel,
            solver,
            sloped: Some(reader),
            searches,
            moving,
            extremes,
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
                let limit = limit.expect("an extreme belongs to a limit");
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
                        point_rates: &wheel.point_rates,
                        moving: moving.as_ref(),
                    });
                    rows.residuals[search.row] = value;
                    extremes[search.row] = Some(place.value);
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
