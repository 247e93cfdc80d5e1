//! Targets of an axle with elastic parts: rows of the least-squares problem from its equilibria and test figures.
//!
//! A variable moves the points of both wheels. It also moves rates of parts of both wheels, or of a shared part. If the
//! wheels are mirror images, one derivative serves both; otherwise each wheel has its own.

use super::axle::{AxleLayout, AxleStation, Moved, RightWheel, RowsBeside, moved_points};
use super::elastic::{add_points, add_rates};
use super::layout::TargetSample;
use super::{Infeasible, Linearisation};
use crate::axle::AxleRead;
use crate::compliance::{AxleCompliance, AxleParameter, Parameter};
use crate::evaluate::index_or_push;
use crate::mechanism::NoPose;
use crate::model::{Axis, Side};
use crate::number::Tape;
use crate::study::{AxleComplianceStudy, Variable};

/// Rows of a layout of an axle with these elastic parts.
pub(super) fn elastic_axle_rows<'a>(
    layout: &'a AxleLayout,
    elastic: &AxleComplianceStudy,
    variables: &[Variable],
) -> Box<dyn RowsBeside + 'a> {
    let sides = match layout.axle.right {
        None => vec![None],
        Some(_) => vec![Some(Side::Left), Some(Side::Right)],
    };
    let points = moved_points(variables);
    let mut parameters = Vec::new();
    for side in &sides {
        for point in &points {
            parameters.extend(Axis::ALL.map(|axis| AxleParameter {
                parameter: Parameter::Point(*point, axis),
                side: *side,
            }));
        }
    }
    for rate in variables.iter().filter_map(|v| v.rate.as_ref()) {
        index_or_push(&mut parameters, rate.parameter.into());
    }
    Box::new(Rows {
        layout,
        sides,
        right: RightWheel::default(),
        parameters,
        parts: elastic.parts.clone(),
        tape: Tape::default(),
        slopes: vec![0.0; variables.len()],
    })
}

struct Rows<'a> {
    layout: &'a AxleLayout,
    /// Wheels whose points move: `None` for both as mirror images, otherwise each wheel separately.
    sides: Vec<Option<Side>>,
    right: RightWheel,
    /// Coordinates and rates that the variables move.
    parameters: Vec<AxleParameter>,
    parts: AxleCompliance,
    tape: Tape,
    slopes: Vec<f64>,
}

/// Indices of the quantities, among `count`, that targets or limits of a station use.
fn used_by(station: &AxleStation, count: usize) -> Vec<usize> {
    let is_used = |k: &usize| {
        let is_wanted = station.samples.iter().any(|own| own.of == *k);
        is_wanted || station.limits.iter().any(|own| own.of == *k)
    };
    (0..count).filter(is_used).collect()
}

impl RowsBeside for Rows<'_> {
    fn evaluate(
        &mut self,
        moved: &Moved<'_>,
        into: Option<(&mut Linearisation, usize)>,
        mut rows: Option<&mut Linearisation>,
    ) -> Result<(), Infeasible> {
        // Axles have no builds, so their rows start at 0.
        let Some((into, _)) = into else {
            return Ok(());
        };
        let Rows {
            layout,
            sides,
            right,
            parameters,
            parts,
            tape,
            slopes,
        } = self;
        let axle = &layout.axle;
        let wheels = right.with_left(axle, moved);
        for (_, parameter, [rate, _]) in moved.rates() {
            parts.set_rate(parameter.into(), rate);
        }
        let equilibria = axle.equilibria(wheels.map(|(design, _)| design), parts);
        let equilibria = equilibria
            .map_err(|(side, fault)| Infeasible::Refused(axle.describe_fault((side, fault))))?;
        for station in &layout.stations {
            let AxleStation {
                placement,
                samples,
                limits,
            } = station;
            let at = placement
                .on_level_pads()
                .ok_or_else(|| Infeasible::Refused(format!("{placement} is of rigid axles")))?;
            let used = used_by(station, layout.quantities.len());
            let reads = used.iter().map(|k| layout.quantities[*k].into());
            let reads: Vec<AxleRead> = reads.collect();
            let mut is_found = vec![false; used.len()];
            let found =
                equilibria.gradients(at, &reads, parameters, tape, &mut |number, value, by| {
                    is_found[number] = true;
                    let slope = |parameter: AxleParameter| {
                        let place = parameters.iter().position(|p| *p == parameter);
                        place.map_or(0.0, |place| by[place])
                    };
                    slopes.fill(0.0);
                    for (side, (_, ways)) in sides.iter().zip(&wheels) {
                        let side = *side;
                        let of_side = |parameter| slope(AxleParameter { parameter, side });
                        add_points(ways, of_side, slopes);
                    }
                    add_rates(moved, |parameter| slope(parameter.into()), slopes);
                    let own = |sample: &&TargetSample| sample.of == used[number];
                    for sample in samples.iter().filter(own) {
                        if sample.write_residual(sample.row, value, into) {
                            into.write_slopes(sample.row, slopes, sample.scale);
                        }
                    }
                    let Some(rows) = &mut rows else {
                        return;
                    };
                    for own in limits.iter().filter(|own| own.of == used[number]) {
                        own.check.write(&own.limited, value, slopes, rows);
                    }
                });
            if let Err(why) = found {
                let why = NoPose::from(why);
                let message = format!("the axle has no equilibrium at {placement}: {why}");
                return Err(Infeasible::Refused(message));
            }
            if let Some(missing) = is_found.iter().position(|found| !found) {
                let name = reads[missing].quantity.name();
                let message = format!("{name} has no value at {placement}");
                return Err(Infeasible::Refused(message));
            }
        }
        Ok(())
    }
}
