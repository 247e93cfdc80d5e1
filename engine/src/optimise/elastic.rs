//! Targets of a wheel with elastic parts: rows of the least-squares problem from equilibria and figures of tests.
//!
//! Hardpoints and rates move together. The gradient of a value by the coordinates and rates that move comes from the
//! tape of its station; its slope along a variable is the sum over what the variable moves.

use super::axle::{Moved, RowsBeside};
use super::layout::TargetSample;
use super::{Infeasible, Linearisation};
use crate::compliance::{AxialStiffness, Compliance, KcRun, KcValue, Parameter, Shape};
use crate::evaluate::place_of;
use crate::model::{Axis, PointId, Suspension};
use crate::number::Tape;
use crate::study::{About, ComplianceStudy, Optimise, Variable, WheelStudy};

/// A station, and what is wanted there.
#[derive(Clone, Debug)]
struct ElasticStation {
    travel: f64,
    /// Along the study's +y.
    rack: f64,
    values: Vec<KcValue>,
    /// Their `of` is a number among `values`.
    samples: Vec<TargetSample>,
}

/// The targets of a wheel with elastic parts, laid out.
#[derive(Clone, Debug)]
pub(super) struct ElasticLayout {
    suspension: Suspension,
    elastic: ComplianceStudy,
    stations: Vec<ElasticStation>,
}

impl ElasticLayout {
    /// The targets of a study; their rows are counted on in `rows`, by target in `own`.
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
            let About::Elastic(value) = target.of.about else {
                continue;
            };
            let motion = target.site.motion.as_ref().map(|(_, motion)| motion);
            let motion = motion.unwrap_or(&wheel.motion);
            let home = [if motion.rack_moves {
                0.0
            } else {
                motion.rack[0]
            }];
            let racks: &[f64] = match target.site.racks.as_slice() {
                [] => &home,
                racks => racks,
            };
            for rack in racks {
                for sample in target.wanted.samples(&target.stations_in(motion)) {
                    let station = layout.station(sample.drive, *rack);
                    let of = place_of(&mut station.values, value);
                    station.samples.push(TargetSample {
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
                samples: Vec::new(),
            });
            self.stations.len() - 1
        });
        &mut self.stations[place]
    }

    /// Weighs the rows: the residual of each target per deviation in tolerances.
    pub(super) fn weigh(&mut self, shares: &[f64]) {
        for station in &mut self.stations {
            for sample in &mut station.samples {
                sample.scale *= shares[sample.target];
            }
        }
    }

    /// All samples, with the rack's place along the kernel's +y.
    pub(super) fn samples(&self) -> impl Iterator<Item = (&TargetSample, f64)> {
        let along = self.suspension.frame.sign(Axis::Y);
        self.stations.iter().flat_map(move |station| {
            let samples = station.samples.iter();
            samples.map(move |sample| (sample, along * station.rack))
        })
    }
}

/// Sets a rate.
pub(super) fn set_rate(parts: &mut Compliance, parameter: Parameter, value: f64) {
    match parameter {
        Parameter::Stiffness(bushing, axis) => match &mut parts.bushings[bushing].shapes[axis] {
            Shape::Cubic { rate, .. } => *rate = value,
            Shape::Curve { scale, .. } => *scale = value,
        },
        Parameter::Link(link) => match &mut parts.links[link].stiffness {
            AxialStiffness::Rate(rate) => *rate = value,
            AxialStiffness::PerStrain(force) => *force = value,
        },
        _ => {}
    }
}

/// The rows of a layout.
pub(super) fn elastic_rows<'a>(
    layout: &'a ElasticLayout,
    variables: &[Variable],
) -> Box<dyn RowsBeside + 'a> {
    let mut parameters = Vec::new();
    let mut points: Vec<PointId> = variables.iter().flat_map(Variable::points).collect();
    points.sort();
    points.dedup();
    for point in points {
        parameters.extend(Axis::ALL.map(|axis| Parameter::Point(point, axis)));
    }
    let rates = variables.iter().filter_map(|v| v.rate.as_ref());
    for rate in rates {
        place_of(&mut parameters, rate.parameter);
    }
    Box::new(Rows {
        layout,
        parameters,
        parts: layout.elastic.parts.clone(),
        tape: Tape::default(),
        slopes: vec![0.0; variables.len()],
    })
}

struct Rows<'a> {
    layout: &'a ElasticLayout,
    /// Everything that moves.
    parameters: Vec<Parameter>,
    parts: Compliance,
    tape: Tape,
    slopes: Vec<f64>,
}

/// Writes the slopes of a value along the variables, from its gradient by what moves.
fn along_variables(
    moved: &Moved<'_>,
    parameters: &[Parameter],
    gradient: &[f64],
    slopes: &mut [f64],
) {
    let by = |parameter: Parameter| {
        let place = parameters.iter().position(|p| *p == parameter);
        place.map_or(0.0, |place| gradient[place])
    };
    slopes.fill(0.0);
    for rate in moved.point_rates {
        for (axis, by_axis) in Axis::ALL.into_iter().zip(rate.by.to_array()) {
            if by_axis != 0.0 {
                let slope = by(Parameter::Point(PointId(rate.point), axis));
                slopes[rate.column] += slope * by_axis;
            }
        }
    }
    let variables = moved.variables.iter().zip(moved.x.iter());
    for (slope, (variable, x)) in slopes.iter_mut().zip(variables) {
        if let Some(rate) = &variable.rate {
            *slope += by(rate.parameter) * rate.at(*x)[1];
        }
    }
}

impl RowsBeside for Rows<'_> {
    fn evaluate(&mut self, moved: &Moved<'_>, into: &mut Linearisation) -> Result<(), Infeasible> {
        let Rows {
            layout,
            parameters,
            parts,
            tape,
            slopes,
        } = self;
        for (variable, x) in moved.variables.iter().zip(moved.x.iter()) {
            if let Some(rate) = &variable.rate {
                set_rate(parts, rate.parameter, rate.at(*x)[0]);
            }
        }
        let tyre_rate = layout.elastic.tyre_rate;
        let run = KcRun::of(&layout.suspension, moved.design, parts, tyre_rate);
        let run = run.map_err(|_| {
            Infeasible::Refused("the elastic parts of this design hold no equilibrium".to_owned())
        })?;
        for station in &layout.stations {
            let mut missing = false;
            let at = [station.travel, station.rack];
            let found = run.gradients(at, &station.values, parameters, tape, |found| {
                let own = |sample: &&TargetSample| sample.of == found.number;
                let Some(value) = found.value else {
                    missing = true;
                    return;
                };
                along_variables(moved, parameters, found.by, slopes);
                for sample in station.samples.iter().filter(own) {
                    if sample.write_residual(sample.row, value, into) {
                        into.write_slopes(sample.row, slopes, sample.scale);
                    }
                }
            });
            if found.is_err() || missing {
                let what = if missing { "a figure" } else { "the wheel" };
                let travel = station.travel;
                let message = format!("{what} has no equilibrium at travel {travel}");
                return Err(Infeasible::Refused(message));
            }
        }
        Ok(())
    }
}
