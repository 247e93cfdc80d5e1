//! Residuals of a robust tuning. A robust tuning minimises the residuals of its builds, not the residuals of the nominal design.

use super::builds::Builds;
use super::lane_builds::LaneBuilds;
use super::moved_wheel::MovedWheel;
use super::{Infeasible, Linearisation, Objective};
use crate::mechanism::DesignFault;
use crate::number::Width;
use crate::study::{Scatter, Vehicle};
use nalgebra::DVector;
use std::mem::swap;

/// Builds of a robust tuning.
pub(super) struct Robust<'a> {
    builds: Builds<'a>,
    /// Evaluation of the builds of a rigid wheel in SIMD lanes (several builds at once).
    lanes: Option<LaneBuilds>,
}

impl<'a> Robust<'a> {
    /// Prepares the builds of a vehicle that [`Vehicle::assembled`] returned. If `width` is given, the builds are assembled
    /// in SIMD lanes of this width. Only studies of one wheel support lanes.
    pub(super) fn new(
        assembled: &Vehicle,
        scatter: &'a Scatter,
        variables: usize,
        width: Option<Width>,
    ) -> Result<Self, DesignFault> {
        let builds = Builds::new(assembled, scatter)?;
        let points = assembled.wheel().design.len();
        let lanes = width.map(|width| LaneBuilds::new(builds.draws(), points, variables, width));
        Ok(Robust { builds, lanes })
    }

    /// Number of builds that were solved in SIMD lanes.
    pub(super) fn builds_in_lanes(&self) -> usize {
        let is_accepted = |b: &usize| self.lanes.as_ref().is_some_and(|l| l.is_accepted(*b));
        (0..self.builds.count()).filter(is_accepted).count()
    }

    /// Writes the residuals of all builds to `into`. The builds scatter about the nominal design, which `problem` has already moved
    /// to the variables `x`. Builds that cannot be solved in SIMD lanes are solved one by one.
    pub(super) fn evaluate(
        &mut self,
        problem: &mut Objective<'a>,
        x: &DVector<f64>,
        into: &mut Linearisation,
    ) -> Result<(), Infeasible> {
        let Robust { builds, lanes } = self;
        builds.redraw(problem.wheels().map(|wheel| &wheel.design[..]))?;
        let mut lanes = lanes.as_mut().zip(problem.lanes.as_mut());
        if let Some((lanes, rows)) = &mut lanes {
            lanes.assemble(&builds.wheels[0], &problem.wheel.point_rates);
            rows.of_builds(problem.layout, lanes, into);
        }
        let lanes = lanes.map(|(lanes, _)| lanes);
        for number in 0..builds.count() {
            let is_accepted = |lanes: &&mut LaneBuilds| lanes.is_accepted(number);
            if lanes.as_ref().is_some_and(is_accepted) {
                continue;
            }
            let nominal = problem.wheels().map(MovedWheel::moved);
            builds.build(number, nominal, problem.variables.len())?;
            // During the evaluation, the build replaces the nominal design.
            exchange(builds, problem);
            let found = evaluate_build(builds, number, problem, x, into);
            exchange(builds, problem);
            found.map_err(|reason| Infeasible::Refused(format!("build {number}: {reason}")))?;
        }
        Ok(())
    }
}

/// Writes the residuals of a build. The problem must have the design of this build.
fn evaluate_build<'a>(
    builds: &Builds<'a>,
    number: usize,
    problem: &mut Objective<'a>,
    x: &DVector<f64>,
    into: &mut Linearisation,
) -> Result<(), Infeasible> {
    let first = number * problem.layout.rows;
    if !problem.layout.measures.is_empty() {
        problem.evaluate_moved(Some((&mut *into, first)), None)?;
    }
    let scattered = builds.scattered_rates(number);
    problem.evaluate_beside(x, Some(&scattered), Some((into, first)), None)
}

/// Swaps the designs of the latest build with the designs of the problem.
fn exchange(builds: &mut Builds<'_>, problem: &mut Objective<'_>) {
    let wheels = [Some(&mut problem.wheel), problem.right.as_mut()];
    for (nominal, built) in wheels.into_iter().flatten().zip(&mut builds.wheels) {
        swap(&mut nominal.design, &mut built.design);
        swap(&mut nominal.point_rates, &mut built.point_rates);
    }
}
