//! Targets of a wheel with elastic parts: rows of the least-squares problem. Equilibria and simulated tests give their
//! values.
//!
//! Variables may move hardpoints and rates together. Each station has a tape, a record of its operations for adjoint
//! differentiation. The tape gives the gradient of a value with respect to the moving coordinates and rates. The slope
//! along a variable is the sum over the coordinates and rates that the variable moves.

use super::axle::{Moved, RowsBeside};
use super::layout::{StationGoals, TargetSample};
use super::moves::PointRate;
use super::{Infeasible, Linearisation};
use crate::compliance::{AxleParameter, Compliance, KcRun, KcValue, Parameter};
use crate::evaluate::index_or_push;
use crate::model::{Axis, PointId, Side, Suspension};
use crate::study::{
    ComplianceStudy, Limited, Motion, Optimise, Site, TargetKind, Variable, WheelStudy,
};

/// A station with its target values.
#[derive(Clone, Debug)]
struct ElasticStation {
    travel: f64,
    /// Rack displacement along the study's +y.
    rack: f64,
    values: Vec<KcValue>,
    /// Targets and limits of this station. The field `of` of a target or limit is an index into `values`.
    goals: StationGoals,
}

/// Residuals of the targets of a wheel with elastic parts, assigned to the stations at which they are evaluated.
#[derive(Clone, Debug)]
pub(super) struct ElasticLayout {
    suspension: Suspension,
    elastic: ComplianceStudy,
    stations: Vec<ElasticStation>,
}

impl ElasticLayout {
    /// Assigns the targets of a study to stations. Adds the number of residuals to `rows`, and the number of each target's
    /// residuals to `own`.
    pub(super) fn of(
        wheel: &WheelStudy,
        elastic: &ComplianceStudy,
        optimise: &Optimise,
        rows: &mut usize,
        own: &mut [usize],
    ) -> Self {
        let mut layout = ElasticLayout {
            suspension: wheel.suspension.clone(),
            elastic: elastic.clone(),
            stations: Vec::new(),
        };
        for (number, target) in optimise.targets.iter().enumerate() {
            let TargetKind::Elastic(value) = target.of.kind else {
                continue;
            };
            let (motion, racks) = place(&target.site, &wheel.motion);
            for rack in racks {
                for sample in target.wanted.samples(&target.stations_in(motion)) {
                    let station = layout.station(sample.drive, rack);
                    let of = index_or_push(&mut station.values, value);
                    station.goals.samples.push(TargetSample {
                        row: *rows,
                        target: number,
                        of,
                        wanted: sample,
                        scale: 1.0 / target.tolerance,
                    });
                    own[number] += 1;
                    *rows += 1;
                }
            }
        }
        layout
    }

    fn station(&mut self, travel: f64, rack: f64) -> &mut ElasticStation {
        let same = |s: &ElasticStation| s.travel == travel && s.rack == rack;
        let known = self.stations.iter().position(same);
        let place = known.unwrap_or_else(|| {
            self.stations.push(ElasticStation {
                travel,
                rack,
                values: Vec::new(),
                goals: StationGoals::default(),
            });
            self.stations.len() - 1
        });
        &mut self.stations[place]
    }

    /// Adds the limits of a value at the stations of `site` (a motion and its rack displacements). If `site` is `None`, the
    /// limits apply in the design position. `part` is the index of the constraint part (one measure with its limits).
    pub(super) fn limit(
        &mut self,
        part: usize,
        value: KcValue,
        limited: &Limited,
        site: Option<&Site>,
        motion: &Motion,
    ) {
        let at: Vec<[f64; 2]> = match site {
            None => vec![[0.0, 0.0]],
            Some(site) => {
                let (motion, racks) = place(site, motion);
                let racks = racks.iter();
                racks
                    .flat_map(|rack| motion.values.iter().map(|travel| [*travel, *rack]))
                    .collect()
            }
        };
        for [travel, rack] in at {
            let station = self.station(travel, rack);
            let of = index_or_push(&mut station.values, value);
            station.goals.limit(part, of, limited);
        }
    }

    /// Travel of a station. `None` if the constraint part with index `part` (one measure with its limits) has a limit at
    /// only one station.
    pub(super) fn place_of(&self, part: usize, station: usize) -> Option<f64> {
        let limits = self.stations.iter().flat_map(|own| &own.goals.limits);
        (limits.filter(|own| own.part == part).count() > 1).then(|| self.stations[station].travel)
    }

    /// Targets and limits of each station, with the station's rack displacement along +y of the kernel's frame (+y is to
    /// the left).
    pub(super) fn goals(&self) -> impl Iterator<Item = (&StationGoals, f64)> {
        let along = self.suspension.frame.sign(Axis::Y);
        let stations = self.stations.iter();
        stations.map(move |station| (&station.goals, along * station.rack))
    }

    /// Targets and limits of each station.
    pub(super) fn goals_mut(&mut self) -> impl Iterator<Item = &mut StationGoals> {
        self.stations.iter_mut().map(|station| &mut station.goals)
    }
}

/// Motion at whose stations a target applies, and rack displacements of this motion along the study's +y.
fn place<'m>(site: &'m Site, own: &'m Motion) -> (&'m Motion, Vec<f64>) {
    let motion = site.motion.as_ref().map_or(own, |(_, motion)| motion);
    let racks = match (site.racks.as_slice(), motion.rack_moves) {
        ([], true) => vec![0.0],
        ([], false) => vec![motion.rack[0]],
        (racks, _) => racks.to_vec(),
    };
    (motion, racks)
}

/// Makes the evaluator of the residuals and constraints that the layout lists. The variables move `points` of the suspension.
pub(super) fn elastic_rows<'a>(
    layout: &'a ElasticLayout,
    suspension: &'a Suspension,
    variables: &[Variable],
    points: impl IntoIterator<Item = PointId>,
) -> Box<dyn RowsBeside + 'a> {
    let mut parameters = Vec::new();
    for point in points {
        parameters.extend(Axis::ALL.map(|axis| Parameter::Point(point, axis)));
    }
    let rates = variables.iter().filter_map(|v| v.rate.as_ref());
    for rate in rates {
        index_or_push(&mut parameters, rate.parameter);
    }
    Box::new(Rows {
        layout,
        suspension,
        parameters,
        parts: layout.elastic.parts.clone(),
        slopes: vec![0.0; variables.len()],
    })
}

struct Rows<'a> {
    layout: &'a ElasticLayout,
    suspension: &'a Suspension,
    /// Coordinates and rates that the variables move.
    parameters: Vec<Parameter>,
    parts: Compliance,
    slopes: Vec<f64>,
}

/// Writes the slopes of a value along the variables. `by` returns its derivative with respect to a moving coordinate or a
/// rate, and 0 for other parameters. `sides` are the wheels with separate derivatives: both, or one item `None` for one wheel or
/// mirror images.
pub(super) fn along_variables(
    moved: &Moved<'_>,
    sides: &[Option<Side>],
    by: impl Fn(AxleParameter) -> f64,
    slopes: &mut [f64],
) {
    slopes.fill(0.0);
    for (side, (_, ways)) in sides.iter().zip(&moved.wheels) {
        let side = *side;
        let of_side = |parameter| by(AxleParameter { parameter, side });
        add_points(ways, of_side, slopes);
    }
    add_rates(moved, by, slopes);
}

/// Adds the contributions of moving points to the derivatives with respect to the variables. `by` returns the derivative of
/// the value with respect to a coordinate.
fn add_points(ways: &[PointRate], by: impl Fn(Parameter) -> f64, slopes: &mut [f64]) {
    for rate in ways {
        for (axis, by_axis) in Axis::ALL.into_iter().zip(rate.by.to_array()) {
            if by_axis != 0.0 {
                let slope = by(Parameter::Point(PointId(rate.point), axis));
                slopes[rate.column] += slope * by_axis;
            }
        }
    }
}

/// Adds the contributions of moving rates to the derivatives with respect to the variables. A rate may belong to both
/// wheels or to one wheel. `by` returns the derivative of the value with respect to a rate: 0 if the value does not depend
/// on the rate.
fn add_rates(moved: &Moved<'_>, by: impl Fn(AxleParameter) -> f64, slopes: &mut [f64]) {
    for (column, parameter, [_, slope]) in moved.rates() {
        for side in [None, Some(Side::Left), Some(Side::Right)] {
            let of = AxleParameter { parameter, side };
            slopes[column] += by(of) * slope * moved.gain(of);
        }
    }
}

impl RowsBeside for Rows<'_> {
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        mut into: Option<(&mut Linearisation, usize)>,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        let Rows {
            layout,
            suspension,
            parameters,
            parts,
            slopes,
        } = self;
        parts.clone_from(&layout.elastic.parts);
        moved.set_rates(
            parts,
            |parts, of, rate| parts.set_rate(of.parameter, rate),
            |parts, of, change, is_relative| parts.change_rate(of.parameter, change, is_relative),
        )?;
        let tyre_rate = layout.elastic.tyre_rate;
        let run = KcRun::of(suspension, moved.wheels[0].0, parts, tyre_rate);
        let run = run.map_err(|_| {
            Infeasible::Refused(
                "with this design, the elastic parts have no equilibrium".to_owned(),
            )
        })?;
        for station in &layout.stations {
            let used = station.goals.used(into.is_some(), rows.is_some());
            if used.is_empty() {
                continue;
            }
            let mut missing = false;
            let at = [station.travel, station.rack];
            let values: Vec<KcValue> = used.iter().map(|of| station.values[*of]).collect();
            let found = run.gradients(at, &values, parameters, &mut |found| {
                let Some(value) = found.value else {
                    missing = true;
                    return;
                };
                let by = |of: AxleParameter| {
                    let own = |parameter: &Parameter| AxleParameter::from(*parameter) == of;
                    let place = parameters.iter().position(own);
                    place.map_or(0.0, |place| found.by[place])
                };
                along_variables(moved, &[None], by, slopes);
                let of = used[found.number];
                station.goals.write(of, value, slopes, &mut into, &mut rows);
            });
            if found.is_err() || missing {
                let what = if missing {
                    "a test result"
                } else {
                    "the wheel"
                };
                let travel = station.travel;
                let message =
                    format!("{what} has no value at travel {travel}: there is no equilibrium");
                return Err(Infeasible::Refused(message));
            }
        }
        Ok(())
    }
}
