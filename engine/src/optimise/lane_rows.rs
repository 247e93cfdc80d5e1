//! Residuals of targets and rows of constraints in SIMD lanes (several poses at once). Each lane holds one station of a
//! design, or one build of a robust tuning.

use super::Linearisation;
use super::lane_builds::LaneBuilds;
use super::lane_parts::{LanePart, Moving};
use super::layout::{Leg, TargetLayout, TargetSample};
use super::moves::PointRate;
use crate::characteristics::Quantity;
use crate::evaluate::{Gradients, Stations};
use crate::model::Suspension;
use crate::number::{Vector3, Width};

/// Evaluates the targets and constraints of one wheel.
#[derive(Clone)]
pub(super) struct LaneRows<'a> {
    /// Evaluator of each leg (a motion at one rack displacement). `None` if no evaluated row uses the leg.
    legs: Vec<Option<Gradients<'a>>>,
    /// Parts of the constraints. `None` if constraints are not wanted, or if some part is not available in lanes.
    parts: Option<Vec<LanePart>>,
    /// Rates of every coordinate of a design with respect to each variable, `[variable][point][axis]`.
    along: Vec<f64>,
    /// Buffer for the derivatives of a constraint part with respect to the variables.
    slopes: Vec<f64>,
}

/// Rows of constraints, and the values of their parts at each station.
pub(super) struct Checked<'r> {
    pub rows: &'r mut Linearisation,
    pub values: &'r mut [Vec<f64>],
}

impl<'a> LaneRows<'a> {
    /// Prepares the evaluation of the targets, and of the constraints if `with_constraints` is true and all of them are
    /// available in lanes. `None` if targets cannot be differentiated in lanes, or if no target applies to a leg.
    pub(super) fn new(
        suspension: &'a Suspension,
        layout: &TargetLayout,
        with_constraints: bool,
        width: Width,
    ) -> Option<Self> {
        let measures = layout.measures.iter().map(|measure| measure.quantity());
        let wanted: Vec<Quantity> = measures.collect::<Option<_>>()?;
        let has_targets = |leg: &Leg| leg.targets.iter().any(|t| !t.is_empty());
        layout.legs.iter().any(has_targets).then_some(())?;
        let of = |quantities: &[Quantity], with_checks: bool| {
            let legs = layout.legs.iter().map(|leg| {
                if !with_checks && !has_targets(leg) {
                    return Some(None);
                }
                let stations = Stations::at_rack(leg.drive, &leg.order, leg.rack);
                Gradients::new(suspension, &stations, quantities, width).map(Some)
            });
            legs.collect::<Option<Vec<_>>>()
        };
        let mut rows = LaneRows {
            legs: Vec::new(),
            parts: None,
            along: Vec::new(),
            slopes: Vec::new(),
        };
        if with_constraints {
            let mut read = wanted.clone();
            let parts = layout
                .parts
                .iter()
                .map(|part| LanePart::of(&part.limited.of, suspension, &mut read));
            let parts: Option<Vec<LanePart>> = parts.collect();
            if let (Some(parts), Some(legs)) = (parts, of(&read, true)) {
                (rows.parts, rows.legs) = (Some(parts), legs);
                return Some(rows);
            }
        }
        rows.legs = of(&wanted, false)?;
        Some(rows)
    }

    /// Returns true if constraints are wanted, and all of them can be evaluated in SIMD lanes (several poses at once).
    pub(super) fn has_parts(&self) -> bool {
        self.parts.is_some()
    }

    /// Stores the rates at which the variables move a design. `points` and `variables` are the numbers of points and variables.
    pub(super) fn begin(&mut self, points: usize, point_rates: &[PointRate], variables: usize) {
        let one = 3 * points;
        self.slopes.resize(variables, 0.0);
        self.along.clear();
        self.along.resize(variables * one, 0.0);
        for rate in point_rates {
            let first = rate.column * one + 3 * rate.point;
            for (sum, by) in self.along[first..first + 3]
                .iter_mut()
                .zip(rate.by.to_array())
            {
                *sum += by;
            }
        }
    }

    /// Writes the residuals of one leg (a motion at one rack displacement) of a design, with their derivatives. If
    /// `checked` is given, also writes the rows of the constraints. Returns true if the solver in lanes accepted every
    /// station. Otherwise the caller must not use the written values.
    pub(super) fn of_leg(
        &mut self,
        number: usize,
        layout: &TargetLayout,
        design: &[Vector3<f64>],
        into: &mut Linearisation,
        mut checked: Option<Checked<'_>>,
    ) -> bool {
        let LaneRows {
            legs,
            parts,
            along,
            slopes,
        } = self;
        let leg = &layout.legs[number];
        let is_wanted = checked.is_some() || leg.targets.iter().any(|t| !t.is_empty());
        let Some(gradients) = legs[number].as_mut().filter(|_| is_wanted) else {
            return true;
        };
        if let Some(Checked { values, .. }) = &mut checked {
            for values in values.iter_mut() {
                values.clear();
                values.resize(leg.order.values().len(), f64::NAN);
            }
        }
        let moving = Moving { design, along };
        gradients.slopes_of_one(design, along, |found| {
            for (lane, station) in found.side_by_side().iter().enumerate() {
                for sample in &leg.targets[*station] {
                    let value = found.value(lane, sample.of);
                    let slope = |column| found.slope(lane, sample.of, column);
                    write(sample, sample.row, value, slope, into);
                }
                let (Some(Checked { rows, values }), Some(parts)) = (&mut checked, &*parts) else {
                    continue;
                };
                for check in &leg.checks[*station] {
                    let value = parts[check.part].read(found, lane, &moving, slopes);
                    values[check.part][*station] = value;
                    check.write(&layout.parts[check.part].limited, value, slopes, rows);
                }
            }
        })
    }

    /// Writes the residuals of builds, with their derivatives. The values of a build are valid only if the solver in lanes
    /// accepts the build.
    pub(super) fn of_builds(
        &mut self,
        layout: &TargetLayout,
        builds: &mut LaneBuilds,
        into: &mut Linearisation,
    ) {
        for group in builds.groups() {
            for (leg, lanes) in layout.legs.iter().zip(&mut self.legs) {
                let Some(gradients) = lanes else {
                    continue;
                };
                gradients.slopes(
                    builds.designs(&group),
                    builds.point_rates(&group),
                    |found| {
                        for sample in &leg.targets[found.station()] {
                            for (lane, build) in group.clone().enumerate() {
                                let row = build * layout.rows + sample.row;
                                let value = found.value(lane, sample.of);
                                let slope = |column| found.slope(lane, sample.of, column);
                                write(sample, row, value, slope, into);
                            }
                        }
                    },
                );
                for (lane, build) in group.clone().enumerate() {
                    if !gradients.is_accepted(lane) {
                        builds.reject(build);
                    }
                }
            }
        }
    }
}

/// Writes the residual of one target sample, and its derivatives.
fn write(
    sample: &TargetSample,
    row: usize,
    value: f64,
    slope: impl Fn(usize) -> f64,
    into: &mut Linearisation,
) {
    if !sample.write_residual(row, value, into) {
        return;
    }
    let (rows, columns) = into.jacobian.shape();
    let entries = into.jacobian.as_mut_slice();
    for column in 0..columns {
        entries[column * rows + row] = slope(column) * sample.scale;
    }
}
